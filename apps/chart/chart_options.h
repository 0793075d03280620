#pragma once

#include <optional>
#include <string>
#include <vector>

namespace zoe::chart {

/// What the command line asks for.
struct Options {
    std::vector<std::string> charts;  ///< Empty: all.
    bool is_list = false;
    bool is_quick = false;
    int threads = 0;        ///< 0: all.
    bool has_peer = false;  ///< Where the program was built with it, unless told otherwise.
    std::string out = "out/charts";

    /// A line that makes a chart in the same way.
    std::string command(const std::string& chart) const;
};

/// Reads the command line; prints the help where that is asked for.
/// Returns    nothing where there is nothing left to do.
/// Throws     UsageError.
std::optional<Options> parse_options(int argc, char** argv);

}  // namespace zoe::chart
