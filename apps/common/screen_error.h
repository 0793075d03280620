#pragma once

#include <cmath>

#include "engine/render/film.h"
#include "engine/render/tone_map.h"
#include "engine/scene/srgb.h"

namespace zoe {

/// How far two pictures are apart as a screen shows them: root mean square over pixels and colours, in shares of white.
/// Requires   films of the same size, each with a sample or more.
inline double screen_error(const Film& a, const Film& b) {
    double squares = 0.0;
    for (size_t k = 0; k < a.sum.size(); ++k) {
        const glm::vec3 x = tone_map(Tone::kNeutral, glm::vec3(a.sum[k]) / static_cast<float>(a.sample_count)),
                        y = tone_map(Tone::kNeutral, glm::vec3(b.sum[k]) / static_cast<float>(b.sample_count));
        for (int c = 0; c < 3; ++c) {
            const double difference = (srgb_byte_from_linear(x[c]) - srgb_byte_from_linear(y[c])) / 255.0;
            squares += difference * difference;
        }
    }
    return std::sqrt(squares / (3.0 * static_cast<double>(a.sum.size())));
}

}  // namespace zoe
