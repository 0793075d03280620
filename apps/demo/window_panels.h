#pragma once

#include <span>

#include "apps/demo/gl_window.h"
#include "apps/demo/window_state.h"

namespace zoe {

/// Puts the whole interface on the window: the picture, the panel beside it, the timeline under it, and the keys. Changes
/// the state as the user does. Never waits.
/// keys       since the last call.
void draw_panels(WindowState& state, std::span<const KeyPress> keys);

/// What is known of the picked node, and a choice of its class.
void draw_node(WindowState& state);

/// The five stage times of the latest frames as lines, on a logarithmic scale, and the newest as numbers.
void draw_stage_graph(const std::deque<FrameStats>& history);

}  // namespace zoe
