#pragma once

#include <span>

#include "apps/demo/gl_window.h"
#include "apps/demo/window_state.h"

namespace zoe {

/// A key, or several that follow one another, and what they do.
struct KeyUse {
    int first, last;  ///< By GLFW's numbers, both included.
    const char* name;
    const char* what;
    void (*use)(WindowState& state, int offset);  ///< offset: of the key, from the first.
    bool is_repeated = false;                     ///< While it is held down.
};

/// Every key that does something, in the order of the help.
std::span<const KeyUse> key_uses();

/// Does what a key is for; nothing for others.
void use_key(WindowState& state, const KeyPress& press);

}  // namespace zoe
