#include <algorithm>
#include <cmath>
#include <string>

#include "engine/frame/frame_state.h"

namespace zoe {

namespace {

// Into the clip: wrapped where it loops, else held at its ends by `sample`.
double time_in_clip(const Clip& clip, double time_s, bool is_looping) {
    if (!is_looping || !(clip.duration_s > 0.0)) return time_s;
    const double wrapped = std::fmod(time_s, clip.duration_s);
    return wrapped < 0.0 ? wrapped + clip.duration_s : wrapped;
}

void apply(const AnimationChannel& channel, std::span<const float> value, FrameState* state) {
    Trs& local = state->locals[index(channel.node)];
    switch (channel.path) {
        case ChannelPath::kTranslation:
            local.translation = {value[0], value[1], value[2]};
            break;
        case ChannelPath::kRotation:
            local.rotation = glm::quat(value[3], value[0], value[1], value[2]);
            break;
        case ChannelPath::kScale:
            local.scale = {value[0], value[1], value[2]};
            break;
        case ChannelPath::kWeights: {
            std::vector<float>& weights = state->weights[index(channel.node)];
            std::copy_n(value.begin(), std::min(value.size(), weights.size()), weights.begin());
            break;
        }
    }
}

}  // namespace

void animate(const Scene& scene, double time_s, FrameState* state) {
    state->time_s = time_s;
    for (size_t k = 0; k < scene.nodes.size(); ++k) {
        const Node& node = scene.nodes[k];
        state->locals[k] = node.local;
        if (node.mesh == kNone<MeshId>) continue;
        const std::vector<float>& rest = node.weights.empty() ? scene[node.mesh].default_weights : node.weights;
        std::copy_n(rest.begin(), std::min(rest.size(), state->weights[k].size()), state->weights[k].begin());
    }
    for (const ClipId id : scene.playback.clips) {
        if (index(id) >= scene.clips.size())
            throw SceneError(scene.file, "playback", "there is no clip " + std::to_string(index(id)));
        const Clip& clip = scene.clips[index(id)];
        const double clip_time_s = time_in_clip(clip, time_s, scene.playback.is_looping);
        for (const AnimationChannel& channel : clip.channels) {
            const Sampler& sampler = clip.samplers[channel.sampler];
            state->sampled.resize(sampler.width);
            sample(sampler, clip_time_s, state->sampled);
            apply(channel, state->sampled, state);
        }
    }
    for (const NodeId id : state->parents_first) {
        const uint32_t k = index(id);
        const Node& node = scene.nodes[k];
        const DAffine local = node.matrix ? to_daffine(*node.matrix) : to_daffine(state->locals[k]);
        DAffine& scene_from_node = state->scene_from_nodes[k];
        scene_from_node = node.parent == kNone<NodeId> ? local : state->scene_from_nodes[index(node.parent)] * local;
        state->local_matrices[k] = to_affine(local, glm::dvec3(0.0));
        state->world_matrices[k] = to_affine(scene_from_node, scene.origin);
    }
}

}  // namespace zoe
