#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/bvh/bvh.h"
#include "engine/math/huge_allocator.h"

namespace zoe {

/// How many children a node has room for.
inline constexpr int kWidth = 8;

/// A node of the tree that is traversed: eight boxes side by side, four cache lines. A slot without a child holds an empty
/// box, which no ray enters.
struct alignas(64) WideNode {
    float planes[6][kWidth];  ///< lo.x, hi.x, lo.y, hi.y, lo.z, hi.z of each child.
    uint32_t child[kWidth];   ///< See `leaf_child`; a node's index where it is no leaf.
    double area_cost;         ///< See `sum_costs`.
    uint32_t is_box_changed;  ///< By the last refit: a box in it.
    uint32_t is_sum_changed;  ///< Any box below it.
    uint32_t unused[4];       ///< Fills the line.

    Aabb box(int slot) const {
        return {{planes[0][slot], planes[2][slot], planes[4][slot]}, {planes[1][slot], planes[3][slot], planes[5][slot]}};
    }
    void set_box(int slot, const Aabb& box);
    /// Around all children.
    Aabb bounds() const;
};

/// A leaf's child word: the first of its blocks, and how many follow each other.
inline constexpr uint32_t kLeafBit = 0x80000000u, kEmptyChild = 0xffffffffu;
inline constexpr uint32_t kMaxLeafBlocks = 16, kMaxBlocks = (1u << 27) - 1;
inline uint32_t leaf_child(uint32_t first, uint32_t count) {
    return kLeafBit | (count - 1) << 27 | first;
}
inline bool is_leaf(uint32_t child) {
    return (child & kLeafBit) != 0;
}
inline uint32_t first_block(uint32_t child) {
    return child & kMaxBlocks;
}
inline uint32_t block_count(uint32_t child) {
    return (child >> 27 & 15) + 1;
}

/// A BVH of eight children a node. The root is nodes[0]; a level stands after the one above it, so a loop over the levels
/// from the back visits children first. What a block is belongs to whoever owns the tree. Empty: no nodes.
struct WideBvh {
    std::vector<WideNode, HugeAllocator<WideNode>> nodes;
    std::vector<uint32_t> level_ends;  ///< [depth] nodes of level k stand in [level_ends[k - 1], level_ends[k]).

    Aabb bounds() const { return nodes.empty() ? Aabb{} : nodes[0].bounds(); }
    /// `sah_cost` as the nodes' sums have it, with the block cost they were summed with.
    /// Cost       O(1).
    double summed_cost() const;
    /// Entries that a traversal may have to keep at once.
    size_t stack_size() const { return level_ends.size() * (kWidth - 1) + 1; }
};

struct CollapseConfig {
    uint32_t block_size = 4;       ///< Primitives that are tested together.
    uint32_t max_leaf_blocks = 4;  ///< 1 to 16. Chart `knobs`.
    float block_cost = 0.7f;       ///< Cost of testing a block, in units of testing a node's eight boxes.
    bool has_duplicates = false;   ///< A primitive may stand in several binary leaves; those that are joined keep it once.
};

/// Memory that one collapse hands to the next.
struct CollapseScratch {
    /// What a subtree costs least.
    struct Plan {
        float costs[kWidth - 1];   ///< [k] as a forest of at most k + 1 trees.
        uint32_t primitive_count;  ///< 0: not planned yet.
    };
    /// A node whose parent is planned apart from it, or which is to be planned after all that are planned in parallel.
    struct Waiting {
        uint32_t node, choice;
        Plan plan;
    };
    /// A wide node before there is room for it: what its children are made of, and their words.
    struct Sketch {
        uint32_t binary[kWidth], child[kWidth];
    };
    /// What neighbours on a level are made into, apart from all others.
    struct Part {
        std::vector<uint32_t> next;       ///< Binary nodes of the level below, in the order of their wide nodes.
        std::vector<uint32_t> slots;      ///< Of the part's leaves.
        std::vector<uint32_t> below;      ///< Nodes of a subtree that are still to be visited.
        uint32_t first_next, first_slot;  ///< Where these two go.
    };
    std::vector<uint32_t> choices;              ///< [binary nodes] how forests are divided; all that is left of a plan.
    std::vector<std::vector<Waiting>> waiting;  ///< Of each range that is planned in parallel, from its back.
    std::vector<uint32_t> roots;                ///< [wide nodes] the binary node that each is made of.
    std::vector<Sketch> sketches;               ///< [wide nodes]
    std::vector<Part> parts;                    ///< Of a level.
};

/// Makes the wide tree of a binary one: the one of least SAH cost among all that join the binary tree's nodes, its leaves
/// counted in blocks.
/// slots      result: [blocks * block_size] primitives block by block; kEmptyChild where a leaf's last block is not full.
/// Requires   binary leaves of at most max_leaf_blocks * block_size primitives.
/// Cost       O(nodes), in parallel; no allocation where `wide`, `slots` and `scratch` are large enough. The same tree
///            whatever the number of threads. Nodes come with their sums.
/// Source     Ylitie, Karras, Laine. Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs. HPG 2017.
///            Deviation: full boxes, leaves of any size, and all children of a level side by side.
void collapse(const Bvh& bvh, const CollapseConfig& config, WideBvh* wide, std::vector<uint32_t>* slots,
              CollapseScratch* scratch);

/// Sums up a node: the half areas of the boxes below it, in it included, times what is done where one is entered, which is
/// 1 for a node and block_cost for each block of a leaf.
/// Requires   the sums of its children.
void sum_costs(const WideBvh& wide, float block_cost, WideNode* node);

/// Checks links, levels, that each block is in exactly one leaf, and that inner boxes contain their children's.
/// Returns    the first broken invariant in words, empty when all hold.
std::string validate(const WideBvh& wide, size_t block_count);

/// What a random ray costs by the surface area heuristic: 1 a node visited and `block_cost` a block tested.
double sah_cost(const WideBvh& wide, float block_cost);

}  // namespace zoe
