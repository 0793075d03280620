#include "engine/bvh/build_ploc.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "engine/bvh/ploc_search.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr uint32_t kGrain = 1024;      // Clusters of a part.
constexpr uint32_t kUnionGrain = 512;  // Unions that are placed by one thread.
constexpr uint32_t kAhead = 8;         // Unions whose place in memory is asked for before its turn.
constexpr uint32_t kPairs = 4096;      // Looked at in a round in any case: 64 clusters look at each other.
constexpr uint32_t kFew = 12;          // Fewer than one union of so many clusters, and others merge, too.
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class Ploc {
public:
    Ploc(std::span<const Aabb> boxes, const PlocConfig& config, PlocScratch* scratch)
        : boxes_(boxes),
          scratch_(*scratch),
          box_count_(static_cast<uint32_t>(boxes.size())),
          radius_(std::min(std::max(config.search_radius, 1u), box_count_)),
          front_(std::max(radius_, 64u)) {
        front_ += front_ % 2;  // Neighbours by position are those of an even and the next odd place.
    }

    void build(Bvh* bvh) {
        start();
        while (cluster_count_ > 1) {
            find_partners();
            choose_mates();
            merge_mates();
        }
        write(bvh);
    }

private:
    using Clusters = PlocScratch::Clusters;
    using Union = PlocScratch::Union;
    using Place = PlocScratch::Place;
    using Part = PlocScratch::Part;

    Aabb box(uint32_t leaf) const {
        const Aabb& box = boxes_[scratch_.order[leaf]];
        return box.is_proper() ? box : Aabb{};
    }
    size_t part_count() const { return (cluster_count_ + kGrain - 1) / kGrain; }

    // While clusters look for partners, an empty one is infinite: else all that see it would want it.
    Aabb bounds(size_t place) const {
        const auto& p = now_->planes;
        if (p[0][place] == -kInfinity) return {};
        return {{p[0][place], p[2][place], p[4][place]}, {p[1][place], p[3][place], p[5][place]}};
    }
    static void set(Clusters* clusters, size_t place, const Aabb& box, uint32_t id, uint32_t leaf_count) {
        for (int axis = 0; axis < 3; ++axis) {
            clusters->planes[2 * axis][place] = box.lo[axis];
            clusters->planes[2 * axis + 1][place] = box.hi[axis];
        }
        clusters->ids[place] = id;
        clusters->leaf_counts[place] = leaf_count;
    }

    void start() {
        cluster_count_ = box_count_;
        const size_t size = size_t{front_} + box_count_ + front_ + kSearchLanes;
        for (Clusters& clusters : scratch_.clusters) {
            for (std::vector<float>& plane : clusters.planes) plane.resize(size);
            clusters.ids.resize(size);
            clusters.leaf_counts.resize(size);
            for (uint32_t k = 0; k < front_; ++k) set(&clusters, k, kNothing, kNoCluster, 0);
        }
        scratch_.partners.resize(box_count_ + kSearchLanes);
        scratch_.mates.resize(box_count_);
        scratch_.parts.resize(part_count());
        scratch_.unions.resize(box_count_ - 1);
        scratch_.places.resize(box_count_ - 1);
        scratch_.round_ends.clear();
        scratch_.round_ends.reserve(256);  // Degenerate inputs aside.
        morton_order(boxes_, &scratch_.order, &scratch_.morton);
        parallel_for(0, box_count_, kGrain, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                const auto leaf = static_cast<uint32_t>(k);
                const Aabb bounds = box(leaf);
                set(now_, front_ + k, bounds.is_empty() ? kNothing : bounds, leaf, 1);
            }
        });
    }

    void find_partners() {
        const uint32_t radius = std::min({std::max(radius_, kPairs / cluster_count_), cluster_count_ - 1, front_});
        for (uint32_t k = 0; k < radius + kSearchLanes; ++k) set(now_, front_ + cluster_count_ + k, kNothing, kNoCluster, 0);
        ClusterRow row{.planes = {}, .first = front_, .count = cluster_count_};
        for (int k = 0; k < 6; ++k) row.planes[k] = now_->planes[k].data();
        parallel_for(0, cluster_count_, kGrain, [&](size_t begin, size_t end) {
            zoe::find_partners(row, static_cast<uint32_t>(begin), static_cast<uint32_t>(end), radius,
                               scratch_.partners.data());
        });
    }

    // Those that chose each other. Where they are few (each box farther from the next than from the last, say), a round
    // might merge no more than two: then each part also merges, from its front on, whom it can with whom they chose.
    void choose_mates() {
        const auto choose = [&](bool takes_all) {
            parallel_for(0, cluster_count_, kGrain, [&](size_t begin, size_t end) {
                Part& part = scratch_.parts[begin / kGrain];
                const auto b = static_cast<uint32_t>(begin), e = static_cast<uint32_t>(end);
                if (takes_all) {
                    mate_with_choices(b, e);
                } else {
                    mate_with_each_other(b, e);
                }
                part.union_count = part.out_count = 0;
                for (uint32_t k = b; k < e; ++k) {
                    const uint32_t mate = scratch_.mates[k];
                    part.out_count += mate > k;  // Nobody is, too.
                    part.union_count += (mate > k) & (mate != kNoCluster);
                }
            });
            uint32_t union_count = 0;
            for (size_t k = 0; k < part_count(); ++k) union_count += scratch_.parts[k].union_count;
            return union_count;
        };
        if (choose(false) < cluster_count_ / kFew) choose(true);
    }

    void mate_with_each_other(uint32_t begin, uint32_t end) {
        for (uint32_t k = begin; k < end; ++k) {
            const uint32_t partner = scratch_.partners[k], asked = partner == kNoCluster ? k : partner;
            scratch_.mates[k] = scratch_.partners[asked] == k ? partner : kNoCluster;
        }
    }

    void mate_with_choices(uint32_t begin, uint32_t end) {
        for (uint32_t k = begin; k < end; ++k) {
            const uint32_t partner = scratch_.partners[k];
            const bool is_in_part = begin <= partner && partner < end;
            if (!is_in_part || scratch_.mates[k] != kNoCluster || scratch_.mates[partner] != kNoCluster) continue;
            scratch_.mates[k] = partner;
            scratch_.mates[partner] = k;
        }
    }

    // Each union takes its first half's place.
    void merge_mates() {
        uint32_t union_count = scratch_.round_ends.empty() ? 0 : scratch_.round_ends.back(), out_count = 0;
        for (size_t k = 0; k < part_count(); ++k) {
            Part& part = scratch_.parts[k];
            part.first_union = union_count;
            part.first_out = out_count;
            union_count += part.union_count;
            out_count += part.out_count;
        }
        parallel_for(0, cluster_count_, kGrain, [&](size_t begin, size_t end) {
            const Part& part = scratch_.parts[begin / kGrain];
            uint32_t next_union = part.first_union;
            size_t out = front_ + part.first_out;
            for (size_t k = begin; k < end; ++k) {
                const uint32_t mate = scratch_.mates[k];
                if (mate != kNoCluster && mate < k) continue;
                Aabb box = bounds(front_ + k);
                uint32_t id = now_->ids[front_ + k], leaf_count = now_->leaf_counts[front_ + k];
                if (mate != kNoCluster) {
                    const Aabb other = bounds(front_ + mate);
                    scratch_.unions[next_union] = {box, other, id, now_->ids[front_ + mate], leaf_count};
                    id = box_count_ + next_union++;
                    leaf_count += now_->leaf_counts[front_ + mate];
                    box.extend(other);
                }
                set(next_, out++, box.is_empty() ? kNothing : box, id, leaf_count);
            }
        });
        scratch_.round_ends.push_back(union_count);
        cluster_count_ = out_count;
        std::swap(now_, next_);
    }

    // From the last round back, so that parents know where their children go: side by side, then all that is under the
    // first, then all that is under the second.
    void write(Bvh* bvh) {
        bvh->nodes.resize(2 * size_t{box_count_} - 1);
        bvh->primitives.resize(box_count_);
        place(now_->ids[front_], bounds(front_), 0, {1, 0}, bvh);
        for (size_t round = scratch_.round_ends.size(); round-- > 0;) {
            const uint32_t begin = round == 0 ? 0 : scratch_.round_ends[round - 1];
            parallel_for(begin, scratch_.round_ends[round], kUnionGrain, [&](size_t from, size_t to) {
                for (size_t k = from; k < to; ++k) {
                    if (k + kAhead < to) prefetch_children(scratch_.places[k + kAhead], *bvh);
                    const Union& at = scratch_.unions[k];
                    const Place left = {scratch_.places[k].first_node + 2, scratch_.places[k].first_leaf};
                    const Place right = {left.first_node + 2 * (at.left_leaf_count - 1),
                                         left.first_leaf + at.left_leaf_count};
                    place(at.left, at.left_bounds, left.first_node - 2, left, bvh);
                    place(at.right, at.right_bounds, left.first_node - 1, right, bvh);
                }
            });
        }
    }

    // They may lie in two cache lines.
    static void prefetch_children(const Place& below, const Bvh& bvh) {
        __builtin_prefetch(&bvh.nodes[below.first_node], 1);
        __builtin_prefetch(&bvh.nodes[below.first_node + 1], 1);
    }

    void place(uint32_t id, const Aabb& bounds, uint32_t node, const Place& below, Bvh* bvh) {
        if (id < box_count_) {
            bvh->nodes[node] = {bounds.lo, below.first_leaf, bounds.hi, 1};
            bvh->primitives[below.first_leaf] = scratch_.order[id];
        } else {
            bvh->nodes[node] = {bounds.lo, below.first_node, bounds.hi, 0};
            scratch_.places[id - box_count_] = below;
        }
    }

    // Any union with it is infinite.
    static constexpr Aabb kNothing{glm::vec3(-kInfinity), glm::vec3(kInfinity)};

    std::span<const Aabb> boxes_;
    PlocScratch& scratch_;
    uint32_t box_count_, radius_;
    uint32_t front_;  // Places before the first cluster.
    uint32_t cluster_count_ = 0;
    Clusters* now_ = &scratch_.clusters[0];
    Clusters* next_ = &scratch_.clusters[1];
};

}  // namespace

Bvh build_ploc(std::span<const Aabb> boxes, const PlocConfig& config, Bvh storage, PlocScratch* scratch) {
    assert(boxes.size() <= size_t{1} << 30);
    if (boxes.empty()) {
        storage.nodes.clear();
        storage.primitives.clear();
    } else {
        Ploc(boxes, config, scratch).build(&storage);
    }
    return storage;
}

}  // namespace zoe
