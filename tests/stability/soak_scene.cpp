#include "tests/stability/soak_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "engine/frame/classify.h"
#include "tests/stability/scenes.h"

namespace zoe::test {
namespace {

constexpr size_t kMostNodes = 40;
// Positions in `meshes`.
constexpr MeshId kSkinned{2}, kMorphed{3}, kWritten{4}, kWrittenToo{5};
constexpr MeshId kPlain[] = {MeshId{0}, MeshId{1}, kMorphed, kWritten, kWrittenToo};

Mesh skinned_ball() {
    Mesh mesh = ball(10);
    mesh.binding.influence_count = 4;
    for (const glm::vec3& p : mesh.positions) {
        const float upper = 0.5f + 0.5f * p.y;
        mesh.binding.joints.insert(mesh.binding.joints.end(), {0, 1, 0, 0});
        mesh.binding.weights.insert(mesh.binding.weights.end(), {1.0f - upper, upper, 0, 0});
    }
    return mesh;
}

Mesh morphed_ball() {
    Mesh mesh = ball(12);
    MorphTarget target;
    for (const glm::vec3& p : mesh.positions) target.positions.push_back(glm::vec3(0.5f * p.y, 0, p.x));
    mesh.targets = {target};
    mesh.default_weights = {0.25f};
    return mesh;
}

/// A clip that turns node 1, moves node 2 and morphs node 3.
Clip make_clip(float way) {
    Clip clip;
    clip.samplers = {
        {.is_rotation = true, .width = 4, .times_s = {0, 1, 2}, .values = {0, 0, 0, 1, 0, way, 0, 0, 0, 0, 0, 1}},
        {.width = 3, .times_s = {0, 2}, .values = {0, 0, 0, way, 1, 0}},
        {.interpolation = Interpolation::kStep, .width = 1, .times_s = {0, 0.5f}, .values = {0, way}}};
    clip.channels = {{NodeId{1}, ChannelPath::kRotation, 0},
                     {NodeId{2}, ChannelPath::kTranslation, 1},
                     {NodeId{3}, ChannelPath::kWeights, 2}};
    clip.duration_s = 2.0;
    return clip;
}

/// What stands for the triangles of a written mesh: balls of all sizes, nothing, and such as hold NaN.
Mesh written_shape(Rng& rng) {
    const uint32_t kind = rng.below(16);
    if (kind == 0) return {};
    Mesh mesh = ball(6 + 2 * static_cast<int>(rng.below(6)));
    for (glm::vec3& p : mesh.positions) p *= rng.uniform(0.8f, 1.2f);
    if (kind == 1) mesh.positions[rng.below(6)].y = std::numeric_limits<float>::quiet_NaN();
    if (kind == 2) mesh.corners.resize(1);
    return mesh;
}

void write_shape(Scene& scene, MeshId id, Rng& rng) {
    const Mesh mesh = written_shape(rng);
    scene.write_mesh(id, mesh.positions, {}, mesh.corners);
}

/// Ids above a node that was removed are one less.
void shift(NodeId& id, uint32_t removed) {
    if (id != kNone<NodeId> && index(id) > removed) id = NodeId{index(id) - 1};
}

}  // namespace

SoakScene::SoakScene(uint64_t seed) : rng_(seed) {
    for (Mesh mesh : {ball(16), ball(8), skinned_ball(), morphed_ball(), ball(8), ball(6)}) scene.add(std::move(mesh));
    // The first nodes stay: two joints, what the clip moves, and one of each kind.
    const auto add = [&](NodeId parent, MeshId mesh, const glm::vec3& place) -> Node& {
        Node node;
        node.name = "first";
        node.parent = parent;
        node.mesh = mesh;
        node.local.translation = place;
        return scene[scene.add(std::move(node))];
    };
    add(kNone<NodeId>, kNone<MeshId>, {0, 0, 0});
    add(NodeId{0}, kNone<MeshId>, {0, 1, 0});
    add(kNone<NodeId>, MeshId{0}, {3, 0, 0});
    add(NodeId{2}, kMorphed, {0, 3, 0});
    add(kNone<NodeId>, kSkinned, {0, 0, 0}).skin = SkinId{0};
    add(kNone<NodeId>, kWritten, {-3, 0, 0});
    add(kNone<NodeId>, MeshId{0}, {0, 0, -4}).sequence = MeshSequence{{MeshId{0}, MeshId{1}}, 6.0};
    scene.skins.push_back({"skin", {NodeId{0}, NodeId{1}}, {Affine{}, Affine{}}});
    scene.clips = {make_clip(1.0f), make_clip(-1.0f)};
    scene.playback.clips = {ClipId{0}};
    first_nodes_ = scene.nodes;
    first_meshes_ = scene.meshes;
    first_skins_ = scene.skins;
    first_clips_ = scene.clips;
}

void SoakScene::edit() {
    switch (rng_.below(16)) {
        case 0:
            return add_node();
        case 1:
            return remove_node();
        case 2:
        case 3:
            return change_node();
        case 4:
            return retarget();
        case 5:
            return ask_for_class();
        case 6:
            return replace_mesh();
        case 7:
            return break_scene();
        case 8:
            return change_settings();
        case 9:
        case 10:
        case 11:
            return write_shape(scene, rng_.below(2) == 0 ? kWritten : kWrittenToo, rng_);
        default:
            return;  // Time goes on.
    }
}

void SoakScene::write(uint64_t step) {
    Rng rng(mix_bits(step + 1));
    write_shape(scene, kWritten, rng);
    scene.origin = {0.25 * static_cast<double>(rng.below(5)), 0, 0};
}

void SoakScene::restore() {
    scene.nodes = first_nodes_;
    scene.meshes = first_meshes_;
    scene.skins = first_skins_;
    scene.clips = first_clips_;
    scene.playback = {.clips = {ClipId{0}}};
    scene.origin = glm::dvec3(0.0);
    scene.placing = {};
    scene.tlas_build = {};
    scene.touch();
}

void SoakScene::add_node() {
    if (scene.nodes.size() >= kMostNodes) return;
    Node node;
    node.name = "added";
    if (rng_.below(2) == 0) node.parent = some_node();
    node.local.translation = {rng_.uniform(-6, 6), rng_.uniform(-6, 6), rng_.uniform(-6, 6)};
    node.local.scale = glm::vec3(rng_.uniform(0.3f, 1.5f), rng_.uniform(0.3f, 1.5f), rng_.uniform(-1.5f, 1.5f));
    node.mesh = rng_.below(8) == 0 ? kSkinned : kPlain[rng_.below(5)];
    if (node.mesh == kSkinned) node.skin = SkinId{0};
    if (rng_.below(8) == 0) node.sequence = MeshSequence{{MeshId{1}, kWrittenToo, MeshId{0}}, 12.0};
    if (rng_.below(4) == 0) {
        node.matrix = to_affine(node.local);
        node.matrix->linear[0].y += 0.5f;
    }
    scene.add(std::move(node));  // Seen without a touch.
}

// One that nothing hangs from and nothing names, but for channels: those go with it.
void SoakScene::remove_node() {
    if (scene.nodes.size() <= first_nodes_.size()) return;
    const uint32_t first = static_cast<uint32_t>(first_nodes_.size());
    const uint32_t removed = first + rng_.below(static_cast<uint32_t>(scene.nodes.size()) - first);
    const NodeId id{removed};
    for (const Node& node : scene.nodes) {
        if (node.parent == id) return;
    }
    for (const Skin& skin : scene.skins) {
        if (std::ranges::find(skin.joints, id) != skin.joints.end()) return;
    }
    scene.nodes.erase(scene.nodes.begin() + removed);
    for (Node& node : scene.nodes) shift(node.parent, removed);
    for (Skin& skin : scene.skins) {
        for (NodeId& joint : skin.joints) shift(joint, removed);
    }
    for (Clip& clip : scene.clips) {
        std::erase_if(clip.channels, [&](const AnimationChannel& channel) { return channel.node == id; });
        for (AnimationChannel& channel : clip.channels) shift(channel.node, removed);
    }
    scene.touch();
}

void SoakScene::change_node() {
    Node& node = scene[some_node()];
    switch (rng_.below(7)) {
        case 5: {  // Hung elsewhere, but from nothing that hangs from it.
            const NodeId parent = node.parent;
            node.parent = some_node();
            try {
                scene.parents_first();
            } catch (const SceneError&) {
                node.parent = parent;
            }
            break;
        }
        case 0:
            node.is_shown = !node.is_shown;
            break;
        case 1:
            node.local.scale = node.local.scale.x == 0.0f ? glm::vec3(1.0f) : glm::vec3(0.0f, 1.0f, 1.0f);
            break;
        case 2:
            node.local.translation += glm::vec3(rng_.uniform(-1, 1), rng_.uniform(-1, 1), rng_.uniform(-1, 1));
            break;
        case 3:
            node.local.rotation = glm::quat(0.0f, 0.6f, 0.0f, 0.8f);
            break;
        case 4:
            node.motion.reset();
            break;
        default:
            if (node.mesh != kNone<MeshId> && node.mesh != kSkinned && node.weights.empty())
                node.mesh = kPlain[rng_.below(2)];
            std::erase_if(scene.clips[0].channels,
                          [](const AnimationChannel& channel) { return channel.path == ChannelPath::kWeights; });
            std::erase_if(scene.clips[1].channels,
                          [](const AnimationChannel& channel) { return channel.path == ChannelPath::kWeights; });
    }
    scene.touch();
}

// What joints and channels move, and which clips play.
void SoakScene::retarget() {
    switch (rng_.below(4)) {
        case 0:
            scene.skins[0].joints[rng_.below(2)] = some_node();
            break;
        case 1: {
            const NodeId node = some_node();
            std::vector<AnimationChannel>& channels = scene.clips[rng_.below(2)].channels;
            if (channels.empty() || scene[node].matrix) break;
            AnimationChannel& channel = channels[rng_.below(static_cast<uint32_t>(channels.size()))];
            if (channel.path != ChannelPath::kWeights) channel.node = node;
            break;
        }
        case 2:
            scene.playback.clips.clear();
            if (rng_.below(3) != 0) scene.playback.clips.push_back(ClipId{rng_.below(2)});
            if (rng_.below(3) == 0) scene.playback.clips.push_back(ClipId{rng_.below(2)});
            break;
        default:
            scene.playback.is_looping = !scene.playback.is_looping;
    }
    scene.touch();
}

void SoakScene::ask_for_class() {
    const NodeId node = some_node();
    try {
        set_motion(scene, node, static_cast<Motion>(rng_.below(kMotionCount)));
    } catch (const SceneError&) {  // Its content moves more than that.
    }
}

// By hand, the topology included: another mesh in the place of one that nothing follows vertex by vertex.
void SoakScene::replace_mesh() {
    const MeshId id = kPlain[rng_.below(2)];
    scene[id] = ball(6 + 2 * static_cast<int>(rng_.below(8)));
    scene.touch();
}

// A parent that is none of the nodes: the next frame is refused, and the one after it is as if nothing had been.
void SoakScene::break_scene() {
    const NodeId parent = scene.nodes.back().parent;
    scene.nodes.back().parent = NodeId{static_cast<uint32_t>(scene.nodes.size())};
    scene.touch();
    try {
        advance(scene, 0.0);
        throw std::logic_error("a scene with a missing parent was played");
    } catch (const SceneError&) {
    }
    scene.nodes.back().parent = parent;
    scene.touch();
}

void SoakScene::change_settings() {
    scene.placing.has_tight_boxes = rng_.below(2) == 0;
    scene.placing.most_parts = 8 * rng_.below(8);
    scene.tlas_build.exact_up_to = rng_.below(2) == 0 ? 0 : 1000;
    scene.origin = {rng_.uniform(-2, 2), 0, 0};
}

Scene copy_of(const Scene& scene) {
    Scene copy;
    copy.file = scene.file;
    copy.nodes = scene.nodes;
    copy.meshes = scene.meshes;
    copy.skins = scene.skins;
    copy.clips = scene.clips;
    copy.cameras = scene.cameras;
    copy.lights = scene.lights;
    copy.materials = scene.materials;
    copy.images = scene.images;
    copy.playback = scene.playback;
    copy.origin = scene.origin;
    copy.tree_build = scene.tree_build;
    copy.tlas_build = scene.tlas_build;
    copy.placing = scene.placing;
    return copy;
}

}  // namespace zoe::test
