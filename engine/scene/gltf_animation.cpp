#include "engine/scene/gltf_animation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "engine/scene/gltf_accessor.h"

namespace zoe {
namespace {

constexpr double kLengthTolerance = 1e-2;  // Of quaternions; 8 bits a component give 0.008.

std::optional<ChannelPath> path_from(const std::string& word) {
    if (word == "translation") return ChannelPath::kTranslation;
    if (word == "rotation") return ChannelPath::kRotation;
    if (word == "scale") return ChannelPath::kScale;
    if (word == "weights") return ChannelPath::kWeights;
    return std::nullopt;
}

/// Key times in order: a key earlier than the one before it is moved to that one's time, which makes a jump of it.
std::vector<float> read_times(GltfFile& file, int accessor, const std::string& place, Scene& scene) {
    require_type(file, accessor, {TINYGLTF_TYPE_SCALAR}, place);
    std::vector<float> times = read_floats(file, accessor, whole(file, accessor));
    for (size_t i = 0; i < times.size(); ++i) {
        if (!std::isfinite(times[i])) file.fail(place, fmt::format("key {} has a time that is not finite", i));
        if (times[i] < 0.0f) scene.warn("a key before time 0");
        if (i == 0 || times[i] > times[i - 1]) continue;
        scene.warn(times[i] < times[i - 1] ? "a key earlier than the one before it: moved to that one's time"
                                           : "two keys of an animation at the same time");
        times[i] = times[i - 1];
    }
    return times;
}

void normalize_rotations(Sampler& sampler, Scene& scene) {
    const bool is_spline = sampler.interpolation == Interpolation::kCubicSpline;
    const size_t step = is_spline ? 12 : 4;
    for (size_t i = is_spline ? 4 : 0; i + 4 <= sampler.values.size(); i += step) {
        float* q = &sampler.values[i];
        const double length =
            std::sqrt(double{q[0]} * q[0] + double{q[1]} * q[1] + double{q[2]} * q[2] + double{q[3]} * q[3]);
        if (!(length > 1e-12)) {
            scene.warn("an animated rotation of length 0: taken as none");
            std::fill(q, q + 3, 0.0f);
            q[3] = 1.0f;
            continue;
        }
        if (std::fabs(length - 1.0) > kLengthTolerance) scene.warn("an animated rotation whose length is not 1: normalised");
        for (int k = 0; k < 4; ++k) q[k] = static_cast<float>(q[k] / length);
    }
}

Sampler read_sampler(GltfFile& file, const tinygltf::AnimationSampler& from, ChannelPath path, uint32_t width,
                     const std::string& place, Scene& scene) {
    Sampler sampler;
    sampler.interpolation = from.interpolation == "STEP"          ? Interpolation::kStep
                            : from.interpolation == "CUBICSPLINE" ? Interpolation::kCubicSpline
                                                                  : Interpolation::kLinear;
    sampler.is_rotation = path == ChannelPath::kRotation;
    sampler.width = width;
    sampler.times_s = read_times(file, from.input, place + "/input", scene);

    const std::string in_output = place + "/output";
    const int type = path == ChannelPath::kWeights    ? TINYGLTF_TYPE_SCALAR
                     : path == ChannelPath::kRotation ? TINYGLTF_TYPE_VEC4
                                                      : TINYGLTF_TYPE_VEC3;
    require_type(file, from.output, {type}, in_output);
    const bool is_normalized = path == ChannelPath::kRotation || path == ChannelPath::kWeights;
    sampler.values = read_floats(file, from.output, whole(file, from.output), is_normalized);
    const uint64_t per_key = uint64_t{width} * (sampler.interpolation == Interpolation::kCubicSpline ? 3 : 1);
    const uint64_t wanted = sampler.times_s.size() * per_key;
    if (sampler.values.size() < wanted || (path == ChannelPath::kWeights && sampler.values.size() != wanted)) {
        file.fail(in_output,
                  fmt::format("{} values for {} keys of {}", sampler.values.size(), sampler.times_s.size(), per_key));
    }
    if (sampler.values.size() > wanted) scene.warn("an animation sampler with more values than its keys need");
    sampler.values.resize(wanted);
    for (size_t i = 0; i < sampler.values.size(); ++i) {
        if (!std::isfinite(sampler.values[i])) file.fail(in_output, fmt::format("value {} is not finite", i));
    }
    if (sampler.is_rotation) normalize_rotations(sampler, scene);
    return sampler;
}

/// Reads one animation; samplers as its channels need them, each once a way of reading it.
class ClipReader {
public:
    ClipReader(GltfFile& file, size_t clip_index, Scene& scene)
        : file_(file),
          from_(file.model.animations[clip_index]),
          place_(fmt::format("/animations/{}", clip_index)),
          scene_(scene) {}

