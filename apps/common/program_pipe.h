#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

namespace zoe {

/// A program that is started without a shell, reads what is written to it, and prints nowhere.
class ProgramPipe {
public:
    /// arguments  The program's name, looked up in PATH, and what follows it.
    explicit ProgramPipe(const std::vector<std::string>& arguments);
    ~ProgramPipe();  ///< Waits for its end.
    ProgramPipe(const ProgramPipe&) = delete;
    ProgramPipe& operator=(const ProgramPipe&) = delete;

    bool is_running() const { return pid_ > 0; }
    int start_error() const { return start_error_; }  ///< errno of the start; ENOENT: not installed.

    /// Returns    false where the program no longer reads.
    bool write(std::span<const uint8_t> bytes);

    /// Ends its input and waits for its end.
    /// Returns    "" for success, else what happened, such as "ended with code 1".
    std::string close();

private:
    pid_t pid_ = -1;
    int input_ = -1;
    int start_error_ = 0;
};

}  // namespace zoe
