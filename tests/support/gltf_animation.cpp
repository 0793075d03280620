#include "tests/support/gltf_animation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace zoe::test {
namespace {

Quaternion quaternion(const double* v) {
    return normalised({v[0], v[1], v[2], v[3]});
}

/// On the sphere, the short way, at constant speed.
Quaternion slerp(const Quaternion& from, Quaternion to, double u) {
    double cosine = dot(from, to);
    if (cosine < 0.0) {
        to = {-to.x, -to.y, -to.z, -to.w};
        cosine = -cosine;
    }
    // The angle from the chord: exact for near and for far, where the arc cosine loses half its digits.
    const Quaternion chord{to.x - from.x, to.y - from.y, to.z - from.z, to.w - from.w};
    const double angle = 2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(dot(chord, chord))));
    const double a = angle > 0.0 ? std::sin((1.0 - u) * angle) / std::sin(angle) : 1.0 - u;
    const double b = angle > 0.0 ? std::sin(u * angle) / std::sin(angle) : u;
    return normalised({a * from.x + b * to.x, a * from.y + b * to.y, a * from.z + b * to.z, a * from.w + b * to.w});
}

}  // namespace

double clip_time_s(const DocumentClip& clip, double time_s, bool is_looping) {
    if (!is_looping || !(clip.duration_s > 0.0)) return time_s;
    const double within = std::fmod(time_s, clip.duration_s);
    return within < 0.0 ? within + clip.duration_s : within;
}

std::vector<double> sample_channel(const DocumentChannel& channel, double time_s) {
    const std::vector<double>& times = channel.times_s;
    const bool is_spline = channel.interpolation == "CUBICSPLINE";
    const size_t width = channel.width, key_size = width * (is_spline ? 3 : 1);
    const double* values = channel.values.data() + (is_spline ? width : 0);

    // Key `k` is the last at or before the time.
    const size_t after = static_cast<size_t>(std::upper_bound(times.begin(), times.end(), time_s) - times.begin());
    const size_t k = after == 0 ? 0 : after - 1;
    const double* from = values + k * key_size;
    std::vector<double> out(from, from + width);
    const bool is_rotation = channel.path == "rotation";
    if (after > 0 && after < times.size() && channel.interpolation != "STEP") {
        const double* to = from + key_size;
        const double dt = times[k + 1] - times[k];
        const double u = (time_s - times[k]) / dt;
        if (is_spline) {
            // Hermite: the out-tangent follows a key's value, the in-tangent stands before it.
            const double u2 = u * u, u3 = u2 * u;
            for (size_t i = 0; i < width; ++i) {
                out[i] = (2 * u3 - 3 * u2 + 1) * from[i] + dt * (u3 - 2 * u2 + u) * from[i + width] +
                         (3 * u2 - 2 * u3) * to[i] + dt * (u3 - u2) * (to - width)[i];
            }
        } else if (is_rotation) {
            const Quaternion q = slerp(quaternion(from), quaternion(to), u);
            out = {q.x, q.y, q.z, q.w};
        } else {
            for (size_t i = 0; i < width; ++i) out[i] = (1.0 - u) * from[i] + u * to[i];
        }
    }
    if (is_rotation) {
        const Quaternion q = quaternion(out.data());
        out = {q.x, q.y, q.z, q.w};
    }
    return out;
}

void play(const std::vector<DocumentClip>& clips, const OraclePlayback& playback, double time_s,
          std::vector<DocumentNode>* nodes) {
    for (const size_t clip_index : playback.clips) {
        if (clip_index >= clips.size()) continue;
        const DocumentClip& clip = clips[clip_index];
        for (const DocumentChannel& channel : clip.channels) {
            if (channel.node < 0) continue;
            DocumentNode& node = nodes->at(static_cast<size_t>(channel.node));
            if (node.matrix && channel.path != "weights") {
                throw std::runtime_error("oracle: an animated node is given as a matrix");
            }
            const std::vector<double> v = sample_channel(channel, clip_time_s(clip, time_s, playback.is_looping));
            if (channel.path == "translation") {
                node.translation = {v.at(0), v.at(1), v.at(2)};
            } else if (channel.path == "rotation") {
                node.rotation = {v.at(0), v.at(1), v.at(2), v.at(3)};
            } else if (channel.path == "scale") {
                node.scale = {v.at(0), v.at(1), v.at(2)};
            } else if (channel.path == "weights") {
                node.weights = v;
            }
        }
    }
}

}  // namespace zoe::test
