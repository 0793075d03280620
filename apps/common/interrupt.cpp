#include "apps/common/interrupt.h"

#include <csignal>

namespace zoe {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

void set_flag(int) {
    flag.store(true);
}

}  // namespace

void catch_interrupts() {
    static bool is_caught = false;
    if (is_caught) return;  // after a first signal, the second must still end the program
    is_caught = true;
    struct sigaction action = {};
    action.sa_handler = set_flag;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

const std::atomic<bool>& is_interrupted() {
    return flag;
}

}  // namespace zoe
