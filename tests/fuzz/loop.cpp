#include "tests/fuzz/loop.h"

#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include "tests/fuzz/files.h"
#include "tests/fuzz/mutate.h"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/common_interface_defs.h>
#endif

namespace zoe::test {
namespace {

constexpr time_t kMostSeconds = 30;  // Of processor time: whoever waits for a busy or paused machine does not hang.
// A scene of a few kilobytes takes up to 2^22 numbers, some of them several times; a sanitizer keeps what was freed.
#if defined(__SANITIZE_ADDRESS__)
constexpr long kMostKilobytes = 3 << 19;
#else
constexpr long kMostKilobytes = 1 << 19;
#endif

// What a handler writes: only what it may, ready beforehand.
const std::string* running_input = nullptr;
char running_file[4096];

void keep_input() {
    if (running_input == nullptr) return;
    const int file = open(running_file, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    bool is_kept = file >= 0;
    if (is_kept) is_kept = write(file, running_input->data(), running_input->size()) >= 0;
    if (file >= 0) close(file);
    const char* const text = is_kept ? "\nthe input is kept as " : "\nthe input cannot be kept as ";
    is_kept = write(STDERR_FILENO, text, std::strlen(text)) >= 0 &&
              write(STDERR_FILENO, running_file, std::strlen(running_file)) >= 0 && write(STDERR_FILENO, "\n", 1) >= 0;
    running_input = nullptr;
}

void keep_and_die(int signal) {
    keep_input();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

/// Keeps the input of a round that ends the program, and limits its time.
class Watch {
public:
    Watch() {
        for (const int signal : {SIGPROF, SIGABRT}) std::signal(signal, keep_and_die);
#if defined(__SANITIZE_ADDRESS__)
        __sanitizer_set_death_callback(keep_input);
#else
        for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) std::signal(signal, keep_and_die);
#endif
    }
    ~Watch() {
        limit_time(0);
        running_input = nullptr;
        for (const int signal : {SIGPROF, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) std::signal(signal, SIG_DFL);
    }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    void begin(const std::string& input, const std::string& file) {
        std::snprintf(running_file, sizeof running_file, "%s", file.c_str());
        running_input = &input;
        limit_time(kMostSeconds);
    }
    static void keep() {
        keep_input();
    }

private:
    /// 0: no limit any more.
    static void limit_time(time_t seconds) {
        const itimerval once{.it_interval = {}, .it_value = {.tv_sec = seconds, .tv_usec = 0}};
        setitimer(ITIMER_PROF, &once, nullptr);
    }
};

long peak_kilobytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

}  // namespace

std::string fuzz_input(const FuzzTarget& target, uint64_t round) {
    Rng rng(mix_bits(round + 1));
    std::string input = pick(target.seeds, rng);
    target.mutate(input, target.seeds, rng);
    return input;
}

FuzzCounts run_rounds(const FuzzTarget& target, uint64_t begin, uint64_t end) {
    FuzzCounts counts;
    Watch watch;
    const std::string folder = (std::filesystem::temp_directory_path() / "").string();
    for (uint64_t round = begin; round < end; ++round) {
        const std::string input = fuzz_input(target, round);
        watch.begin(input, fmt::format("{}fuzz-{}-{}", folder, target.name, round));
        FuzzOutcome outcome = target.entry(as_bytes(input));
        ++counts.executed;
        counts.accepted += outcome.is_accepted;
        if (const long now = peak_kilobytes(); now > kMostKilobytes && outcome.broken.empty()) {
            outcome.broken = fmt::format("{} kB of memory for {} bytes", now, input.size());
        }
        if (outcome.broken.empty()) continue;
        Watch::keep();
        counts.failure = fmt::format("{}, round {}: {}", target.name, round, outcome.broken);
        break;
    }
    return counts;
}

}  // namespace zoe::test
