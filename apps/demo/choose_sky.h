#pragma once

#include <memory>

#include "apps/demo/options.h"
#include "engine/scene/scene.h"

namespace zoe {

/// What lights a scene from all around, by `--sky` and `--sun`; unless told, the physical sky where no node that is shown
/// has a light. Null: the renderer's own plain sky.
/// Throws     std::runtime_error for a picture that cannot be read.
std::shared_ptr<const Environment> choose_sky(const Options& options, const Scene& scene);

}  // namespace zoe
