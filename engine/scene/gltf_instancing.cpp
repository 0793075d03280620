#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/scene/gltf_accessor.h"
#include "engine/scene/gltf_node.h"

namespace zoe {
namespace {

constexpr size_t kMaxNodes = size_t{1} << 21;
constexpr uint64_t kMaxFreeInstances = 100000;  // Of any file; a larger one may have one for 4 bytes.
constexpr size_t kMaxCopies = size_t{1} << 26;  // Weights, sequence entries and channels that instances may repeat.

/// Reads one of the extension's attributes; empty where it is missing.
/// made       how many instances the file has so far.
std::vector<float> read_attribute(GltfFile& file, const tinygltf::Value& attributes, const char* name, int type,
                                  const std::string& place, uint64_t made, std::optional<uint64_t>* count) {
    if (!attributes.Has(name)) return {};
    const int accessor = attributes.Get(name).GetNumberAsInt();
    require_type(file, accessor, {type}, place + "/" + name);
    const GltfRange range = whole(file, accessor);
    if (count->value_or(range.end) != range.end) {
        file.fail(place + "/" + name, fmt::format("{} elements, where another attribute has {}", range.end, **count));
    }
    *count = range.end;
    const uint64_t max_count = std::max(kMaxFreeInstances, file.byte_count / 4);
    if (range.end > max_count - std::min(made, max_count)) {
        file.fail(place + "/" + name, fmt::format("{} instances with those before; a file of its size may have {}",
                                                  made + range.end, max_count));
    }
    std::vector<float> values = read_floats(file, accessor, range, type == TINYGLTF_TYPE_VEC4);
    for (size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) file.fail(place + "/" + name, fmt::format("number {} is not finite", i));
    }
    return values;
}

std::vector<Trs> read_instances(GltfFile& file, const tinygltf::Value& attributes, const std::string& place, uint64_t made,
                                Scene& scene) {
    std::optional<uint64_t> count;
    const std::vector<float> t = read_attribute(file, attributes, "TRANSLATION", TINYGLTF_TYPE_VEC3, place, made, &count);
    const std::vector<float> r = read_attribute(file, attributes, "ROTATION", TINYGLTF_TYPE_VEC4, place, made, &count);
    const std::vector<float> s = read_attribute(file, attributes, "SCALE", TINYGLTF_TYPE_VEC3, place, made, &count);
    std::vector<Trs> instances(count.value_or(0));
    for (size_t i = 0; i < instances.size(); ++i) {
        if (!t.empty()) instances[i].translation = {t[3 * i], t[3 * i + 1], t[3 * i + 2]};
        if (!s.empty()) instances[i].scale = {s[3 * i], s[3 * i + 1], s[3 * i + 2]};
        if (r.empty()) continue;
        const glm::quat q(r[4 * i + 3], r[4 * i], r[4 * i + 1], r[4 * i + 2]);
        const float length = glm::length(q);
        if (length > 0.0f && std::isfinite(length)) {
            instances[i].rotation = q / length;
        } else {
            scene.warn("an instance's rotation that cannot be normalised: taken as none");
        }
    }
    return instances;
}

/// Channels that animate the weights of a node with instances animate the instances', which show its mesh.
void move_weight_channels(const GltfFile& file, Scene& scene, const std::vector<GltfRange>& instances_of) {
    size_t added = 0;
    for (Clip& clip : scene.clips) {
        std::vector<AnimationChannel> channels;
        for (const AnimationChannel& channel : clip.channels) {
            const GltfRange range =
                index(channel.node) < instances_of.size() ? instances_of[index(channel.node)] : GltfRange{};
            if (channel.path != ChannelPath::kWeights || range.begin == range.end) {
                channels.push_back(channel);
                continue;
            }
            added += range.end - range.begin;
            if (added > kMaxCopies) file.fail("/animations", "too many channels that animate instances");
            for (uint64_t i = range.begin; i < range.end; ++i)
                channels.push_back({NodeId(i), channel.path, channel.sampler});
        }
        clip.channels = std::move(channels);
    }
}

}  // namespace

void add_instances(GltfFile& file, Scene& scene) {
    std::vector<GltfRange> instances_of(scene.nodes.size());
    size_t copies = 0;
    for (size_t i = 0; i < instances_of.size(); ++i) {
        const auto extension = file.model.nodes[i].extensions.find("EXT_mesh_gpu_instancing");
        if (extension == file.model.nodes[i].extensions.end()) continue;
        const std::string place = fmt::format("/nodes/{}/extensions/EXT_mesh_gpu_instancing/attributes", i);
        if (scene.nodes[i].mesh == kNone<MeshId> || scene.nodes[i].skin != kNone<SkinId>) {
            scene.warn("EXT_mesh_gpu_instancing on a node without a mesh or with a skin: ignored");
            continue;
        }
        const std::vector<Trs> instances = read_instances(file, extension->second.Get("attributes"), place,
                                                          scene.nodes.size() - instances_of.size(), scene);
        if (instances.empty()) {
            scene.warn("EXT_mesh_gpu_instancing without instances: ignored");
            continue;
        }
        if (instances.size() > kMaxNodes - std::min(kMaxNodes, scene.nodes.size())) {
            file.fail(place, fmt::format("more than {} nodes with the instances", kMaxNodes));
        }
        const Node& shown = scene.nodes[i];
        copies += instances.size() * (shown.weights.size() + (shown.sequence ? shown.sequence->meshes.size() : 0));
        if (copies > kMaxCopies) file.fail(place, "too many weights or sequence entries for its instances");
        instances_of[i] = {scene.nodes.size(), scene.nodes.size() + instances.size()};
        const Node original = shown;
        for (size_t k = 0; k < instances.size(); ++k) {
            Node instance;
            instance.name = fmt::format("{}[{}]", original.name, k);
            instance.parent = NodeId(i);
            instance.local = instances[k];
            instance.mesh = original.mesh;
            instance.weights = original.weights;
            instance.sequence = original.sequence;
            instance.motion = original.motion;
            instance.is_shown = original.is_shown;
            scene.nodes.push_back(std::move(instance));
        }
        scene.nodes[i].mesh = kNone<MeshId>;
        scene.nodes[i].weights.clear();
        scene.nodes[i].sequence.reset();
        scene.nodes[i].motion.reset();
    }
    move_weight_channels(file, scene, instances_of);
}

}  // namespace zoe
