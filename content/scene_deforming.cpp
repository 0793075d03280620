#include <array>
#include <cmath>
#include <numbers>

#include "content/body.h"
#include "content/scenes.h"
#include "content/shapes.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

// A cloth 4 m wide under two travelling waves. cos(k.x - w t) = cos(k.x) cos(w t) + sin(k.x) sin(w t): two morph targets a
// wave, whose weights are cos(w t) and sin(w t). Normals (-dh/dx, 1, -dh/dz) are sums of the same kind, so they are exact.
void add_wave(Scene& scene, int quads_a_side, const glm::vec3& place) {
    struct Wave {
        glm::vec2 k;  // Radians a metre.
        float height;
        int turns;  // Of w t over the loop.
    };
    const Wave waves[] = {{{3.0f, 1.2f}, 0.16f, 2}, {{-1.5f, 4.1f}, 0.09f, 3}};
    Mesh mesh = make_grid(quads_a_side, quads_a_side, 4.0f, 4.0f);
    mesh.name = "cloth";
    set_material(mesh, add_color(scene, "cloth", 0x4f7f94));
    for (const Wave& wave : waves) {
        for (const float shift : {0.0f, 0.5f * kPi}) {
            MorphTarget target;
            for (const glm::vec3& p : mesh.positions) {
                const float phase = wave.k.x * p.x + wave.k.y * p.z - shift;
                const float slope = -wave.height * std::sin(phase);
                target.positions.push_back({0, wave.height * std::cos(phase), 0});
                target.normals.push_back({-slope * wave.k.x, 0, -slope * wave.k.y});
            }
            mesh.targets.push_back(std::move(target));
        }
    }
    mesh.default_weights = {1, 0, 1, 0};
    Sampler weights{.width = 4};
    for (int k = 0; k <= 96; ++k) {
        const float share = static_cast<float>(k) / 96.0f;
        weights.times_s.push_back(static_cast<float>(kLoop_s) * share);
        for (const Wave& wave : waves) {
            const float angle = 2.0f * kPi * static_cast<float>(wave.turns) * share;
            weights.values.insert(weights.values.end(), {std::cos(angle), std::sin(angle)});
        }
    }
    Node node;
    node.name = "cloth";
    node.local.translation = place;
    node.mesh = scene.add(std::move(mesh));
    add_channel(scene, scene.add(std::move(node)), ChannelPath::kWeights, add_sampler(scene, std::move(weights)));
}

Content make_deforming_scene(int size) {
    Content content;
    add_wave(content.scene, size, glm::vec3(0.0f));
    add_view(content.scene, {0.3f, 1.3f, 1.9f}, {0.0f, -0.1f, 0.4f}, 45.0f);
    return content;
}

