#pragma once

#include <string>

#include "apps/common/open_scene.h"
#include "apps/demo/gl_window.h"
#include "apps/demo/options.h"

namespace zoe {

PictureSize first_window_size(const Options& options);

/// Shows a scene until the window is closed, or a file is dropped on it.
/// message    shown from the start; empty: nothing.
/// Returns    the file that was dropped; empty: the window was closed.
/// Throws     Interrupted, and what goes wrong in a frame.
std::string run_window(GlWindow& window, Content& content, const Options& options, const std::string& message);

}  // namespace zoe
