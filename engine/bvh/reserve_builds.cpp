#include "engine/bvh/reserve_builds.h"

#include <cstddef>

namespace zoe {

void reserve_builds(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, BlasScratch* scratch) {
    std::vector<glm::uvec3> more(corners.begin(), corners.end());
    more.insert(more.end(), corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(corners.size() / 4));
    Blas spare;
    build_blas(positions, more, BlasBuilder::kBinned, &spare, scratch);
    // How nodes spread over levels, and a level's over its parts, differs more than their number does.
    const auto widen = [](auto* array) { array->reserve(2 * array->capacity()); };
    for (CollapseScratch::Part& part : scratch->collapse.parts) {
        widen(&part.next);
        widen(&part.slots);
        widen(&part.below);
    }
    for (auto& waiting : scratch->collapse.waiting) widen(&waiting);
}

void reserve_builds(Blas* blas) {
    // Full-sweep trees mostly have more blocks than binned ones, and fewer nodes where their pose was a bad one.
    blas->tree.nodes.reserve(blas->tree.nodes.size() * 3 / 2);
    blas->tree.level_ends.reserve(2 * blas->tree.level_ends.size());
    blas->blocks.reserve(blas->blocks.size() * 9 / 8);
}

}  // namespace zoe
