#pragma once

#include <atomic>
#include <stdexcept>

namespace zoe {

/// From now on SIGINT and SIGTERM only set `is_interrupted`; a second one ends the program at once. Called when there is
/// something to leave whole: until then, the first signal ends the program. Further calls change nothing.
void catch_interrupts();
/// What long work looks at between its steps; fits RenderConfig::cancel.
const std::atomic<bool>& is_interrupted();

/// What programs end with that were interrupted, as shells have it.
inline constexpr int kInterruptedCode = 130;

/// Thrown by long work that stopped because of `is_interrupted`.
class Interrupted : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace zoe
