#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/bench/peer_options.h"
#include "apps/common/parse.h"

namespace zoe {

/// What the command line of the benchmark asks for.
struct Options {
    std::vector<std::string> scenes;  ///< Empty: all of the benchmark's own.
    bool is_list = false;
    bool compares_trees = false;      ///< Builders instead of frames.
    std::optional<int> frames;        ///< Measured ones; each scene has its own number otherwise.
    std::optional<PictureSize> size;  ///< Likewise.
    std::optional<int> repeats;       ///< Likewise.
    int threads = 0;                  ///< 0: all.
    bool is_exact = false;            ///< The top level is clustered exactly.

    bool has_peer = false;
    PeerOptions peer;

    std::optional<std::string> json, csv, disagreements, expected_hashes, written_hashes;
};

/// Reads the command line; prints the help where that is asked for.
/// Returns    nothing where there is nothing left to do.
/// Throws     UsageError.
std::optional<Options> parse_options(int argc, char** argv);

}  // namespace zoe
