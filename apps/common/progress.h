#pragma once

#include <chrono>
#include <string>

namespace zoe {

/// A bar with the time left, on stderr: redrawn in place on a terminal, else a line now and then.
class Progress {
public:
    /// total      Steps of about equal length.
    Progress(std::string what, double total);
    ~Progress();  ///< Clears the bar.
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// done       Steps so far, fractions allowed.
    /// detail     What is being worked on, such as "frame 12".
    void update(double done, const std::string& detail);

private:
    using Clock = std::chrono::steady_clock;
    std::string what_;
    double total_;
    bool is_terminal_;
    bool is_drawn_ = false;
    Clock::time_point begin_, next_;
};

/// "0:07", "12:30", "1:02:03".
std::string format_duration(double seconds);

}  // namespace zoe
