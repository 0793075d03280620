#pragma once

#include <chrono>

namespace zoe {

/// Time since it was made or last asked.
class Stopwatch {
public:
    double restart_ms() {
        const Clock::time_point now = Clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - begin_).count();
        begin_ = now;
        return ms;
    }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point begin_ = Clock::now();
};

}  // namespace zoe
