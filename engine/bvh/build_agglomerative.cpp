#include "engine/bvh/build_agglomerative.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace zoe {

namespace {

constexpr uint32_t kNobody = 0xffffffffu;

struct Cluster {
    Aabb bounds;
    uint32_t id;  // Primitives first, then merges in the order they were made.
};

// Pairs in one strict order: a chain of ever better pairs cannot turn in a circle.
struct PairKey {
    double area;
    uint32_t lower, higher;

    friend bool operator<(const PairKey& a, const PairKey& b) {
        if (a.area != b.area) return a.area < b.area;
        if (a.lower != b.lower) return a.lower < b.lower;
        return a.higher < b.higher;
    }
};

class Builder {
public:
    explicit Builder(std::span<const Aabb> boxes) {
        active_.clear();
        merges_.clear();
        for (size_t k = 0; k < boxes.size(); ++k) {
            assert(boxes[k].is_finite() && !boxes[k].is_empty());
            active_.push_back({boxes[k], static_cast<uint32_t>(k)});
        }
    }

    // From any cluster, walks to its best partner, and on to that one's, until two are each other's best: those merge.
    // Merging others first could not have changed that, since unions only grow.
    void cluster() {
        const uint32_t primitive_count = static_cast<uint32_t>(active_.size());
        uint32_t a = 0, b = best_partner(0);
        while (active_.size() > 1) {
            const uint32_t c = best_partner(b);
            if (c != a) {
                a = b;
                b = c;
                continue;
            }
            const Cluster merged{merge(active_[a].bounds, active_[b].bounds),
                                 primitive_count + static_cast<uint32_t>(merges_.size())};
            merges_.push_back({active_[a].id, active_[b].id, merged.bounds});
            active_[a] = merged;
            active_[b] = active_.back();
            active_.pop_back();
            if (a == active_.size()) a = b;  // The merged cluster was the last and moved.
            b = best_partner(a);
        }
    }

    // Breadth first from the last merge, so that parents stand before their children.
    void write(std::span<const Aabb> boxes, Bvh* bvh) const {
        const uint32_t primitive_count = static_cast<uint32_t>(boxes.size());
        thread_local std::vector<uint32_t> id_of_node;
        id_of_node.assign(1, active_[0].id);
        for (size_t k = 0; k < id_of_node.size(); ++k) {
            const uint32_t id = id_of_node[k];
            if (id < primitive_count) {
                bvh->nodes.push_back({boxes[id].lo, static_cast<uint32_t>(bvh->primitives.size()), boxes[id].hi, 1});
                bvh->primitives.push_back(id);
            } else {
                const Merge& merge = merges_[id - primitive_count];
                bvh->nodes.push_back({merge.bounds.lo, static_cast<uint32_t>(id_of_node.size()), merge.bounds.hi, 0});
                id_of_node.push_back(merge.left);
                id_of_node.push_back(merge.right);
            }
        }
    }

private:
    struct Merge {
        uint32_t left, right;
        Aabb bounds;
    };

    uint32_t best_partner(uint32_t a) const {
        PairKey best{std::numeric_limits<double>::infinity(), kNobody, kNobody};
        uint32_t partner = kNobody;
        for (uint32_t b = 0; b < active_.size(); ++b) {
            if (b == a) continue;
            const auto [lower, higher] = std::minmax(active_[a].id, active_[b].id);
            const PairKey key{merge(active_[a].bounds, active_[b].bounds).half_area(), lower, higher};
            if (key < best) {
                best = key;
                partner = b;
            }
        }
        return partner;
    }

    // Memory that stays from frame to frame. Nothing here runs in parallel, so no other builder of this thread can meet it.
    static thread_local std::vector<Cluster> active_;
    static thread_local std::vector<Merge> merges_;
};

thread_local std::vector<Cluster> Builder::active_;
thread_local std::vector<Builder::Merge> Builder::merges_;

}  // namespace

Bvh build_agglomerative(std::span<const Aabb> boxes, Bvh storage) {
    storage.nodes.clear();
    storage.primitives.clear();
    if (boxes.empty()) return storage;
    Builder builder(boxes);
    builder.cluster();
    builder.write(boxes, &storage);
    return storage;
}

}  // namespace zoe