    Clip read() {
        clip_.name = from_.name;
        for (size_t i = 0; i < from_.channels.size(); ++i) read_channel(i);
        for (const AnimationChannel& channel : clip_.channels) {
            clip_.duration_s = std::max<double>(clip_.duration_s, clip_.samplers[channel.sampler].times_s.back());
        }
        return std::move(clip_);
    }

private:
    void read_channel(size_t i) {
        const tinygltf::AnimationChannel& from = from_.channels[i];
        const std::string place = fmt::format("{}/channels/{}", place_, i);
        if (static_cast<size_t>(from.sampler) >= from_.samplers.size()) {
            file_.fail(place + "/sampler",
                       fmt::format("{} names none of the {} samplers", from.sampler, from_.samplers.size()));
        }
        const std::optional<ChannelPath> path = path_from(from.target_path);
        if (!path) {
            if (from.target_path != "pointer") file_.fail(place + "/target/path", "it cannot be animated by this name");
            scene_.warn("an animation channel with KHR_animation_pointer: ignored");
            return;
        }
        if (from.target_node < 0) {
            scene_.warn("an animation channel without a target: ignored");
            return;
        }
        const NodeId node{static_cast<uint32_t>(from.target_node)};
        uint32_t width = *path == ChannelPath::kRotation ? 4 : 3;
        if (*path == ChannelPath::kWeights) {
            const MeshId mesh = scene_[node].mesh;
            width = mesh == kNone<MeshId> ? 0 : static_cast<uint32_t>(scene_[mesh].targets.size());
            if (width == 0) {
                scene_.warn("animated weights of a node without morph targets: ignored");
                return;
            }
        }
        const std::optional<uint32_t> sampler = sampler_for(static_cast<size_t>(from.sampler), *path, width);
        if (!sampler) return;
        if (!targets_.insert({node, *path}).second)
            scene_.warn("two channels of a clip animate the same: the later one wins");
        clip_.channels.push_back({node, *path, *sampler});
    }

    std::optional<uint32_t> sampler_for(size_t sampler, ChannelPath path, uint32_t width) {
        // A translation and a scale may share a sampler; a rotation is played another way.
        const ChannelPath way = path == ChannelPath::kScale ? ChannelPath::kTranslation : path;
        const auto [found, is_new] = made_.try_emplace({sampler, way, width}, static_cast<uint32_t>(clip_.samplers.size()));
        if (!is_new) return found->second;
        Sampler made = read_sampler(file_, from_.samplers[sampler], path, width,
                                    fmt::format("{}/samplers/{}", place_, sampler), scene_);
        if (made.times_s.empty()) {
            scene_.warn("an animation sampler without keys: ignored");
            made_.erase(found);
            return std::nullopt;
        }
        clip_.samplers.push_back(std::move(made));
        return found->second;
    }

    GltfFile& file_;
    const tinygltf::Animation& from_;
    const std::string place_;
    Scene& scene_;
    Clip clip_;
    std::map<std::tuple<size_t, ChannelPath, uint32_t>, uint32_t> made_;
    std::set<std::pair<NodeId, ChannelPath>> targets_;
};

}  // namespace

std::vector<Clip> read_clips(GltfFile& file, Scene& scene) {
    std::vector<Clip> clips;
    for (size_t i = 0; i < file.model.animations.size(); ++i) clips.push_back(ClipReader(file, i, scene).read());
    return clips;
}

}  // namespace zoe
