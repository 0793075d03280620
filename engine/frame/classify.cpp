#include "engine/frame/classify.h"

#include <algorithm>

namespace zoe {

namespace {

struct Animated {
    std::vector<uint8_t> transform, weights;  // By node: some clip really changes it.
};

Animated find_animated(const Scene& scene) {
    Animated animated{std::vector<uint8_t>(scene.nodes.size()), std::vector<uint8_t>(scene.nodes.size())};
    for (const Clip& clip : scene.clips) {
        for (const AnimationChannel& channel : clip.channels) {
            if (is_constant(clip.samplers[channel.sampler])) continue;
            auto& flags = channel.path == ChannelPath::kWeights ? animated.weights : animated.transform;
            flags[index(channel.node)] = 1;
        }
    }
    return animated;
}

bool is_skinned(const Scene& scene, const Node& node) {
    return node.skin != kNone<SkinId> && node.mesh != kNone<MeshId> && !node.sequence &&
           scene[node.mesh].binding.influence_count > 0;
}

bool has_written_cage(const Scene& scene, const Node& node) {
    const auto is_written = [&](MeshId mesh) { return scene[mesh].surface && scene[mesh].surface->version > 0; };
    if (node.sequence) return std::any_of(node.sequence->meshes.begin(), node.sequence->meshes.end(), is_written);
    return node.mesh != kNone<MeshId> && is_written(node.mesh);
}

bool is_arbitrary(const Scene& scene, const Node& node) {
    if (node.sequence && node.sequence->meshes.size() > 1) return true;
    const MeshId mesh = node.sequence && !node.sequence->meshes.empty() ? node.sequence->meshes[0] : node.mesh;
    return mesh != kNone<MeshId> && scene[mesh].version > 0;
}

}  // namespace

std::vector<NodeMotion> classify(const Scene& scene) {
    const Animated animated = find_animated(scene);
    const size_t node_count = scene.nodes.size();
    std::vector<NodeMotion> motions(node_count);

    // The nearest node above (or at) each that a clip moves. Two nodes with the same one never move relative to each other.
    std::vector<NodeId> mover(node_count, kNone<NodeId>);
    for (const NodeId id : scene.parents_first()) {
        const NodeId parent = scene[id].parent;
        const uint32_t k = index(id);
        mover[k] = animated.transform[k] ? id : parent == kNone<NodeId> ? kNone<NodeId> : mover[index(parent)];
    }

    for (uint32_t k = 0; k < node_count; ++k) {
        const Node& node = scene.nodes[k];
        NodeMotion& motion = motions[k];
        bool is_deforming = false, is_moving = false;
        if (is_skinned(scene, node)) {
            // A skin's vertices live where its joints are; the node's own transform does not matter.
            const Skin& skin = scene.skins[index(node.skin)];
            const std::vector<uint8_t> is_used = used_joints(scene[node.mesh].binding, skin.joints.size());
            const auto first = std::find(is_used.begin(), is_used.end(), 1) - is_used.begin();
            if (first < static_cast<ptrdiff_t>(is_used.size())) motion.frame = mover[index(skin.joints[first])];
            for (size_t joint = 0; joint < is_used.size(); ++joint) {
                if (is_used[joint] && mover[index(skin.joints[joint])] != motion.frame) is_deforming = true;
            }
            if (is_deforming) motion.frame = kNone<NodeId>;
            is_moving = motion.frame != kNone<NodeId>;
        } else {
            motion.frame = NodeId{k};
            is_moving = mover[k] != kNone<NodeId>;
        }
        if (node.mesh != kNone<MeshId> && !node.sequence && !scene[node.mesh].targets.empty() && animated.weights[k])
            is_deforming = true;
        if (has_written_cage(scene, node)) is_deforming = true;
        motion.content = is_arbitrary(scene, node) ? Motion::kArbitrary
                         : is_deforming            ? Motion::kDeforming
                         : is_moving               ? Motion::kRigid
                                                   : Motion::kStatic;
        motion.motion = std::max(motion.content, node.motion.value_or(Motion::kStatic));
    }
    return motions;
}

void set_motion(Scene& scene, NodeId node, Motion motion) {
    const Motion content = classify(scene).at(index(node)).content;
    if (motion < content) {
        throw SceneError(scene.file.empty() ? "scene" : scene.file, "/nodes/" + std::to_string(index(node)),
                         std::string("cannot be ") + name(motion) + ": its content is " + name(content));
    }
    scene.touch();
    scene[node].motion = motion;
}

}  // namespace zoe
