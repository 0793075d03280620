#include "engine/bvh/epo.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/bvh/small_stack.h"
#include "engine/math/parallel.h"
#include "engine/math/rng.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 64;
// Triangles whose walks are done before it is looked at how many nodes they visited: first these, then some times as many.
constexpr size_t kFirstTriangles = 16, kGrowth = 8;

// A convex polygon in double. A plane adds one vertex to it, unless rounding made it slightly concave: then n vertices, i of
// them inside, leave at most i + 2 min(i, n - i). From 3 vertices, six planes lead to no more than 28.
struct Polygon {
    static constexpr int kCapacity = 28;
    std::array<glm::dvec3, kCapacity> points;
    int count = 0;

    void add(const glm::dvec3& point) { points[count++] = point; }
};

double area(const Polygon& polygon) {
    glm::dvec3 sum(0.0);
    for (int k = 2; k < polygon.count; ++k) {
        sum += glm::cross(polygon.points[k - 1] - polygon.points[0], polygon.points[k] - polygon.points[0]);
    }
    return 0.5 * glm::length(sum);
}

// Cuts off what lies at sign * x > sign * plane along an axis.
// Returns    false where nothing does: `kept` was not written.
bool clip(const Polygon& polygon, int axis, double plane, double sign, Polygon* kept) {
    const auto is_inside = [&](const glm::dvec3& p) { return sign * p[axis] <= sign * plane; };
    int inside_count = 0;
    for (int k = 0; k < polygon.count; ++k) inside_count += is_inside(polygon.points[k]) ? 1 : 0;
    if (inside_count == polygon.count) return false;
    kept->count = 0;
    for (int k = 0; inside_count > 0 && k < polygon.count; ++k) {
        const glm::dvec3& p = polygon.points[k];
        const glm::dvec3& q = polygon.points[k + 1 < polygon.count ? k + 1 : 0];
        if (is_inside(p)) kept->add(p);
        if (is_inside(p) == is_inside(q)) continue;
        // From the inside out, so that an edge is cut in the same place from both of its ends.
        const glm::dvec3& in = is_inside(p) ? p : q;
        const glm::dvec3& out = is_inside(p) ? q : p;
        glm::dvec3 cut = in + (out - in) * ((plane - in[axis]) / (out[axis] - in[axis]));
        cut[axis] = plane;
        kept->add(cut);
    }
    return true;
}

Polygon polygon_of(const Triangle& t) {
    Polygon polygon;
    for (const glm::vec3& corner : {t.a, t.b, t.c}) polygon.add(glm::dvec3(corner));
    return polygon;
}

double area_inside(const Polygon& triangle, const BvhNode& box) {
    std::array<Polygon, 2> cuts;  // Taken in turns.
    const Polygon* left = &triangle;
    int turn = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (clip(*left, axis, box.lo[axis], -1.0, &cuts[turn])) left = &cuts[std::exchange(turn, 1 - turn)];
        if (clip(*left, axis, box.hi[axis], 1.0, &cuts[turn])) left = &cuts[std::exchange(turn, 1 - turn)];
    }
    return area(*left);
}

bool overlaps(const BvhNode& node, const Aabb& box) {
    return node.lo.x <= box.hi.x && box.lo.x <= node.hi.x && node.lo.y <= box.hi.y && box.lo.y <= node.hi.y &&
           node.lo.z <= box.hi.z && box.lo.z <= node.hi.z;
}

// Numbers the triangles as the walk down the tree meets them, so that every subtree's numbers are a range.
class Ranks {
public:
    explicit Ranks(const Bvh& bvh) : begin_(bvh.nodes.size()), count_(bvh.nodes.size()), rank_of_(bvh.primitives.size()) {
        for (size_t k = bvh.nodes.size(); k-- > 0;) {
            const BvhNode& node = bvh.nodes[k];
            count_[k] = node.is_leaf() ? node.count : count_[node.first] + count_[node.first + 1];
        }
        for (size_t k = 0; k < bvh.nodes.size(); ++k) {
            const BvhNode& node = bvh.nodes[k];
            if (node.is_leaf()) {
                for (uint32_t i = 0; i < node.count; ++i) rank_of_[node.first + i] = begin_[k] + i;
            } else {
                begin_[node.first] = begin_[k];
                begin_[node.first + 1] = begin_[k] + count_[node.first];
            }
        }
    }
    uint32_t rank_of(size_t slot) const { return rank_of_[slot]; }
    /// ranks      of a triangle's references, ascending.
    bool is_under(uint32_t node, std::span<const uint32_t> ranks) const {
        const auto first = std::lower_bound(ranks.begin(), ranks.end(), begin_[node]);
        return first != ranks.end() && *first - begin_[node] < count_[node];
    }

private:
    std::vector<uint32_t> begin_, count_;  // [node_count]
    std::vector<uint32_t> rank_of_;        // [primitive_count] by slot.
};

