#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/support/temp_folder.h"

namespace zoe::test {

/// What a program left behind.
struct Outcome {
    int exit_code = -1;  ///< 128 + the signal that ended it.
    std::string out, err;
};

/// A program that was started without a shell, and runs beside the test. What it caches is gone after it.
class RunningProgram {
public:
    /// arguments    The program, looked up in PATH, and what follows it.
    /// folder       It starts there.
    /// environment  "NAME=value" to set beside what is there; "NAME" to leave out.
    RunningProgram(const std::vector<std::string>& arguments, const std::string& folder,
                   const std::vector<std::string>& environment = {});
    /// Ends it where it still runs.
    ~RunningProgram();
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;

    void send(int signal) const;
    /// Whether it has asked to handle a signal by itself.
    bool catches(int signal) const;
    /// What it has printed so far.
    std::string out() const;
    std::string err() const;
    /// Waits for its end.
    Outcome wait();

private:
    const TempFolder temp_;
    int pid_ = -1;
};

/// Looks again and again until it holds, for a minute at most.
/// Returns    whether it does.
bool wait_until(const std::function<bool()>& holds);

/// Runs a program as RunningProgram does, and waits for its end.
Outcome run_program(const std::vector<std::string>& arguments, const std::string& folder,
                    const std::vector<std::string>& environment = {});

/// The program and what follows it, of zoetrope-demo.
std::vector<std::string> demo_command(const std::vector<std::string>& arguments);
/// What the environment must not have, so that no window opens.
inline const std::vector<std::string> kNoDisplay = {"DISPLAY", "WAYLAND_DISPLAY"};

/// Runs zoetrope-demo in a folder, without a display.
Outcome run_demo(const std::string& folder, const std::vector<std::string>& arguments);

/// Every file and folder below a folder, sorted, relative to it.
std::vector<std::string> list_files(const std::string& folder);

/// Whole lines of a text.
std::vector<std::string> lines(const std::string& text);

}  // namespace zoe::test
