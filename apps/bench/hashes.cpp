#include "apps/bench/hashes.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/bench/bench_scenes.h"
#include "apps/common/usage_error.h"
#include "apps/common/write_file.h"

namespace zoe {
namespace {

std::optional<uint64_t> parse_hash(const std::string& text) {
    uint64_t hash = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, hash, 16);
    if (text.size() != 16 || error != std::errc() || stop != end) return std::nullopt;
    return hash;
}

SceneHashes parse_line(const std::string& line) {
    SceneHashes parsed;
    std::istringstream words(line);
    std::string size;
    words >> parsed.simd >> parsed.scene >> size;
    parsed.size = parse_size(size);
    find_bench_scene(parsed.scene);
    for (std::string word; words >> word;) {
        const std::optional<uint64_t> hash = parse_hash(word);
        if (!hash) throw UsageError(fmt::format("'{}' is not 16 hex digits", word));
        parsed.hashes.push_back(*hash);
    }
    if (parsed.hashes.empty()) throw UsageError("no hashes");
    return parsed;
}

bool is_same_scene(const SceneHashes& a, const SceneHashes& b) {
    return a.scene == b.scene && a.size.width == b.size.width && a.size.height == b.size.height;
}

}  // namespace

std::vector<SceneHashes> read_hashes(const std::filesystem::path& file) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file.native()));
    std::vector<SceneHashes> lines;
    int number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        if (line.empty() || line[0] == '#') continue;
        try {
            lines.push_back(parse_line(line));
        } catch (const UsageError& error) {
            throw std::runtime_error(fmt::format("{}: line {}: {}", file.native(), number, error.what()));
        }
    }
    if (in.bad()) throw std::runtime_error(fmt::format("{}: cannot be read to its end", file.native()));
    return lines;
}

SceneHashes hashes_of(const RunStats& run, PictureSize size) {
    SceneHashes line{.simd = simd_target(), .scene = run.scene, .size = size, .hashes = {}};
    for (const FrameRecord& frame : run.frames) line.hashes.push_back(frame.stats.hits_hash);
    return line;
}

std::vector<SceneHashes> lines_for_this_target(std::vector<SceneHashes> lines) {
    const auto has_own = [&](const SceneHashes& line) {
        return std::ranges::any_of(
            lines, [&](const SceneHashes& other) { return other.simd == simd_target() && is_same_scene(other, line); });
    };
    std::vector<SceneHashes> chosen;
    for (const SceneHashes& line : lines) {
        if (line.simd == simd_target() || (line.simd == "*" && !has_own(line))) chosen.push_back(line);
    }
    return chosen;
}

void write_hashes(const std::filesystem::path& file, const std::vector<SceneHashes>& lines) {
    std::vector<SceneHashes> all;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored)) all = read_hashes(file);  // a pipe is only written to
    std::erase_if(all, [](const SceneHashes& old) { return old.simd == simd_target(); });
    all.insert(all.end(), lines.begin(), lines.end());
    std::string text =
        "# SIMD SCENE WIDTHxHEIGHT HASH ...: the hits of the first frames, for zoetrope-bench --expect-hashes\n";
    for (const SceneHashes& line : all) {
        text += fmt::format("{} {} {}x{}", line.simd, line.scene, line.size.width, line.size.height);
        for (const uint64_t hash : line.hashes) text += fmt::format(" {:016x}", hash);
        text += "\n";
    }
    write_file(file, text);
}

std::string describe_difference(const SceneHashes& expected, const SceneHashes& found) {
    std::string text;
    for (size_t k = 0; k < expected.hashes.size(); ++k) {
        if (k < found.hashes.size() && expected.hashes[k] == found.hashes[k]) continue;
        text += fmt::format("{}, frame {}: hits are not what the file expects: {:016x}, expected {:016x}\n", expected.scene,
                            k + 1, k < found.hashes.size() ? found.hashes[k] : 0, expected.hashes[k]);
    }
    return text;
}

}  // namespace zoe
