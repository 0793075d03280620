#pragma once

#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/render/film.h"

namespace zoe {

/// How far two pictures are apart as a screen shows them: root mean square over pixels and colours, in shares of white.
/// a, b       [pixel_count * 4], as `to_rgba8` makes them.
inline double screen_error(std::span<const uint8_t> a, std::span<const uint8_t> b) {
    assert(a.size() == b.size());
    double squares = 0.0;
    for (size_t i = 0; i < a.size(); ++i) {
        const double difference = i % 4 == 3 ? 0.0 : (a[i] - b[i]) / 255.0;
        squares += difference * difference;
    }
    return std::sqrt(squares / (0.75 * static_cast<double>(a.size())));
}

/// Requires   films of the same size, each with a sample or more.
inline double screen_error(const Film& a, const Film& b) {
    return screen_error(to_rgba8(a), to_rgba8(b));
}

}  // namespace zoe
