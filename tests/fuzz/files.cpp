#include "tests/fuzz/files.h"

#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

namespace zoe::test {

std::filesystem::path memory_folder() {
    const char* const shared_memory = "/dev/shm";
    return access(shared_memory, W_OK | X_OK) == 0 ? shared_memory : std::filesystem::temp_directory_path();
}

void overwrite(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    const bool is_written =
        descriptor >= 0 && write(descriptor, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size());
    if (descriptor >= 0) close(descriptor);
    if (!is_written) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace zoe::test
