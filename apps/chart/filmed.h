#pragma once

#include "apps/common/open_scene.h"
#include "engine/render/shutter.h"

namespace zoe::chart {

/// A scene in motion before its first camera, as a film takes it: tori on circles.
struct Filmed {
    Content content = open_scene("rigid-25", 24.0);
    int width, height;
    Take take;  ///< Refers to this object.

    Filmed(int width, int height);
    Filmed(const Filmed&) = delete;
    Filmed& operator=(const Filmed&) = delete;
};

}  // namespace zoe::chart
