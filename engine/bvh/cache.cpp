#include "engine/bvh/cache.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/bvh/tree_file.h"

namespace zoe {

namespace {

namespace fs = std::filesystem;

// A file is written as KEY.blas.XXXXXX.tmp, then becomes KEY.blas.
constexpr size_t kKeyDigits = 32, kRandomLetters = 6;
constexpr std::string_view kExtension = ".blas", kTemporaryExtension = ".tmp";
// A temporary file that nobody has written to for so long was left by a program that was stopped.
constexpr std::chrono::hours kStale{1};

std::string reason(int error) {
    return std::generic_category().message(error);
}

bool begins_with_key(std::string_view name) {
    return name.size() >= kKeyDigits + kExtension.size() &&
           name.substr(0, kKeyDigits).find_first_not_of("0123456789abcdef") == std::string_view::npos &&
           name.substr(kKeyDigits, kExtension.size()) == kExtension;
}

bool is_tree(std::string_view name) {
    return begins_with_key(name) && name.size() == kKeyDigits + kExtension.size();
}

bool is_temporary(std::string_view name) {
    constexpr size_t kSize = kKeyDigits + kExtension.size() + 1 + kRandomLetters + kTemporaryExtension.size();
    return begins_with_key(name) && name.size() == kSize && name[kKeyDigits + kExtension.size()] == '.' &&
           name.ends_with(kTemporaryExtension);
}

class Descriptor {
public:
    explicit Descriptor(int file) : file_(file) {}
    ~Descriptor() {
        if (file_ >= 0) ::close(file_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    operator int() const { return file_; }
    int close() { return ::close(std::exchange(file_, -1)); }

private:
    int file_;
};

struct Entry {
    fs::path path;
    uint64_t byte_count;
    fs::file_time_type used;
};

// The cache's own files, those first that were not used for the longest; others' are passed over. Files may come and go
// meanwhile.
std::vector<Entry> list(const fs::path& folder, std::error_code* error) {
    std::vector<Entry> entries;
    const fs::file_time_type now = fs::file_time_type::clock::now();
    for (fs::directory_iterator it(folder, *error), end; !*error && it != end; it.increment(*error)) {
        const std::string name = it->path().filename();
        if (!is_tree(name) && !is_temporary(name)) continue;
        struct stat status;
        if (lstat(it->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
        std::error_code gone;
        Entry entry{it->path(), static_cast<uint64_t>(status.st_size), it->last_write_time(gone)};
        if (gone) continue;
        // Another process is writing it: its size counts, and it is the last to go.
        if (is_temporary(name) && now - entry.used < kStale) entry.used = fs::file_time_type::max();
        entries.push_back(std::move(entry));
    }
    std::sort(entries.begin(), entries.end(),
              [](const Entry& a, const Entry& b) { return a.used != b.used ? a.used < b.used : a.path < b.path; });
    return entries;
}

}  // namespace

TreeCache::TreeCache(fs::path folder, uint64_t max_bytes) : folder_(std::move(folder)), max_bytes_(max_bytes) {}

bool TreeCache::load(const Hash128& key, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
                     Blas* blas) {
    const fs::path path = folder_ / (to_hex(key) += kExtension);
    // No links out of the folder, and no waiting for a pipe's other end.
    const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
    if (file < 0) {
        if (errno != ENOENT) warn("a file cannot be opened, and its tree is built: " + reason(errno));
        return false;
    }
    if (const std::string problem = read_tree(file, key, positions, corners, blas); !problem.empty()) {
        warn("a file " + problem + ": it is ignored, and its tree is built");
        return false;
    }
    // Used now. Where that may not be written, as in a folder that is read only, nothing is deleted by it either.
    futimens(file, nullptr);
    return true;
}

bool TreeCache::store(const Hash128& key, const Blas& blas) {
    if (!can_store_) return false;
    const std::lock_guard lock(store_mutex_);
    if (!can_store_) return false;
    const uint64_t byte_count = tree_file_size(blas);
    if (byte_count > max_bytes_) {
        warn("a tree is larger than all trees together may be, " + std::to_string(max_bytes_) + " bytes: it is not kept");
        return false;
    }
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) return stop_storing(error.message());
    if (byte_count > allowance_ && !make_room(byte_count)) return false;
    if (const std::string problem = write(key, blas); !problem.empty()) return stop_storing(problem);
    allowance_ -= byte_count;
    return true;
}

bool TreeCache::make_room(uint64_t byte_count) {
    std::error_code error;
    const std::vector<Entry> entries = list(folder_, &error);
    if (error) return stop_storing(error.message());
    uint64_t total = 0;
    for (const Entry& entry : entries) total += entry.byte_count;
    // Some room at once, so that a full folder is not looked through for every tree.
    const uint64_t wanted = std::max(byte_count, max_bytes_ / 16);
    if (total + byte_count > max_bytes_) {
        for (const Entry& entry : entries) {
            if (total + wanted <= max_bytes_ || entry.used == fs::file_time_type::max()) break;
            fs::remove(entry.path, error);  // No error where another process was faster.
            if (error) return stop_storing("a file cannot be deleted: " + error.message());
            total -= entry.byte_count;
        }
        if (total + byte_count > max_bytes_) return stop_storing("other programs' unfinished files fill it");
    }
    allowance_ = std::min(max_bytes_ - total, wanted);
    return true;
}

// Writes under another name first: a reader sees the whole file or none.
std::string TreeCache::write(const Hash128& key, const Blas& blas) const {
    const fs::path path = folder_ / (to_hex(key) += kExtension);
    std::string temporary = path.native() + "." + std::string(kRandomLetters, 'X') + std::string(kTemporaryExtension);
    Descriptor file(mkostemps(temporary.data(), static_cast<int>(kTemporaryExtension.size()), O_CLOEXEC));
    if (file < 0) return reason(errno);
    std::string problem = write_tree(file, key, blas);
    if (file.close() != 0 && problem.empty()) problem = reason(errno);
    if (problem.empty() && std::rename(temporary.c_str(), path.c_str()) != 0) problem = reason(errno);
    if (!problem.empty()) unlink(temporary.c_str());
    return problem;
}

bool TreeCache::stop_storing(const std::string& reason) {
    can_store_ = false;
    warn("no more trees are kept: " + reason);
    return false;
}

void TreeCache::warn(const std::string& text) {
    const std::lock_guard lock(warnings_mutex_);
    ++warnings_["tree cache " + folder_.native() + ": " + text];
}

std::map<std::string, uint64_t> TreeCache::take_warnings() {
    const std::lock_guard lock(warnings_mutex_);
    return std::exchange(warnings_, {});
}

bool is_worth_keeping(double build_ms, const Blas& blas) {
    // Measured: 100,000 bytes a millisecond where memory is touched for the first time, to 900,000 where all is warm.
    constexpr double kOpenMs = 0.1, kBytesAMs = 200'000.0;
    return build_ms > kOpenMs + static_cast<double>(tree_file_size(blas)) / kBytesAMs;
}

fs::path default_cache_folder() {
    const auto folder = [](const char* variable) {
        const char* const value = std::getenv(variable);
        const fs::path path = value ? value : "";
        return path.is_absolute() ? path : fs::path();
    };
    if (const fs::path cache = folder("XDG_CACHE_HOME"); !cache.empty()) return cache / "zoetrope";
    if (const fs::path home = folder("HOME"); !home.empty()) return home / ".cache" / "zoetrope";
    return {};
}

}  // namespace zoe
