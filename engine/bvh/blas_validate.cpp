#include <algorithm>

#include "engine/bvh/blas.h"

namespace zoe {

namespace {

bool is_finite(const Triangle& t) {
    return zoe::is_finite(t.a) && zoe::is_finite(t.b) && zoe::is_finite(t.c);
}

// A triangle in a leaf.
struct Held {
    Triangle triangle;
    Aabb leaf;
};

// All in leaves, those of a triangle one after another.
std::vector<Held> all_held(const Blas& blas) {
    std::vector<Held> all;
    for (const WideNode& node : blas.tree.nodes) {
        for (int slot = 0; slot < kWidth; ++slot) {
            const uint32_t child = node.child[slot];
            if (child == kEmptyChild || !is_leaf(child)) continue;
            for (uint32_t k = 0; k < block_count(child) * TriangleBlock::kSize; ++k) {
                const TriangleBlock& block = blas.blocks[first_block(child) + k / TriangleBlock::kSize];
                const Triangle triangle = block.triangle(static_cast<int>(k % TriangleBlock::kSize));
                if (triangle.primitive != kEmptyChild) all.push_back({triangle, node.box(slot)});
            }
        }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Held& a, const Held& b) { return a.triangle.primitive < b.triangle.primitive; });
    return all;
}

// What is wrong with the places of one triangle; empty where nothing is.
std::string check_places(std::span<const Held> places, const Triangle& triangle, bool may_have_pieces) {
    if (places.empty()) return "in no leaf";
    if (places.size() > 1 && !may_have_pieces) return "in two leaves";
    for (const Held& place : places) {
        const Triangle& held = place.triangle;
        if (is_finite(held) != is_finite(triangle)) return "not finite, or held as if it were not";
        if (is_finite(triangle) && (held.a != triangle.a || held.b != triangle.b || held.c != triangle.c)) {
            return "other corners";
        }
    }
    if (!is_finite(triangle)) return "";
    if (places.size() == 1) return places[0].leaf.contains(bounds(triangle)) ? "" : "its leaf does not contain it";
    std::vector<Aabb> leaves;
    for (const Held& place : places) leaves.push_back(place.leaf);
    if (!is_held(triangle, leaves)) return "its leaves do not contain it";
    return "";
}

}  // namespace

std::string validate(const Blas& blas, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners) {
    if (const std::string problem = validate(blas.tree, blas.blocks.size()); !problem.empty()) return problem;
    if (blas.triangle_count != corners.size()) return "another number of triangles";
    const std::vector<Held> all = all_held(blas);
    size_t end = 0;
    for (uint32_t primitive = 0; primitive < corners.size(); ++primitive) {
        const glm::uvec3& c = corners[primitive];
        const size_t begin = end;
        while (end < all.size() && all[end].triangle.primitive == primitive) ++end;
        const std::string problem =
            check_places(std::span(all).subspan(begin, end - begin),
                         Triangle{positions[c.x], positions[c.y], positions[c.z], primitive}, blas.has_pieces);
        if (!problem.empty()) return "triangle " + std::to_string(primitive) + ": " + problem;
    }
    if (end < all.size()) return "triangle " + std::to_string(all[end].triangle.primitive) + ": out of range";
    return "";
}

}  // namespace zoe
