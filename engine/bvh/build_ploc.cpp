#include "engine/bvh/build_ploc.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "engine/bvh/ploc_search.h"
#include "engine/bvh/ploc_top.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr uint32_t kGrain = 1024;      // Clusters of a part, at least.
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
          grain_(std::max(kGrain, 4 * radius_)),
          front_(std::max(radius_, 64u)),
          top_count_(std::max(config.top_count, 1u)) {
        front_ += front_ % 2;  // Neighbours by position are those of an even and the next odd place.
    }

    void build(Bvh* bvh) {
        start();
        cluster_down_to(top_count_);
        std::vector<PlocCluster>& top = scratch_.top.clusters;
        top.reserve(std::min(top_count_, box_count_));
        top.resize(cluster_count_);
        for (size_t k = 0; k < top.size(); ++k)
            top[k] = {bounds(front_ + k), now_->ids[front_ + k], now_->leaf_counts[front_ + k]};
        const size_t round_count = scratch_.round_ends.size();
        cluster_down_to(1);
        replace_top(round_count);
        write(bvh);
    }

private:
    using Clusters = PlocScratch::Clusters;
    using Union = PlocUnion;
    using Place = PlocScratch::Place;
    using Part = PlocScratch::Part;

    Aabb box(uint32_t leaf) const {
        const Aabb& box = boxes_[scratch_.order[leaf]];
        return box.is_proper() ? box : Aabb{};
    }
    static uint32_t all_bits(bool is_set) { return 0u - is_set; }
    size_t part_count() const { return (cluster_count_ + grain_ - 1) / grain_; }

    // In parallel: calls `work(part, begin, end)` with the clusters of each.
    template <typename Work>
    void for_each_part(Work&& work) {
        parallel_for(0, cluster_count_, grain_, [&](size_t begin, size_t end) {
            work(scratch_.parts[begin / grain_], static_cast<uint32_t>(begin), static_cast<uint32_t>(end));
        });
    }

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

    void cluster_down_to(uint32_t count) {
        while (cluster_count_ > count) {
            choose_mates();
            merge_mates();
        }
    }

    // Where there are better unions over what so many rounds have left.
    void replace_top(size_t round_count) {
        const uint32_t first = round_count == 0 ? 0 : scratch_.round_ends[round_count - 1];
        if (!improve_top(box_count_ + first, &scratch_.top, std::span(scratch_.unions).subspan(first))) return;
        scratch_.round_ends.resize(round_count);
        for (uint32_t k = first + 1; k < box_count_; ++k) scratch_.round_ends.push_back(k);
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
        scratch_.mates.resize(box_count_);
        if (scratch_.parts.size() < part_count()) scratch_.parts.resize(part_count());
        scratch_.unions.resize(box_count_ - 1);
        scratch_.places.resize(box_count_ - 1);
        scratch_.round_ends.clear();
        scratch_.round_ends.reserve(size_t{256} + std::min(top_count_, box_count_));  // Degenerate inputs aside.
        morton_order(boxes_, &scratch_.order, &scratch_.morton);
        parallel_for(0, box_count_, kGrain, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                const auto leaf = static_cast<uint32_t>(k);
                const Aabb bounds = box(leaf);
                set(now_, front_ + k, bounds.is_empty() ? kNothing : bounds, leaf, 1);
            }
        });
    }

    // Parts look for the partners of their own clusters, and again for those of whom these may choose: so no part waits for
    // another between looking and choosing.
    void choose_mates() {
        const uint32_t radius = std::min({std::max(radius_, kPairs / cluster_count_), cluster_count_ - 1, front_});
        for (uint32_t k = 0; k < radius + kSearchLanes; ++k) set(now_, front_ + cluster_count_ + k, kNothing, kNoCluster, 0);
        ClusterRow row{.planes = {}, .first = front_, .count = cluster_count_};
        for (int k = 0; k < 6; ++k) row.planes[k] = now_->planes[k].data();
        for_each_part([&](Part& part, uint32_t begin, uint32_t end) {
            part.first_partner = begin - std::min(begin, radius);
            const uint32_t last = std::min(end + radius, cluster_count_);
            const size_t size = size_t{last} - part.first_partner + kSearchLanes;
            if (part.partners.size() < size) part.partners.resize(size);
            zoe::find_partners(row, part.first_partner, last, radius, part.partners.data());
            mate_with_each_other(begin, end, &part);
        });
        uint32_t union_count = 0;
        for (size_t k = 0; k < part_count(); ++k) union_count += scratch_.parts[k].union_count;
        // Where few chose each other (each box farther from the next than from the last, say), a round might merge no more
        // than two: then each part also merges, from its front on, whom it can with whom they chose.
        if (union_count >= cluster_count_ / kFew) return;
        for_each_part([&](Part& part, uint32_t begin, uint32_t end) { mate_with_choices(begin, end, &part); });
    }

    // Who mates is anybody's guess, a processor's too: so nothing here and where they merge branches on it.
    void mate_with_each_other(uint32_t begin, uint32_t end, Part* part) {
        const uint32_t *partners = part->partners.data(), first = part->first_partner;
        uint32_t* mates = scratch_.mates.data();
        uint32_t out_count = 0, union_count = 0;
        for (uint32_t k = begin; k < end; ++k) {
            const uint32_t partner = partners[k - first], asked = partner == kNoCluster ? k : partner;
            const uint32_t mate = partner | all_bits(partners[asked - first] != k);
            mates[k] = mate;
            out_count += mate > k;  // Nobody is, too.
            union_count += (mate > k) & (mate != kNoCluster);
        }
        part->out_count = out_count;
        part->union_count = union_count;
    }

    void mate_with_choices(uint32_t begin, uint32_t end, Part* part) {
        for (uint32_t k = begin; k < end; ++k) {
            const uint32_t partner = part->partners[k - part->first_partner];
            const bool is_in_part = begin <= partner && partner < end;
            if (!is_in_part || scratch_.mates[k] != kNoCluster || scratch_.mates[partner] != kNoCluster) continue;
            scratch_.mates[k] = partner;
            scratch_.mates[partner] = k;
            ++part->union_count;
            --part->out_count;
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
        for_each_part([&](Part& part, uint32_t begin, uint32_t end) {
            const uint32_t* mates = scratch_.mates.data();
            uint32_t* kept = part.partners.data();  // Nobody asks for partners any more.
            uint32_t kept_count = 0;
            for (uint32_t k = begin; k < end; ++k) {
                kept[kept_count] = k;
                kept_count += mates[k] > k;
            }
            uint32_t next_union = part.first_union;
            size_t out = front_ + part.first_out;
            for (uint32_t i = 0; i < kept_count; ++i, ++out) {
                const uint32_t k = kept[i], is_union = all_bits(mates[k] != kNoCluster);
                const size_t at = front_ + k, other = front_ + (k ^ ((k ^ mates[k]) & is_union));
                const uint32_t id = now_->ids[at], union_id = box_count_ + next_union;
                Aabb box = bounds(at);
                box.extend(bounds(other));
                set(next_, out, box.is_empty() ? kNothing : box, id ^ ((id ^ union_id) & is_union),
                    now_->leaf_counts[at] + (now_->leaf_counts[other] & is_union));
                kept[next_union - part.first_union] = k;
                next_union += is_union & 1;
            }
            for (uint32_t i = 0; i < part.union_count; ++i) {
                const size_t left = front_ + kept[i], right = front_ + mates[kept[i]];
                scratch_.unions[part.first_union + i] = {bounds(left), bounds(right), now_->ids[left], now_->ids[right],
                                                         now_->leaf_counts[left]};
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
    uint32_t box_count_, radius_, grain_;
    uint32_t front_;  // Places before the first cluster.
    uint32_t top_count_;
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
