#pragma once

#include <filesystem>
#include <string_view>

namespace zoe {

/// Writes a whole file: to a temporary name beside it, then renamed, so that nobody sees half of it. A symbolic link stays
/// and what it leads to is written; a device or a pipe is written into.
/// Throws     std::runtime_error with the file's name and the reason; no temporary file is left behind.
void write_file(const std::filesystem::path& file, std::string_view text);

/// The name that `file` is written under before it is renamed: in the same folder, different for each process.
std::filesystem::path temporary_name(const std::filesystem::path& file);

/// Makes a folder and those above it, and finds out whether files can be written there.
/// Throws     std::runtime_error with the folder's name and the reason.
void make_folder(const std::filesystem::path& folder);

/// Finds out, before long work, whether `file` can be written after it. Makes nothing.
/// Throws     std::runtime_error with the file's name and the reason.
void require_writable(const std::filesystem::path& file);

}  // namespace zoe
