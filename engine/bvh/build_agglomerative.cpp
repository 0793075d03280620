#include "engine/bvh/build_agglomerative.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "engine/bvh/cluster_index.h"

namespace zoe {

namespace {

using Pair = ClusterIndex::Pair;

// Memory that stays from frame to frame.
struct Scratch {
    ClusterIndex index;
    std::vector<Pair> pairs;           // In the order merged.
    std::vector<uint32_t> tree_of_id;  // The last one with this lowest box: a box, or box_count + a pair's position.
    std::vector<uint32_t> tree_of_node;
};

constexpr size_t kShare = 16;  // Rounds end once fewer than one merge in so many clusters goes into one.

void cluster_in_rounds(ClusterIndex* index, std::vector<Pair>* pairs) {
    for (size_t merged = index->cluster_count(); index->cluster_count() > 1 && kShare * merged >= index->cluster_count();) {
        const size_t first = pairs->size();
        index->find_partners();
        index->merge_mutual(pairs);
        merged = pairs->size() - first;
    }
}

// From any cluster, walks to its best partner, and on to that one's, until two are each other's best: those merge. Looks for
// no more partners than it needs: where all boxes are one, say, all choose the first, and a round would merge no more.
void cluster_in_pairs(ClusterIndex* index, std::vector<Pair>* pairs) {
    for (uint32_t a = 0; index->cluster_count() > 1;) {
        uint32_t b = index->partner(a);
        for (uint32_t c = index->partner(b); c != a; c = index->partner(b)) {
            a = b;
            b = c;
        }
        const Pair pair{std::min(a, b), std::max(a, b)};
        pairs->push_back(pair);
        index->merge(pair);
        a = pair.low;
    }
}

// Breadth first from the last pair, so that parents stand before their children.
void write(std::span<const Aabb> boxes, Scratch* scratch, Bvh* bvh) {
    const auto box_count = static_cast<uint32_t>(boxes.size());
    // From lowest boxes to the trees that were merged.
    std::vector<uint32_t>& tree_of_id = scratch->tree_of_id;
    tree_of_id.resize(box_count);
    std::iota(tree_of_id.begin(), tree_of_id.end(), 0u);
    uint32_t tree = box_count;
    for (Pair& pair : scratch->pairs) {
        const uint32_t low = pair.low;
        pair = {tree_of_id[pair.low], tree_of_id[pair.high]};
        tree_of_id[low] = tree++;
    }
    scratch->tree_of_node.resize(2 * size_t{box_count} - 1);
    uint32_t* tree_of_node = scratch->tree_of_node.data();
    tree_of_node[0] = tree - 1;
    bvh->nodes.resize(2 * size_t{box_count} - 1);
    bvh->primitives.resize(box_count);
    uint32_t leaf_count = 0, node_count = 1;
    for (uint32_t k = 0; k < node_count; ++k) {
        const uint32_t at = tree_of_node[k];
        if (at < box_count) {
            const Aabb box = boxes[at].is_proper() ? boxes[at] : Aabb{};
            bvh->nodes[k] = {box.lo, leaf_count, box.hi, 1};
            bvh->primitives[leaf_count++] = at;
        } else {
            bvh->nodes[k].first = node_count;
            bvh->nodes[k].count = 0;
            const Pair& pair = scratch->pairs[at - box_count];
            tree_of_node[node_count++] = pair.low;
            tree_of_node[node_count++] = pair.high;
        }
    }
    for (uint32_t k = node_count; k-- > 0;) {
        BvhNode& node = bvh->nodes[k];
        if (node.is_leaf()) continue;
        const Aabb box = merge(bvh->nodes[node.first].bounds(), bvh->nodes[node.first + 1].bounds());
        node.lo = box.lo;
        node.hi = box.hi;
    }
}

}  // namespace

Bvh build_agglomerative(std::span<const Aabb> boxes, Bvh storage) {
    storage.nodes.clear();
    storage.primitives.clear();
    if (boxes.empty()) return storage;
    // What runs in parallel here builds no trees, so no other builder of this thread can meet it.
    thread_local Scratch scratch;
    scratch.pairs.clear();
    scratch.index.start(boxes);
    scratch.pairs.reserve(boxes.size() - 1);
    cluster_in_rounds(&scratch.index, &scratch.pairs);
    cluster_in_pairs(&scratch.index, &scratch.pairs);
    write(boxes, &scratch, &storage);
    return storage;
}

}  // namespace zoe
