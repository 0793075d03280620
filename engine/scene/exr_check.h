#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace zoe {

/// What is wrong with the header of an EXR file; empty where it is one that is read: one part of scan lines or tiles whose
/// channels are floats or halves of one size. OpenEXR takes what memory a header asks for, so this is asked first.
/// max_side   in pixels, of the picture.
std::string check_exr(std::span<const std::byte> bytes, int max_side);

}  // namespace zoe
