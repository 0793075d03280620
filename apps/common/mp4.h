#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace zoe {

/// Makes a film of pictures of one size with ffmpeg, where that is installed.
/// Returns    "" where `file` was written, else the reason why not; nothing is left behind then.
std::string write_mp4(std::span<const std::filesystem::path> pictures, double fps, const std::filesystem::path& file);

}  // namespace zoe
