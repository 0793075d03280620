#pragma once

#include <utility>
#include <vector>

#include "engine/deform/sample.h"

namespace zoe::test {

using Values = std::vector<float>;

/// The sampler's value at a time.
inline Values at(const Sampler& sampler, double time_s) {
    Values out(sampler.width, -99.0f);
    sample(sampler, time_s, out);
    return out;
}

/// A sampler of these keys.
inline Sampler of(Interpolation interpolation, uint32_t width, Values times_s, Values values, bool is_rotation = false) {
    return {interpolation, is_rotation, width, std::move(times_s), std::move(values)};
}

}  // namespace zoe::test
