#include "engine/deform/skin.h"

#include <cassert>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 2048;

// Weighted sum of a vertex's joint matrices. No weight at all: joint 0 of its list.
Affine blend(const SkinBinding& binding, std::span<const Affine> skin_from_mesh, size_t vertex) {
    const size_t first = vertex * binding.influence_count;
    Affine sum{glm::mat3(0.0f), glm::vec3(0.0f)};
    bool is_weighted = false;
    for (size_t k = first; k < first + binding.influence_count; ++k) {
        const float weight = binding.weights[k];
        if (weight == 0.0f) continue;
        const Affine& joint = skin_from_mesh[binding.joints[k]];
        sum.linear += weight * joint.linear;
        sum.translation += weight * joint.translation;
        is_weighted = true;
    }
    return is_weighted ? sum : skin_from_mesh[binding.joints[first]];
}

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

void skin_positions(const SkinBinding& binding, std::span<const Affine> skin_from_mesh, std::span<const glm::vec3> in,
                    std::span<glm::vec3> out) {
    assert(out.size() == in.size() && binding.influence_count > 0);
    parallel_for(0, in.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) out[v] = blend(binding, skin_from_mesh, v).point(in[v]);
    });
}

void skin_normals(const SkinBinding& binding, std::span<const Affine> skin_from_mesh, std::span<const glm::vec3> in,
                  std::span<glm::vec3> out) {
    assert(out.size() == in.size() && binding.influence_count > 0);
    parallel_for(0, in.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            const glm::mat3 m = blend(binding, skin_from_mesh, v).linear;
            // The cofactor matrix is the inverse transpose times the determinant: its sign keeps normals outside, and it
            // is fine for flattened joints.
            const glm::mat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
            out[v] = (glm::determinant(m) < 0.0f ? -1.0f : 1.0f) * (cofactor * in[v]);
        }
    });
}

}  // namespace zoe
