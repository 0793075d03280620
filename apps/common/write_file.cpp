#include "apps/common/write_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <unistd.h>

namespace zoe {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& reason) {
    throw std::runtime_error(fmt::format("{}: {}", path.native(), reason));
}

}  // namespace

std::filesystem::path temporary_name(const std::filesystem::path& file) {
    return file.parent_path() / fmt::format(".{}.{}{}", file.stem().native(), getpid(), file.extension().native());
}

void write_file(const std::filesystem::path& file, std::string_view text) {
    const std::filesystem::path temporary = temporary_name(file);
    std::FILE* const stream = std::fopen(temporary.c_str(), "wb");
    if (!stream) fail(file, fmt::format("cannot be written: {}", std::strerror(errno)));
    int error = 0;
    if (std::fwrite(text.data(), 1, text.size(), stream) != text.size()) error = errno;
    if (std::fclose(stream) != 0 && error == 0) error = errno;
    if (error == 0 && std::rename(temporary.c_str(), file.c_str()) != 0) error = errno;
    if (error != 0) {
        std::remove(temporary.c_str());
        fail(file, fmt::format("cannot be written: {}", std::strerror(error)));
    }
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) fail(folder, fmt::format("the folder cannot be made: {}", error.message()));
    if (access(folder.c_str(), W_OK | X_OK) != 0) {
        fail(folder, fmt::format("the folder cannot be written to: {}", std::strerror(errno)));
    }
}

void require_writable(const std::filesystem::path& file) {
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    if (!std::filesystem::is_directory(folder)) fail(file, "cannot be written: there is no such folder");
    if (std::filesystem::is_directory(file)) fail(file, "cannot be written: it is a folder");
    if (access(folder.c_str(), W_OK | X_OK) != 0) fail(file, fmt::format("cannot be written: {}", std::strerror(errno)));
}

}  // namespace zoe
