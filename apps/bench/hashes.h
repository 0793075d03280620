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

/// The lines that hold for this machine's vector instructions: their own, and those for all where there is no own one for
/// the same scene and size.
std::vector<SceneHashes> lines_for_this_target(std::vector<SceneHashes> lines);

/// Writes the lines in place of those for this machine's vector instructions that the file holds; its others stay.
/// Throws     std::runtime_error with the file's name and the reason.
void write_hashes(const std::filesystem::path& file, const std::vector<SceneHashes>& lines);

/// What differs, a line a frame; empty where nothing does.
std::string describe_difference(const SceneHashes& expected, const SceneHashes& found);

}  // namespace zoe
