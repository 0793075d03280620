#include "apps/common/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace zoe {

Progress::Progress(std::string what, double total)
    : what_(std::move(what)), total_(std::max(total, 1e-9)), is_terminal_(isatty(STDERR_FILENO) == 1) {
    begin_ = Clock::now();
    next_ = begin_ + (is_terminal_ ? std::chrono::milliseconds(0) : std::chrono::milliseconds(5000));
}

Progress::~Progress() {
    if (is_drawn_) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(double done, const std::string& detail) {
    const Clock::time_point now = Clock::now();
    if (now < next_) return;
    next_ = now + (is_terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(10000));

    const double share = std::clamp(done / total_, 0.0, 1.0);
    const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
    const std::string left = share > 0.0 ? format_duration(elapsed_s * (1.0 - share) / share) + " left" : "";
    if (is_terminal_) {
        constexpr int kBarWidth = 30;
        const int filled = static_cast<int>(share * kBarWidth);
        const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
        fmt::print(stderr, "\r{} [{}] {:3.0f} %  {}  {}\x1b[K", what_, bar, 100.0 * share, detail, left);
        std::fflush(stderr);
        is_drawn_ = true;
    } else {
        fmt::print(stderr, "{} {:.0f} %  {}  {}\n", what_, 100.0 * share, detail, left);
    }
}

std::string format_duration(double seconds) {
    const auto whole = static_cast<int64_t>(std::clamp(std::ceil(seconds), 0.0, 1e9));
    const int64_t hours = whole / 3600, minutes = whole / 60 % 60, rest = whole % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, rest) : fmt::format("{}:{:02}", minutes, rest);
}

}  // namespace zoe
