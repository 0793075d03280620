#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "engine/render/tone_map.h"

namespace zoe {

/// Makes a film of pictures of one size with ffmpeg, where that is installed.
/// grade      of those that are not graded yet.
/// Returns    "" where `file` was written, else the reason why not; nothing is left behind then.
std::string write_mp4(std::span<const std::filesystem::path> pictures, double fps, const Grade& grade,
                      const std::filesystem::path& file);

}  // namespace zoe
