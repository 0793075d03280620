#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/parse.h"
#include "apps/common/stats_json.h"

namespace zoe {

/// Hashes of the hits of a scene's first frames, as a line of a hash file holds them:
///     SIMD SCENE WIDTHxHEIGHT HASH HASH ...
/// A hash is 16 hex digits, the first one is frame 1's; a line that starts with # is a comment. SIMD is the target that the
/// line holds for; * is all of them.
struct SceneHashes {
    std::string simd, scene;
    PictureSize size;
    std::vector<uint64_t> hashes;
};

/// Throws     std::runtime_error with the file's name, the line, and the reason.
std::vector<SceneHashes> read_hashes(const std::filesystem::path& file);

SceneHashes hashes_of(const RunStats& run, PictureSize size);

/// Whether a line holds for the vector instructions of this machine.
bool is_for_this_target(const SceneHashes& line);

/// The lines of a file, where there is one, that do not hold for this machine's vector instructions.
/// Throws     std::runtime_error as `read_hashes` does.
std::vector<SceneHashes> lines_of_other_targets(const std::filesystem::path& file);

/// Writes the lines, and those of other vector instructions that the file holds.
/// Throws     std::runtime_error with the file's name and the reason.
void write_hashes(const std::filesystem::path& file, const std::vector<SceneHashes>& lines);

/// What differs, a line a frame; empty where nothing does.
std::string describe_difference(const SceneHashes& expected, const SceneHashes& found);

}  // namespace zoe
