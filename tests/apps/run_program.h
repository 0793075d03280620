#pragma once

#include <string>
#include <vector>

namespace zoe::test {

/// What a program left behind.
struct Outcome {
    int exit_code = -1;  ///< 128 + the signal that ended it.
    std::string out, err;
};

/// Runs a program without a shell and waits for its end. What it caches is gone after it.
/// arguments    The program, looked up in PATH, and what follows it.
/// folder       It starts there.
/// environment  "NAME=value" to set beside what is there; "NAME" to leave out.
Outcome run_program(const std::vector<std::string>& arguments, const std::string& folder,
                    const std::vector<std::string>& environment = {});

/// Runs zoetrope-demo in a folder, without a display.
Outcome run_demo(const std::string& folder, const std::vector<std::string>& arguments);

/// Every file and folder below a folder, sorted, relative to it.
std::vector<std::string> list_files(const std::string& folder);

/// Whole lines of a text.
std::vector<std::string> lines(const std::string& text);

}  // namespace zoe::test
