#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace zoe {

/// Reads a whole file.
/// Throws     std::runtime_error with the reason only: missing, a directory or device, unreadable, above `max_bytes`.
std::vector<std::byte> read_whole_file(const std::filesystem::path& file, uint64_t max_bytes);

/// The file that a glTF URI names, every link followed; it exists.
/// Throws     std::runtime_error with the reason only: for other schemes, and for a path that leaves the folder, be it by
///            "..", as an absolute path, or through a symbolic link.
std::filesystem::path find_uri_file(const std::string& uri, const std::filesystem::path& folder);

/// Reads what a glTF URI names: data in the URI itself (base64), or a file below `folder`.
/// Throws     std::runtime_error with the reason only: see read_whole_file and find_uri_file; also for malformed data.
std::vector<std::byte> read_uri(const std::string& uri, const std::filesystem::path& folder, uint64_t max_bytes);

/// "a%20b" -> "a b". Returns false for a malformed escape and for %00.
bool decode_percent(std::string_view text, std::string* out);

/// Returns    false for characters outside the alphabet, and for a length that no bytes have.
bool decode_base64(std::string_view text, std::vector<std::byte>* out);

/// A URI short enough to show in a message.
std::string shown(const std::string& uri);

}  // namespace zoe
