#pragma once

#include "apps/common/open_scene.h"
#include "apps/demo/options.h"

namespace zoe {

/// Renders the frames into pictures, then a contact sheet and a film, and prints where they are and what they took.
/// Throws     std::runtime_error for what cannot be written, Interrupted; pictures that are there are whole.
void run_headless(Content& content, const Options& options);

}  // namespace zoe
