#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace zoe {

/// A JPEG without what is not its picture: EXIF, IPTC, ICC, comments. OpenImageIO reads past the end of such records where
/// they lie about their lengths, and none of them is asked for. Cut off at the first segment that cannot be read.
std::vector<std::byte> without_metadata(std::span<const std::byte> jpeg);

}  // namespace zoe
