#pragma once

#include "apps/common/open_scene.h"
#include "apps/demo/gl_window.h"
#include "apps/demo/options.h"

namespace zoe {

/// Shows the scene in a window until that is closed.
/// Throws     NoWindow before anything else was done, Interrupted, and what goes wrong in a frame.
void run_window(Content& content, const Options& options);

}  // namespace zoe
