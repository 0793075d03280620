#pragma once

#include "apps/demo/gl_window.h"
#include "apps/demo/options.h"

namespace zoe {

/// Shows a scene, then those that are dropped on the window, until it is closed. Scenes are opened and rendered beside it.
/// Throws     Interrupted, what is wrong with the first scene, and what goes wrong in a frame.
void run_window(GlWindow& window, const Options& options);

}  // namespace zoe