namespace {

struct Bone {
    const char* name;
    int parent;
    glm::vec3 place;
    float swing_degrees;  // About X.
    float phase;          // In turns; steps are 1 s long.
    float lean_degrees;   // The middle of the swing.
};

// A walker 1.7 m tall that looks along +Z.
constexpr std::array<Bone, 14> kBones = {{{"hips", -1, {0, 0.92f, 0}, 0, 0, 0},
                                          {"spine", 0, {0, 1.05f, 0}, 2, 0.1f, 3},
                                          {"chest", 1, {0, 1.25f, 0}, 2, 0.2f, 2},
                                          {"head", 2, {0, 1.5f, 0}, 3, 0.3f, -4},
                                          {"upper arm l", 2, {0.2f, 1.4f, 0}, 28, 0.5f, 0},
                                          {"forearm l", 4, {0.24f, 1.13f, 0}, 14, 0.55f, -24},
                                          {"upper arm r", 2, {-0.2f, 1.4f, 0}, 28, 0.0f, 0},
                                          {"forearm r", 6, {-0.24f, 1.13f, 0}, 14, 0.05f, -24},
                                          {"thigh l", 0, {0.1f, 0.88f, 0}, 30, 0.0f, -4},
                                          {"shin l", 8, {0.11f, 0.48f, 0}, 26, 0.28f, 28},
                                          {"thigh r", 0, {-0.1f, 0.88f, 0}, 30, 0.5f, -4},
                                          {"shin r", 10, {-0.11f, 0.48f, 0}, 26, 0.78f, 28},
                                          {"foot l", 9, {0.11f, 0.09f, 0}, 8, 0.3f, 0},
                                          {"foot r", 11, {-0.11f, 0.09f, 0}, 8, 0.8f, 0}}};

constexpr float kWalkerCell = 0.04f;  // Metres; of those in a crowd.

Mesh make_walker(MaterialId material, float cell) {
    const BodyPiece pieces[] = {{0, {-.06f, .93f, 0}, {.06f, .93f, 0}, .13f, .13f},
                                {1, {0, 1.0f, 0}, {0, 1.15f, 0}, .12f, .13f},
                                {2, {0, 1.2f, 0}, {0, 1.36f, 0}, .14f, .15f},
                                {2, {-.13f, 1.4f, 0}, {.13f, 1.4f, 0}, .07f, .07f},
                                {3, {0, 1.45f, 0}, {0, 1.52f, 0}, .055f, .055f},
                                {3, {0, 1.6f, .01f}, {0, 1.63f, .02f}, .1f, .1f},
                                {4, {.2f, 1.4f, 0}, {.24f, 1.15f, 0}, .06f, .048f},
                                {5, {.24f, 1.12f, 0}, {.25f, .88f, 0}, .045f, .04f},
                                {6, {-.2f, 1.4f, 0}, {-.24f, 1.15f, 0}, .06f, .048f},
                                {7, {-.24f, 1.12f, 0}, {-.25f, .88f, 0}, .045f, .04f},
                                {8, {.1f, .86f, 0}, {.11f, .52f, 0}, .095f, .07f},
                                {9, {.11f, .46f, 0}, {.11f, .12f, 0}, .065f, .045f},
                                {10, {-.1f, .86f, 0}, {-.11f, .52f, 0}, .095f, .07f},
                                {11, {-.11f, .46f, 0}, {-.11f, .12f, 0}, .065f, .045f},
                                {12, {.11f, .06f, 0}, {.11f, .045f, .14f}, .05f, .042f},
                                {13, {-.11f, .06f, 0}, {-.11f, .045f, .14f}, .05f, .042f}};
    Mesh mesh = make_body(pieces, static_cast<int>(kBones.size()), cell, 0.05f, 0.03f);
    mesh.name = "walker";
    set_material(mesh, material);
    return mesh;
}

Sampler swing_of(const Bone& bone, float figure_phase) {
    Sampler sampler{.is_rotation = true, .width = 4};
    for (int k = 0; k <= 48; ++k) {
        const float share = static_cast<float>(k) / 48.0f;
        const float wave = std::sin(2.0f * kPi * (4.0f * share + bone.phase + figure_phase));
        const float half = 0.5f * glm::radians(bone.lean_degrees + bone.swing_degrees * wave);
        sampler.times_s.push_back(static_cast<float>(kLoop_s) * share);
        sampler.values.insert(sampler.values.end(), {std::sin(half), 0, 0, std::cos(half)});
    }
    return sampler;
}

// A node that shows the mesh, and joints and a skin of its own.
// placed     of the hips, from where bones are, under `parent`.
void add_walker(Scene& scene, MeshId mesh, NodeId parent, const Trs& placed, float phase, const std::string& name) {
    Skin skin;
    skin.name = name;
    for (const Bone& bone : kBones) {
        const bool is_root = bone.parent < 0;
        Node joint;
        joint.name = bone.name;
        joint.parent = is_root ? parent : skin.joints[static_cast<size_t>(bone.parent)];
        joint.local.translation = bone.place - (is_root ? glm::vec3(0.0f) : kBones[static_cast<size_t>(bone.parent)].place);
        if (is_root) {
            joint.local.translation += placed.translation;
            joint.local.rotation = placed.rotation;
        }
        const NodeId id = scene.add(std::move(joint));
        skin.joints.push_back(id);
        skin.joint_from_mesh.push_back(at(-bone.place));
        if (!is_root) add_channel(scene, id, ChannelPath::kRotation, add_sampler(scene, swing_of(bone, phase)));
    }
    Node node;
    node.name = name;
    node.mesh = mesh;
    node.skin = SkinId{static_cast<uint32_t>(scene.skins.size())};
    scene.skins.push_back(std::move(skin));
    scene.add(std::move(node));
}

}  // namespace

// One walker, on the spot, whose mesh is fine.
Content make_character_scene(int size) {
    constexpr float kCoarse = 3288.0f;  // Triangles of the walkers in a crowd.
    Content content;
    Scene& scene = content.scene;
    const float cell = kWalkerCell * std::sqrt(kCoarse / (1000.0f * static_cast<float>(size)));
    const MeshId mesh = scene.add(make_walker(add_color(scene, "walker", 0xb5725a), cell));
    add_walker(scene, mesh, kNone<NodeId>, Trs{}, 0.0f, "walker");
    add_view(scene, {0.15f, 1.35f, 1.1f}, {0.0f, 1.27f, 0.0f}, 17.0f);
    return content;
}

// Walkers on rings, eight on each; rings stand side by side. All show one mesh; each has joints and a skin of its own, and
// its own phase.
Content make_skinned_scene(int size) {
    constexpr int kRing = 8;
    constexpr float kRadius = 1.2f, kApart = 2.9f;  // Metres.
    Content content;
    Scene& scene = content.scene;
    const MeshId mesh = scene.add(make_walker(add_color(scene, "walker", 0xb5725a), kWalkerCell));
    const int ring_count = (size + kRing - 1) / kRing;
    const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<float>(ring_count))));
    NodeId ring_id = kNone<NodeId>;
    for (int i = 0; i < size; ++i) {
        const int ring = i / kRing;
        if (i % kRing == 0) {
            Node node;
            node.name = "ring " + std::to_string(ring);
            node.local.translation = {kApart * (static_cast<float>(ring % columns) - 0.5f * static_cast<float>(columns - 1)),
                                      0, -kApart * static_cast<float>(ring / columns)};
            ring_id = scene.add(std::move(node));
            add_channel(scene, ring_id, ChannelPath::kRotation, add_sampler(scene, spin({0, 1, 0}, 1, 0.0f)));
        }
        const int on_ring = std::min(kRing, size - kRing * ring);
        const float share = static_cast<float>(i % kRing) / static_cast<float>(on_ring);
        const float angle = 2.0f * kPi * share;
        const Trs placed{.translation = kRadius * glm::vec3(std::cos(angle), 0, -std::sin(angle)),
                         .rotation = glm::angleAxis(angle + kPi, glm::vec3(0, 1, 0))};
        add_walker(scene, mesh, ring_id, placed, share + 0.381966f * static_cast<float>(ring),
                   "walker " + std::to_string(i));
    }
    add_view(scene, {0.2f, 1.55f, 2.0f}, {0.0f, 1.05f, 0.0f}, 35.0f);
    return content;
}

}  // namespace zoe
