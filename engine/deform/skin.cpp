#include "engine/deform/skin.h"

#include <cassert>

#include "engine/deform/skin_kernels.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 2048;  // A multiple of the widest vector: only the last range has a part of one.

}  // namespace

std::vector<uint8_t> used_joints(const SkinBinding& binding, size_t joint_count) {
    std::vector<uint8_t> is_used(joint_count, 0);
    for (size_t first = 0; first < binding.joints.size(); first += binding.influence_count) {
        bool is_weighted = false;
        for (size_t k = first; k < first + binding.influence_count; ++k) {
            if (binding.weights[k] == 0.0f) continue;
            is_used[binding.joints[k]] = 1;
            is_weighted = true;
        }
        if (!is_weighted) is_used[binding.joints[first]] = 1;
    }
    return is_used;
}

void skin(const SkinBinding& binding, const PackedJoints& joints, std::span<const glm::vec3> positions,
          std::span<const glm::vec3> normals, std::span<glm::vec3> skinned_positions, std::span<glm::vec3> skinned_normals) {
    assert(binding.influence_count > 0 && skinned_positions.size() == positions.size());
    assert(binding.weights.size() == binding.influence_count * positions.size());
    assert((normals.empty() || normals.size() == positions.size()) && skinned_normals.size() == normals.size());
    const SkinWork work{.influence_count = binding.influence_count,
                        .joints = binding.joints.data(),
                        .weights = binding.weights.data(),
                        .packed = &joints,
                        .positions = positions.data(),
                        .normals = normals.empty() ? nullptr : normals.data(),
                        .skinned_positions = skinned_positions.data(),
                        .skinned_normals = skinned_normals.data()};
    const auto kernel = joints.skinning == Skinning::kLinearBlend ? skin_linear : skin_dual;
    parallel_for(0, positions.size(), kGrain, [&](size_t begin, size_t end) { kernel(work, begin, end); });
}

}  // namespace zoe
