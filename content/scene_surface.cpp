#include <cmath>
#include <numbers>

#include "content/scenes.h"

namespace zoe {

namespace {
constexpr float kPi = std::numbers::pi_v<float>;
}  // namespace

// A ring of size x size quads, 3 m wide, at level 2. Its tube swells and narrows in a wave that runs around it twice:
// cos(2 a - w t) is a sum of two morph targets whose weights are cos(w t) and sin(w t).
Content make_surface_scene(int size) {
    constexpr float kMajor = 1.1f, kMinor = 0.4f;
    Content content;
    Scene& scene = content.scene;
    std::vector<glm::vec3> positions;
    Cage cage;
    MorphTarget targets[2];
    const int side = std::max(size, 3);
    const auto index_of = [&](int i, int k) { return static_cast<uint32_t>((i % side) * side + k % side); };
    for (int i = 0; i < side; ++i) {
        for (int k = 0; k < side; ++k) {
            const float a = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(side);
            const float b = 2.0f * kPi * static_cast<float>(k) / static_cast<float>(side);
            const glm::vec3 out = {std::cos(a), std::sin(a), 0};
            const glm::vec3 offset = kMinor * (std::cos(b) * out + glm::vec3(0, 0, std::sin(b)));
            positions.push_back(kMajor * out + offset);
            targets[0].positions.push_back(0.4f * std::cos(2.0f * a) * offset);
            targets[1].positions.push_back(0.4f * std::sin(2.0f * a) * offset);
            cage.face_sizes.push_back(4);
            for (const uint32_t v : {index_of(i, k), index_of(i + 1, k), index_of(i + 1, k + 1), index_of(i, k + 1)}) {
                cage.vertices.push_back(v);
            }
        }
    }
    Mesh mesh = make_surface(std::move(positions), {.cage = std::move(cage)});
    mesh.name = "ring";
    mesh.targets = {targets[0], targets[1]};
    mesh.default_weights = {1, 0};
    set_material(mesh, add_color(scene, "ring", 0xb5725a));
    Node node;
    node.name = "ring";
    node.mesh = scene.add(std::move(mesh));
    const NodeId id = scene.add(std::move(node));
    Sampler weights{.width = 2};
    for (int k = 0; k <= 48; ++k) {
        const float share = static_cast<float>(k) / 48.0f;
        weights.times_s.push_back(static_cast<float>(kLoop_s) * share);
        weights.values.insert(weights.values.end(), {std::cos(2.0f * kPi * share), std::sin(2.0f * kPi * share)});
    }
    add_channel(scene, id, ChannelPath::kWeights, add_sampler(scene, std::move(weights)));
    add_view(scene, {1.0f, 0.2f, 1.25f}, {1.05f, 0.0f, 0.0f}, 40.0f);
    return content;
}

}  // namespace zoe
