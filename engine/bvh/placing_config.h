#pragma once

#include <cstdint>

namespace zoe {

/// How instances stand in the top level. Nothing of it changes a hit. Chart `placing`.
struct PlacingConfig {
    bool has_tight_boxes = true;  ///< Around what a mesh reaches, however it is turned; else around its turned box.
    /// Instances that need no transform may stand in the top level as their trees' parts, the largest first.
    uint32_t most_parts = 32;         ///< That come on top of the number of instances; 0: none.
    float least_share = 1.0f / 1024;  ///< Of the scene's box's area that what is opened has at least.
};

}  // namespace zoe
