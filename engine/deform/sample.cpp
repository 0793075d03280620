#include "engine/deform/sample.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace zoe {

namespace {

float dot4(const float* a, const float* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

void normalize4(float* q) {
    const float length = std::sqrt(dot4(q, q));
    if (length > 0.0f && std::isfinite(length)) {
        for (int k = 0; k < 4; ++k) q[k] /= length;
    } else {
        q[0] = q[1] = q[2] = 0.0f;
        q[3] = 1.0f;
    }
}

// Along the great circle, the short way: q and -q are one rotation.
void slerp(const float* a, const float* b, float s, float* out) {
    float cosine = dot4(a, b);
    const float sign = cosine < 0.0f ? -1.0f : 1.0f;
    cosine *= sign;
    float weight_a = 1.0f - s, weight_b = s;
    if (cosine < 0.99999f) {  // Closer than that, a straight line is within 1e-8 of the arc.
        const float angle = std::acos(cosine), sine = std::sin(angle);
        weight_a = std::sin((1.0f - s) * angle) / sine;
        weight_b = std::sin(s * angle) / sine;
    }
    for (int k = 0; k < 4; ++k) out[k] = weight_a * a[k] + weight_b * sign * b[k];
}

// Index of the last key at or before a time; -1 before the first.
ptrdiff_t key_before(const std::vector<float>& times_s, double time_s) {
    return std::upper_bound(times_s.begin(), times_s.end(), time_s) - times_s.begin() - 1;
}

const float* value_at(const Sampler& sampler, size_t key) {
    const size_t width = sampler.width;
    return sampler.interpolation == Interpolation::kCubicSpline ? &sampler.values[(3 * key + 1) * width]
                                                                : &sampler.values[key * width];
}

// Between keys of one value nothing moves, to the last bit: what `is_constant` says, weights that sum to 1 only nearly would
// contradict.
bool is_still(const Sampler& sampler, size_t key) {
    const size_t width = sampler.width;
    const float* a = value_at(sampler, key);
    const float* b = value_at(sampler, key + 1);
    if (sampler.interpolation == Interpolation::kCubicSpline) {
        const auto is_zero = [](float tangent) { return tangent == 0.0f; };
        return std::equal(a, a + width, b) && std::all_of(a + width, a + 2 * width, is_zero) &&
               std::all_of(b - width, b, is_zero);
    }
    return std::equal(a, a + width, b) ||
           (sampler.is_rotation && std::equal(a, a + width, b, [](float x, float y) { return x == -y; }));
}

// Hermite spline between two keys `dt` seconds apart. Tangents are a second's: in-tangent, value, out-tangent a key.
void sample_cubic(const Sampler& sampler, size_t key, float s, float dt, std::span<float> out) {
    const size_t width = sampler.width;
    const float* here = &sampler.values[3 * key * width];
    const float* next = here + 3 * width;
    const float s2 = s * s, s3 = s2 * s;
    const float value_here = 2 * s3 - 3 * s2 + 1, value_next = -2 * s3 + 3 * s2;
    const float tangent_here = dt * (s3 - 2 * s2 + s), tangent_next = dt * (s3 - s2);
    for (size_t k = 0; k < width; ++k) {
        out[k] = value_here * here[width + k] + tangent_here * here[2 * width + k] + value_next * next[width + k] +
                 tangent_next * next[k];
    }
}

}  // namespace

void sample(const Sampler& sampler, double time_s, std::span<float> out) {
    const std::vector<float>& times_s = sampler.times_s;
    assert(!times_s.empty() && out.size() == sampler.width);
    const size_t width = sampler.width;
    const ptrdiff_t key = std::max<ptrdiff_t>(key_before(times_s, time_s), 0);
    const size_t next = key + 1;
    const bool is_between = next < times_s.size() && time_s > times_s[key] &&
                            sampler.interpolation != Interpolation::kStep && !is_still(sampler, static_cast<size_t>(key));
    if (!is_between) {
        std::copy_n(value_at(sampler, key), width, out.begin());
    } else {
        // Differences of doubles: exact for float keys.
        const double dt = double(times_s[next]) - times_s[key];
        const float s = static_cast<float>((time_s - times_s[key]) / dt);
        const float* a = value_at(sampler, key);
        const float* b = value_at(sampler, next);
        if (sampler.interpolation == Interpolation::kCubicSpline) {
            sample_cubic(sampler, key, s, static_cast<float>(dt), out);
        } else if (sampler.is_rotation) {
            slerp(a, b, s, out.data());
        } else {
            for (size_t k = 0; k < width; ++k) out[k] = a[k] + s * (b[k] - a[k]);
        }
    }
    if (sampler.is_rotation) normalize4(out.data());
}

bool is_constant(const Sampler& sampler) {
    const size_t width = sampler.width, key_count = sampler.times_s.size();
    if (key_count <= 1) return true;
    const float* first = value_at(sampler, 0);
    const bool is_cubic = sampler.interpolation == Interpolation::kCubicSpline;
    for (size_t key = 0; key < key_count; ++key) {
        const float* value = value_at(sampler, key);
        const bool is_same = std::equal(first, first + width, value);
        const bool is_opposite = sampler.is_rotation && !is_cubic &&
                                 std::equal(first, first + width, value, [](float a, float b) { return a == -b; });
        if (!is_same && !is_opposite) return false;
        if (!is_cubic) continue;
        // A tangent before the first key or after the last is never played.
        const auto is_zero = [](float tangent) { return tangent == 0.0f; };
        if (key > 0 && !std::all_of(value - width, value, is_zero)) return false;
        if (key + 1 < key_count && !std::all_of(value + width, value + 2 * width, is_zero)) return false;
    }
    return true;
}

}  // namespace zoe
