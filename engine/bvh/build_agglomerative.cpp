#include "engine/bvh/build_agglomerative.h"

#include <numeric>
#include <vector>

#include "engine/bvh/cluster_index.h"

namespace zoe {

namespace {

using Merge = ClusterIndex::Pair;

constexpr size_t kFew = 128;   // So many clusters are merged pair by pair.
constexpr size_t kShare = 16;  // So are they once fewer than one merge in so many clusters goes into a round.

// Round by round: all look for their best partners, and those that chose each other merge. Merging others first could not
// have changed that, since unions only grow.
void cluster_in_rounds(ClusterIndex* index, std::vector<uint32_t>* ids, std::vector<Merge>* merges) {
    const size_t box_count = index->cluster_count();
    ids->resize(box_count);
    std::iota(ids->begin(), ids->end(), 0u);
    for (bool is_slow = false; !is_slow && ids->size() > kFew;) {
        index->find_partners();
        const size_t first = merges->size();
        size_t kept = 0;
        for (const uint32_t a : *ids) {
            const uint32_t b = index->partner(a);
            if (index->partner(b) != a) {
                (*ids)[kept++] = a;
            } else if (a < b) {
                merges->push_back({a, b});
            }
        }
        is_slow = kShare * (merges->size() - first) < ids->size();
        ids->resize(kept);
        index->merge(std::span(*merges).subspan(first));
        for (size_t k = first; k < merges->size(); ++k) ids->push_back(static_cast<uint32_t>(box_count + k));
    }
}

// From any cluster, walks to its best partner, and on to that one's, until two are each other's best: those merge. Looks for
// no more partners than it needs: where all boxes are one, say, all choose the first, and a round would merge no more.
void cluster_in_pairs(uint32_t a, ClusterIndex* index, std::vector<Merge>* merges) {
    while (index->cluster_count() > 1) {
        uint32_t b = index->best_partner(a, ClusterIndex::kNobody);
        while (true) {
            const uint32_t c = index->best_partner(b, a);
            if (c == a) break;
            a = b;
            b = c;
        }
        merges->push_back({a, b});
        a = index->merge(a, b);
    }
}

// Breadth first from the last merge, so that parents stand before their children.
void write(const ClusterIndex& index, std::span<const Merge> merges, Bvh* bvh) {
    const size_t primitive_count = merges.size() + 1;
    thread_local std::vector<uint32_t> id_of_node;
    id_of_node.assign(1, static_cast<uint32_t>(primitive_count + merges.size() - 1));
    for (size_t k = 0; k < id_of_node.size(); ++k) {
        const uint32_t id = id_of_node[k];
        const Aabb& box = index.bounds(id);
        if (id < primitive_count) {
            bvh->nodes.push_back({box.lo, static_cast<uint32_t>(bvh->primitives.size()), box.hi, 1});
            bvh->primitives.push_back(id);
        } else {
            bvh->nodes.push_back({box.lo, static_cast<uint32_t>(id_of_node.size()), box.hi, 0});
            id_of_node.push_back(merges[id - primitive_count].a);
            id_of_node.push_back(merges[id - primitive_count].b);
        }
    }
}

}  // namespace

Bvh build_agglomerative(std::span<const Aabb> boxes, Bvh storage) {
    storage.nodes.clear();
    storage.primitives.clear();
    if (boxes.empty()) return storage;
    // Memory that stays from frame to frame. What runs in parallel here builds no trees, so no other builder of this thread
    // can meet it.
    thread_local ClusterIndex index;
    thread_local std::vector<Merge> merges;
    thread_local std::vector<uint32_t> ids;
    index.start(boxes);
    merges.clear();
    cluster_in_rounds(&index, &ids, &merges);
    cluster_in_pairs(ids.front(), &index, &merges);
    write(index, merges, &storage);
    return storage;
}

}  // namespace zoe
