#pragma once

namespace zoe {

/// How instances stand in the top level. Nothing of it changes a hit.
struct PlacingConfig {
    bool has_tight_boxes = true;  ///< Around what a mesh reaches, however it is turned; else around its turned box.
};

}  // namespace zoe
