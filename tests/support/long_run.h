#pragma once

#include <cstdlib>

namespace zoe::test {

/// Whether $ZOETROPE_LONG is set: tests that can do more of the same do so, for hours if need be (`./run test --long`).
inline bool is_long_run() {
    const char* const value = std::getenv("ZOETROPE_LONG");
    return value && *value != '\0';
}

}  // namespace zoe::test
