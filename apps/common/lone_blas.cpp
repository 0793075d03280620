#include "apps/common/lone_blas.h"

#include "engine/bvh/build_agglomerative.h"

namespace zoe {

LoneBlas::LoneBlas(const Blas& blas) {
    const Aabb bounds[] = {blas.tree.bounds()};
    std::vector<uint32_t> slots;
    CollapseScratch scratch;
    collapse(build_agglomerative(bounds), {.block_size = 1, .max_leaf_blocks = 1}, &top_, &slots, &scratch);
    placed_ = {.local_from_world = {}, .bounds_world = bounds[0], .blas = &blas, .id = 0, .is_identity = true};
}

TwoLevels LoneBlas::levels() const {
    return {.top = &top_, .instances = &placed_, .stack_size = top_.stack_size() + placed_.blas->tree.stack_size() + 1};
}

}  // namespace zoe
