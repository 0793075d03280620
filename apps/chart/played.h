#pragma once

#include <cstdint>
#include <vector>

#include "engine/render/film.h"
#include "engine/render/guides.h"

namespace zoe::chart {

/// Frames of the default scene in motion, seen by the camera that swings: as the window plays them, or what they converge
/// to.
struct Played {
    static constexpr int kFrames = 10;  ///< Those before the last are history only.
    /// Of the random numbers of pictures that others are compared with: samples are others than those of frames.
    static constexpr uint32_t kReferenceBegin = 1 << 20;

    struct Way {
        int width = 0, height = 0;
        int sample_count = 1, bounce_count = 2;
        bool is_lit = true, is_jittered = false;
        uint32_t first_number = 0;
        int begin = 0;  ///< First frame.
    };
    /// Throws     Interrupted.
    explicit Played(const Way& way);

    std::vector<Film> films;
    std::vector<Guides> guides;
    double seconds = 0.0;  ///< A frame.
};

}  // namespace zoe::chart
