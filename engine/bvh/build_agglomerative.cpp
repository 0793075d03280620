#include "engine/bvh/build_agglomerative.h"

#include <vector>

#include "engine/bvh/cluster_index.h"

namespace zoe {

namespace {

struct Merge {
    uint32_t left, right;  // Ids, as in ClusterIndex.
    Aabb bounds;
};

// From any cluster, walks to its best partner, and on to that one's, until two are each other's best: those merge.
// Merging others first could not have changed that, since unions only grow.
void cluster(std::span<const Aabb> boxes, ClusterIndex* index, std::vector<Merge>* merges) {
    merges->clear();
    index->start(boxes);
    uint32_t a = 0;
    while (index->cluster_count() > 1) {
        uint32_t b = index->best_partner(a, ClusterIndex::kNobody);
        while (true) {
            const uint32_t c = index->best_partner(b, a);
            if (c == a) break;
            a = b;
            b = c;
        }
        const uint32_t merged = index->merge(a, b);
        merges->push_back({a, b, index->bounds(merged)});
        a = merged;
    }
}

// Breadth first from the last merge, so that parents stand before their children.
void write(std::span<const Aabb> boxes, std::span<const Merge> merges, Bvh* bvh) {
    const size_t primitive_count = boxes.size();
    thread_local std::vector<uint32_t> id_of_node;
    id_of_node.assign(1, static_cast<uint32_t>(primitive_count + merges.size() - 1));
    for (size_t k = 0; k < id_of_node.size(); ++k) {
        const uint32_t id = id_of_node[k];
        if (id < primitive_count) {
            bvh->nodes.push_back({boxes[id].lo, static_cast<uint32_t>(bvh->primitives.size()), boxes[id].hi, 1});
            bvh->primitives.push_back(id);
        } else {
            const Merge& merge = merges[id - primitive_count];
            bvh->nodes.push_back({merge.bounds.lo, static_cast<uint32_t>(id_of_node.size()), merge.bounds.hi, 0});
            id_of_node.push_back(merge.left);
            id_of_node.push_back(merge.right);
        }
    }
}

}  // namespace

Bvh build_agglomerative(std::span<const Aabb> boxes, Bvh storage) {
    storage.nodes.clear();
    storage.primitives.clear();
    if (boxes.empty()) return storage;
    // Memory that stays from frame to frame. Nothing here runs in parallel, so no other builder of this thread can meet it.
    thread_local ClusterIndex index;
    thread_local std::vector<Merge> merges;
    cluster(boxes, &index, &merges);
    write(boxes, merges, &storage);
    return storage;
}

}  // namespace zoe
