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

struct Target {
    std::filesystem::path file;
    bool is_replaced = true;  ///< Else it is a device, a pipe or the like: written into, as it stands.
};

/// Where the bytes go: what a symbolic link leads to, whether that exists or not.
Target find_target(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (!std::filesystem::status_known(status)) fail(file, fmt::format("cannot be written: {}", error.message()));
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) return {file, false};
    std::filesystem::path target = file;
    while (std::filesystem::is_symlink(std::filesystem::symlink_status(target, error))) {  // no cycle: `status` is known
        const std::filesystem::path link = std::filesystem::read_symlink(target, error);
        if (error) fail(file, fmt::format("cannot be written: {}", error.message()));
        target = target.parent_path() / link;
    }
    // A link of /proc may lead to an open file that has no name any more.
    if (std::filesystem::exists(status) && !std::filesystem::equivalent(file, target, error)) return {file, false};
    return {target, true};
}

}  // namespace

std::filesystem::path temporary_name(const std::filesystem::path& file) {
    return file.parent_path() / fmt::format(".{}.{}{}", file.stem().native(), getpid(), file.extension().native());
}

void write_file(const std::filesystem::path& file, std::string_view text) {
    const Target target = find_target(file);
    const std::filesystem::path written = target.is_replaced ? temporary_name(target.file) : target.file;
    std::FILE* const stream = std::fopen(written.c_str(), "wb");
    if (!stream) fail(file, fmt::format("cannot be written: {}", std::strerror(errno)));
    int error = 0;
    if (std::fwrite(text.data(), 1, text.size(), stream) != text.size()) error = errno;
    if (std::fclose(stream) != 0 && error == 0) error = errno;
    if (error == 0 && target.is_replaced && std::rename(written.c_str(), target.file.c_str()) != 0) error = errno;
    if (error != 0) {
        if (target.is_replaced) std::remove(written.c_str());
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
    std::error_code error;
    const Target target = find_target(file);
    if (std::filesystem::is_directory(target.file, error)) fail(file, "cannot be written: it is a folder");
    const std::filesystem::path folder = target.file.has_parent_path() ? target.file.parent_path() : ".";
    if (!std::filesystem::is_directory(folder, error)) fail(file, "cannot be written: there is no such folder");
    if (!target.is_replaced) {
        if (access(target.file.c_str(), W_OK) != 0) fail(file, fmt::format("cannot be written: {}", std::strerror(errno)));
        return;
    }
    // Rights alone do not tell: some folders take no files even from root.
    const std::filesystem::path tried = temporary_name(target.file);
    std::FILE* const stream = std::fopen(tried.c_str(), "wb");
    if (!stream) fail(file, fmt::format("cannot be written: {}", std::strerror(errno)));
    std::fclose(stream);
    std::remove(tried.c_str());
}

}  // namespace zoe
