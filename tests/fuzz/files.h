#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "tests/support/read_bytes.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {

/// A folder whose files take no disk, where the system has one; else the one for temporary files.
std::filesystem::path memory_folder();

/// Writes a file from its beginning, in the place of what was in it. By system calls: this is done millions of times.
/// Throws     std::runtime_error.
void overwrite(const std::filesystem::path& file, std::span<const std::byte> bytes);

inline std::span<const std::byte> as_bytes(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

}  // namespace zoe::test
