#include "apps/common/place_copies.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/common/choose_view.h"
#include "engine/frame/bounds_at.h"

namespace zoe {
namespace {

constexpr float kGap = 1.1f;  // From copy to copy, of the original's size.

/// What it is at a time plus `later_s`, over a clip that loops.
Sampler shifted(const Sampler& sampler, double duration_s, double later_s) {
    if (is_constant(sampler) || !(duration_s > 0.0)) return sampler;
    Sampler out{
        .interpolation = sampler.interpolation == Interpolation::kStep ? Interpolation::kStep : Interpolation::kLinear,
        .is_rotation = sampler.is_rotation,
        .width = sampler.width};
    const size_t key_count = std::max<size_t>(sampler.times_s.size(), 2);
    out.values.resize(key_count * sampler.width);
    for (size_t k = 0; k < key_count; ++k) {
        const double time_s = duration_s * static_cast<double>(k) / static_cast<double>(key_count - 1);
        out.times_s.push_back(static_cast<float>(time_s));
        sample(sampler, std::fmod(time_s + later_s, duration_s),
               std::span(out.values).subspan(k * sampler.width, sampler.width));
    }
    return out;
}

/// Ids of what a copy has of its own, counted on from the original's.
struct Offsets {
    uint32_t node, skin;

    NodeId operator()(NodeId id) const { return id == kNone<NodeId> ? id : NodeId{index(id) + node}; }
    SkinId operator()(SkinId id) const { return id == kNone<SkinId> ? id : SkinId{index(id) + skin}; }
};

void add_copy(const std::vector<Node>& nodes, const std::vector<Skin>& skins, const std::vector<Clip>& clips,
              const glm::vec3& place, double share, Scene* scene) {
    const NodeId root = scene->add(Node{.name = "copy", .local = {.translation = place}});
    const Offsets moved{static_cast<uint32_t>(scene->nodes.size()), static_cast<uint32_t>(scene->skins.size())};
    for (const Node& original : nodes) {
        Node node = original;
        node.parent = node.parent == kNone<NodeId> ? root : moved(node.parent);
        node.skin = moved(node.skin);
        node.light = kNone<LightId>;
        scene->add(std::move(node));
    }
    for (const Skin& original : skins) {
        Skin skin = original;
        for (NodeId& joint : skin.joints) joint = moved(joint);
        scene->skins.push_back(std::move(skin));
    }
    for (size_t k = 0; k < clips.size(); ++k) {
        Clip& clip = scene->clips[k];
        const auto first = static_cast<uint32_t>(clip.samplers.size());
        for (const Sampler& sampler : clips[k].samplers) {
            clip.samplers.push_back(shifted(sampler, clip.duration_s, share * clip.duration_s));
        }
        for (AnimationChannel channel : clips[k].channels) {
            channel.node = moved(channel.node);
            channel.sampler += first;
            clip.channels.push_back(channel);
        }
    }
}

}  // namespace

void place_copies(int copy_count, Scene* scene) {
    if (copy_count <= 1) return;
    for (Node& node : scene->nodes) node.camera = kNone<CameraId>;
    Aabb box;
    for (const double time_s : times_over_clip(*scene, 0.0)) box.extend(bounds_at(*scene, time_s));
    const glm::vec3 pitch = box.is_empty() ? glm::vec3(1.0f) : kGap * box.extent();
    const std::vector<Node> nodes = scene->nodes;
    const std::vector<Skin> skins = scene->skins;
    const std::vector<Clip> clips = scene->clips;
    const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(copy_count))));
    for (int k = 1; k < copy_count; ++k) {
        const glm::vec3 place = pitch * glm::vec3(k % columns, 0.0f, -(k / columns));
        add_copy(nodes, skins, clips, place, static_cast<double>(k) / copy_count, scene);
    }
    scene->touch();
}

}  // namespace zoe
