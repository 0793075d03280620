#pragma once

#include <cstddef>
#include <span>

namespace zoe {

/// Tells whether a PNG is whole: chunks inside the file, checksums right, IEND last. libpng prints to stderr and leaks
/// where they are not, so this is asked first.
bool is_whole_png(std::span<const std::byte> bytes);

}  // namespace zoe
