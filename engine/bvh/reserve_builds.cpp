#include "engine/bvh/reserve_builds.h"

#include <algorithm>
#include <cstddef>

namespace zoe {

void reserve_builds(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasScratch* scratch) {
    std::vector<glm::uvec3> more(corners.begin(), corners.end());
    more.insert(more.end(), corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(corners.size() / 4));
    Blas spare;
    build_blas(positions, more, BlasBuilder::kBinned, &spare, scratch);
    // How nodes spread over levels, and a level's over its parts, differs more than their number does: any part may come to
    // hold as much as the fullest did.
    const auto widen = [](auto* array) { array->reserve(2 * array->capacity()); };
    std::vector<CollapseScratch::Part>& parts = scratch->collapse.parts;
    size_t next = 0, slots = 0, below = 0;
    for (const CollapseScratch::Part& part : parts) {
        next = std::max(next, part.next.capacity());
        slots = std::max(slots, part.slots.capacity());
        below = std::max(below, part.below.capacity());
    }
    parts.resize(parts.size() * 5 / 4 + 1);
    for (CollapseScratch::Part& part : parts) {
        part.next.reserve(2 * next);
        part.slots.reserve(2 * slots);
        part.below.reserve(2 * below);
    }
    for (auto& waiting : scratch->collapse.waiting) widen(&waiting);
}

void reserve_builds(Blas* blas) {
    // First trees mostly have more blocks than binned ones, and fewer nodes where their pose was a bad one.
    blas->tree.nodes.reserve(blas->tree.nodes.size() * 3 / 2 + 8);
    blas->tree.level_ends.reserve(2 * blas->tree.level_ends.size() + 4);
    blas->blocks.reserve(blas->blocks.size() * 5 / 4 + 8);
}

}  // namespace zoe