// The references of each triangle.
class References {
public:
    References(const Bvh& bvh, const Ranks& ranks) : slots_(bvh.primitives.size()), ranks_(bvh.primitives.size()) {
        std::iota(slots_.begin(), slots_.end(), 0u);
        std::sort(slots_.begin(), slots_.end(), [&](uint32_t a, uint32_t b) {
            const uint32_t p = bvh.primitives[a], q = bvh.primitives[b];
            return p < q || (p == q && ranks.rank_of(a) < ranks.rank_of(b));
        });
        for (size_t k = 0; k < slots_.size(); ++k) {
            ranks_[k] = ranks.rank_of(slots_[k]);
            if (k == 0 || bvh.primitives[slots_[k]] != bvh.primitives[slots_[k - 1]]) begins_.push_back(k);
        }
        begins_.push_back(slots_.size());
    }
    size_t triangle_count() const { return begins_.size() - 1; }
    uint32_t a_slot_of(size_t triangle) const { return slots_[begins_[triangle]]; }
    std::span<const uint32_t> ranks_of(size_t triangle) const {
        return std::span(ranks_).subspan(begins_[triangle], begins_[triangle + 1] - begins_[triangle]);
    }

private:
    std::vector<uint32_t> slots_, ranks_;  // [reference_count] by primitive, then by rank.
    std::vector<size_t> begins_;           // [triangle_count + 1]
};

// Cost of the nodes that a triangle reaches into from outside, times its area in each.
// visits     the nodes that were looked at are added.
double overlap_of(const Bvh& bvh, const Ranks& ranks, std::span<const uint32_t> own, const Triangle& triangle,
                  double whole_area, uint64_t* visits) {
    const Aabb box = bounds(triangle);
    const Polygon polygon = polygon_of(triangle);
    double sum = 0.0;
    SmallStack<uint32_t, 64> open;
    open.push(0);
    while (!open.is_empty()) {
        const uint32_t index = open.pop();
        ++*visits;
        const BvhNode& node = bvh.nodes[index];
        if (!ranks.is_under(index, own)) {
            if (!overlaps(node, box)) continue;
            const double inside = node.bounds().contains(box) ? whole_area : area_inside(polygon, node);
            if (inside == 0.0) continue;  // Nor is there any in the boxes within this one.
            sum += inside * (node.is_leaf() ? node.count : 1.0);
        }
        if (node.is_leaf()) continue;
        open.push(node.first + 1);
        open.push(node.first);
    }
    return sum;
}

// Every order is as likely as any other.
std::vector<uint32_t> shuffled(size_t count, uint64_t seed) {
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    Rng rng(seed);
    for (size_t k = count; k-- > 1;) std::swap(order[k], order[rng.below(static_cast<uint32_t>(k + 1))]);
    return order;
}

// How many triangles are next, at most `left` of them: as many as the budget is expected to do.
size_t next_count(size_t done, size_t left, uint64_t visits, uint64_t max_visits) {
    if (done == 0) return std::min(kFirstTriangles, left);
    if (visits >= max_visits) return 0;
    const double mean = std::max(1.0, static_cast<double>(visits) / static_cast<double>(done));
    const double affordable = static_cast<double>(max_visits - visits) / mean;
    const size_t most = std::min(left, kGrowth * done);
    return affordable < static_cast<double>(most) ? static_cast<size_t>(affordable) : most;
}

}  // namespace

Epo epo(const Bvh& bvh, std::span<const Triangle> triangles, const EpoConfig& config) {
    assert(triangles.size() == bvh.primitives.size());
    const Ranks ranks(bvh);
    const References references(bvh, ranks);
    struct Addend {
        double area = 0.0, overlap = 0.0;
    };
    std::vector<Addend> addends(triangles.size());
    const auto walk = [&](uint32_t triangle, uint64_t* visits) {
        const uint32_t slot = references.a_slot_of(triangle);
        const Triangle& t = triangles[slot];
        if (!is_finite(t.a) || !is_finite(t.b) || !is_finite(t.c)) return;
        const double whole_area = area(polygon_of(t));
        if (whole_area == 0.0) return;
        addends[slot] = {whole_area, overlap_of(bvh, ranks, references.ranks_of(triangle), t, whole_area, visits)};
    };

    // In an order that makes those that come first a sample of all.
    std::vector<uint32_t> order = shuffled(references.triangle_count(), config.seed);
    Epo epo;
    size_t done = 0;
    while (const size_t count = next_count(done, order.size() - done, epo.visits, config.max_visits)) {
        const auto chunk = order.begin() + static_cast<ptrdiff_t>(done);
        std::sort(chunk, chunk + static_cast<ptrdiff_t>(count));  // Neighbours visit the same nodes.
        std::atomic<uint64_t> visits{0};
        parallel_for(done, done + count, kGrain, [&](size_t begin, size_t end) {
            if (config.cancel && *config.cancel) return;
            uint64_t visits_here = 0;
            for (size_t k = begin; k < end; ++k) walk(order[k], &visits_here);
            visits += visits_here;
        });
        epo.visits += visits;
        done += count;
        if (config.cancel && *config.cancel) break;
    }
    Addend sum;  // In the order of the slots, so that threads do not show.
    for (const Addend& addend : addends) {
        sum.area += addend.area;
        sum.overlap += addend.overlap;
    }
    epo.is_sampled = done < order.size();
    epo.cost = sum.area > 0.0 ? sum.overlap / sum.area : 0.0;
    return epo;
}

double epo_cost(const Bvh& bvh, std::span<const Triangle> triangles) {
    return epo(bvh, triangles, {}).cost;
}

}  // namespace zoe
