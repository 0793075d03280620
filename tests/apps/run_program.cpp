#include "tests/apps/run_program.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>

extern char** environ;

namespace zoe::test {
namespace {

std::string read_text(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

std::vector<char*> pointers(const std::vector<std::string>& texts) {
    std::vector<char*> result;
    for (const std::string& text : texts) result.push_back(const_cast<char*>(text.c_str()));
    result.push_back(nullptr);
    return result;
}

std::vector<std::string> changed_environment(const std::vector<std::string>& changes) {
    std::vector<std::string> result;
    const auto variable = [](std::string_view text) { return text.substr(0, text.find('=')); };
    for (char** entry = environ; *entry; ++entry) {
        const bool is_changed = std::any_of(changes.begin(), changes.end(),
                                            [&](const std::string& change) { return variable(change) == variable(*entry); });
        if (!is_changed) result.push_back(*entry);
    }
    for (const std::string& change : changes) {
        if (change.find('=') != std::string::npos) result.push_back(change);
    }
    return result;
}

}  // namespace

RunningProgram::RunningProgram(const std::vector<std::string>& arguments, const std::string& folder,
                               const std::vector<std::string>& environment) {
    const std::string out = temp_ / "out", err = temp_ / "err";
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    // Trees that programs keep end with the run: neither the user's are read, nor those of tests that ran before.
    std::vector<std::string> changes = environment;
    const bool is_told = std::any_of(environment.begin(), environment.end(),
                                     [](const std::string& change) { return change.starts_with("XDG_CACHE_HOME"); });
    if (!is_told) changes.push_back("XDG_CACHE_HOME=" + (temp_ / "cache").native());
    const std::vector<std::string> variables = changed_environment(changes);
    const int error =
        posix_spawnp(&pid_, arguments[0].c_str(), &actions, nullptr, pointers(arguments).data(), pointers(variables).data());
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::runtime_error("cannot start " + arguments[0]);
}

RunningProgram::~RunningProgram() {
    if (pid_ < 0) return;
    send(SIGKILL);
    wait();
}

void RunningProgram::send(int signal) const {
    kill(pid_, signal);
}

bool RunningProgram::catches(int signal) const {
    const std::string status = read_text("/proc/" + std::to_string(pid_) + "/status");
    const size_t at = status.find("SigCgt:");
    if (at == std::string::npos) return false;
    return (std::stoull(status.substr(at + 7), nullptr, 16) >> (signal - 1) & 1) != 0;
}

std::string RunningProgram::out() const {
    return read_text(temp_ / "out");
}

std::string RunningProgram::err() const {
    return read_text(temp_ / "err");
}

Outcome RunningProgram::wait() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return {WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), out(), err()};
}

bool wait_until(const std::function<bool()>& holds) {
    const auto begin = std::chrono::steady_clock::now();
    while (!holds()) {
        if (std::chrono::steady_clock::now() - begin > std::chrono::seconds(60)) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
}

Outcome run_program(const std::vector<std::string>& arguments, const std::string& folder,
                    const std::vector<std::string>& environment) {
    return RunningProgram(arguments, folder, environment).wait();
}

std::vector<std::string> demo_command(const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {ZOETROPE_DEMO};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return all;
}

Outcome run_demo(const std::string& folder, const std::vector<std::string>& arguments) {
    return run_program(demo_command(arguments), folder, kNoDisplay);
}

std::vector<std::string> list_files(const std::string& folder) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        files.push_back(entry.path().lexically_relative(folder));
    }
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<std::string> lines(const std::string& text) {
    std::vector<std::string> result;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) result.push_back(line);
    return result;
}

}  // namespace zoe::test
