#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "engine/render/tone_map.h"

namespace zoe {

/// Positions of at most `max_count` things out of `count`, evenly spread, the first and the last among them.
std::vector<size_t> spread(size_t count, size_t max_count);

/// Puts at most twelve of the pictures, in their order, on one page and writes it as a PNG file.
/// grade      of those that are not graded yet.
/// Throws     std::runtime_error with the name of the file that could not be read or written.
void write_contact_sheet(std::span<const std::filesystem::path> pictures, const std::filesystem::path& file,
                         const Grade& grade = {});

}  // namespace zoe
