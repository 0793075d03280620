#include "apps/common/lone_blas.h"

#include "engine/bvh/build_agglomerative.h"

namespace zoe {

LoneBlas::LoneBlas(const Blas& blas) : bounds_(blas.tree.bounds()) {
    const Aabb bounds[] = {bounds_};
    std::vector<uint32_t> slots;
    CollapseScratch scratch;
    collapse(build_agglomerative(bounds), {.block_size = 1, .max_leaf_blocks = 1}, &top_, &slots, &scratch);
    placed_ = {.local_from_world = {}, .blas = &blas, .is_identity = true};
}

TwoLevels LoneBlas::levels() const {
    return {.top = &top_,
            .instances = &placed_,
            .bounds = &bounds_,
            .stack_size = top_.stack_size() + placed_.blas->tree.stack_size() + 1};
}

}  // namespace zoe
