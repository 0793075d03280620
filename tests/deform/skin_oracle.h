#pragma once

#include <vector>

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/vector_double3.hpp>

#include "engine/deform/skin.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

/// Weights that sum to 1 but for rounding; a third of them 0.
inline SkinBinding random_binding(Rng& rng, size_t vertex_count, uint32_t influence_count, uint32_t joint_count) {
    SkinBinding binding{influence_count, {}, {}};
    for (size_t v = 0; v < vertex_count; ++v) {
        std::vector<float> weights(influence_count);
        float sum = 0.0f;
        for (float& weight : weights) sum += weight = rng.below(3) == 0 ? 0.0f : rng.uniform();
        if (sum == 0.0f) sum = weights[0] = 1.0f;
        for (const float weight : weights) {
            binding.joints.push_back(static_cast<uint16_t>(rng.below(joint_count)));
            binding.weights.push_back(weight / sum);
        }
    }
    return binding;
}

struct DoubleAffine {
    glm::dmat3 linear{0.0};
    glm::dvec3 translation{0.0};
};

/// The weighted sum of a vertex's matrices.
inline DoubleAffine blended(const SkinBinding& binding, const std::vector<Affine>& joints, size_t vertex) {
    DoubleAffine sum;
    for (uint32_t k = 0; k < binding.influence_count; ++k) {
        const double weight = binding.weights[vertex * binding.influence_count + k];
        const Affine& joint = joints[binding.joints[vertex * binding.influence_count + k]];
        sum.linear += weight * glm::dmat3(joint.linear);
        sum.translation += weight * glm::dvec3(joint.translation);
    }
    return sum;
}

inline PackedJoints packed_linear(std::span<const Affine> skin_from_mesh) {
    PackedJoints packed;
    pack_joints(skin_from_mesh, &packed);
    return packed;
}

/// Positions and normals of a linear blend.
inline void skin_positions(const SkinBinding& binding, std::span<const Affine> skin_from_mesh, std::span<const glm::vec3> in,
                           std::span<glm::vec3> out) {
    skin(binding, packed_linear(skin_from_mesh), in, {}, out, {});
}
inline void skin_normals(const SkinBinding& binding, std::span<const Affine> skin_from_mesh, std::span<const glm::vec3> in,
                         std::span<glm::vec3> out) {
    std::vector<glm::vec3> positions(in.size());
    skin(binding, packed_linear(skin_from_mesh), positions, in, positions, out);
}

}  // namespace zoe::test
