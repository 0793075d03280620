#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace zoe {

enum class Interpolation : uint8_t { kStep, kLinear, kCubicSpline };

/// A glTF animation sampler: values over time.
/// values     [key_count * width], or [key_count * 3 * width] for kCubicSpline: in-tangent, value, out-tangent a key.
struct Sampler {
    Interpolation interpolation = Interpolation::kLinear;
    bool is_rotation = false;    ///< Values are quaternions x, y, z, w: interpolated on the sphere, the short way.
    uint32_t width = 3;          ///< Floats a value: 3, 4 for rotations, the number of targets for weights.
    std::vector<float> times_s;  ///< Ascending; equal neighbours are a jump: the later key holds from that time on.
    std::vector<float> values;
};

/// Evaluates at a time; before the first key its value, after the last the last's.
/// sampler    at least one key; sizes as above.
/// out        [width]; rotations come out with length 1.
/// Source     The glTF 2.0 specification, appendix C.
void sample(const Sampler& sampler, double time_s, std::span<float> out);

/// Tells whether the value is the same at all times (a rotation counts q and -q as the same where that is how it plays).
bool is_constant(const Sampler& sampler);

}  // namespace zoe
