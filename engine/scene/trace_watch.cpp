#include "engine/scene/trace_watch.h"

#include <limits>
#include <stdexcept>

namespace zoe {
namespace {

// Stays below 0 while batches that are about to be refused add themselves.
constexpr int64_t kHeld = std::numeric_limits<int64_t>::min() / 2;

[[noreturn]] void refuse(int64_t users) {
    throw std::logic_error(users < 0 ? "another thread is making a frame of this scene"
                                     : "rays are being traced through the scene's last frame: wait for them first");
}

}  // namespace

void TraceWatch::hold() {
    int64_t users = 0;
    if (!users_.compare_exchange_strong(users, kHeld, std::memory_order_acq_rel, std::memory_order_acquire)) refuse(users);
}

void TraceWatch::let_go() {
    users_.fetch_sub(kHeld, std::memory_order_release);
}

void TraceWatch::enter() {
    if (users_.fetch_add(1, std::memory_order_acquire) >= 0) return;
    leave();
    throw std::logic_error("rays: the scene's next frame is being made, or the scene was edited: the tree is not valid");
}

}  // namespace zoe
