#include "engine/scene/gltf_skin.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/gltf_accessor.h"

namespace zoe {
namespace {

constexpr float kWeightTolerance = 2e-3f;  // Half of what 8 bits resolve.

/// A column-major matrix, as glTF stores them.
Affine to_affine_checked(const float* m, const GltfFile& file, const std::string& place, size_t joint, Scene& scene) {
    for (int i = 0; i < 16; ++i) {
        if (!std::isfinite(m[i])) file.fail(place, fmt::format("the matrix of joint {} is not finite", joint));
    }
    const bool is_affine = m[3] == 0.0f && m[7] == 0.0f && m[11] == 0.0f && std::fabs(m[15] - 1.0f) < 1e-4f;
    if (!is_affine) scene.warn("an inverse bind matrix whose last row is not 0 0 0 1: taken as such");
    Affine a;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) a.linear[column][row] = m[column * 4 + row];
    }
    a.translation = {m[12], m[13], m[14]};
    return a;
}

/// extras.skinning: this project's own word.
Skinning skinning_of(const tinygltf::Value& extras, Scene& scene) {
    if (!extras.Has("skinning")) return Skinning::kLinearBlend;
    const tinygltf::Value& word = extras.Get("skinning");
    if (word.IsString() && word.Get<std::string>() == "dual_quaternion") return Skinning::kDualQuaternion;
    if (!word.IsString() || word.Get<std::string>() != "linear_blend") {
        scene.warn("extras.skinning is none of linear_blend, dual_quaternion: ignored");
    }
    return Skinning::kLinearBlend;
}

}  // namespace

std::vector<Skin> read_skins(GltfFile& file, Scene& scene) {
    std::vector<Skin> skins;
    for (size_t i = 0; i < file.model.skins.size(); ++i) {
        const tinygltf::Skin& from = file.model.skins[i];
        const std::string place = fmt::format("/skins/{}", i);
        Skin skin;
        skin.name = from.name;
        skin.skinning = skinning_of(from.extras, scene);
        if (from.joints.size() > 0x10000) file.fail(place + "/joints", "more than 65536 joints");
        for (const int joint : from.joints) skin.joints.push_back(NodeId(joint));
        skin.joint_from_mesh.resize(skin.joints.size());
        if (from.inverseBindMatrices >= 0) {
            const std::string in_matrices = place + "/inverseBindMatrices";
            require_type(file, from.inverseBindMatrices, {TINYGLTF_TYPE_MAT4}, in_matrices);
            if (!is_float(file, from.inverseBindMatrices)) file.fail(in_matrices, "the matrices are not floats");
            const std::vector<float> floats = read_floats(file, from.inverseBindMatrices, {0, skin.joints.size()});
            if (floats.size() < 16 * skin.joints.size()) {
                file.fail(in_matrices, fmt::format("{} matrices for {} joints", floats.size() / 16, skin.joints.size()));
            }
            for (size_t j = 0; j < skin.joints.size(); ++j) {
                skin.joint_from_mesh[j] = to_affine_checked(&floats[16 * j], file, in_matrices, j, scene);
            }
        }
        skins.push_back(std::move(skin));
    }
    return skins;
}

void normalize_weights(Mesh& mesh, Scene& scene) {
    SkinBinding& binding = mesh.binding;
    const uint32_t n = binding.influence_count;
    for (size_t v = 0; n > 0 && v < mesh.positions.size(); ++v) {
        float* weights = &binding.weights[v * n];
        float sum = 0.0f;
        for (uint32_t i = 0; i < n; ++i) {
            if (!(weights[i] >= 0.0f && std::isfinite(weights[i]))) {
                scene.warn("a joint weight that is negative or not finite: taken as 0");
                weights[i] = 0.0f;
                binding.joints[v * n + i] = 0;
            }
            sum += weights[i];
        }
        if (!(sum > 0.0f) || !std::isfinite(sum)) {
            scene.warn("a vertex without joint weights: it follows joint 0");
            std::fill(weights, weights + n, 0.0f);
            std::fill(&binding.joints[v * n], &binding.joints[v * n] + n, uint16_t{0});
            weights[0] = 1.0f;
        } else if (sum != 1.0f) {
            if (std::fabs(sum - 1.0f) > kWeightTolerance) {
                scene.warn("a vertex whose joint weights do not sum to 1: normalised");
            }
            for (uint32_t i = 0; i < n; ++i) weights[i] /= sum;
        }
    }
}

void check_skin_use(const GltfFile& file, Scene& scene) {
    std::vector<uint32_t> joint_end(scene.meshes.size(), 0);
    for (size_t i = 0; i < scene.meshes.size(); ++i) {
        for (const uint16_t joint : scene.meshes[i].binding.joints) joint_end[i] = std::max(joint_end[i], joint + 1u);
    }
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        Node& node = scene.nodes[i];
        if (node.skin == kNone<SkinId>) continue;
        if (node.mesh == kNone<MeshId> || scene[node.mesh].binding.influence_count == 0) {
            scene.warn("a node with a skin, but without a mesh that has joints and weights: the skin is ignored");
            node.skin = kNone<SkinId>;
            continue;
        }
        const size_t joint_count = scene.skins[index(node.skin)].joints.size();
        if (joint_end[index(node.mesh)] > joint_count) {
            file.fail(fmt::format("/nodes/{}/skin", i),
                      fmt::format("mesh {} names joint {}, but the skin has {} joints", index(node.mesh),
                                  joint_end[index(node.mesh)] - 1, joint_count));
        }
    }
}

}  // namespace zoe
