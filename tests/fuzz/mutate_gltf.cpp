#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "tests/fuzz/mutate.h"

namespace zoe::test {
namespace {

constexpr uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;

const std::vector<std::string> kNumbers = {"0",
                                           "1",
                                           "2",
                                           "3",
                                           "4",
                                           "5",
                                           "6",
                                           "7",
                                           "8",
                                           "16",
                                           "-1",
                                           "12",
                                           "255",
                                           "256",
                                           "65535",
                                           "65536",
                                           "100000",
                                           "2147483647",
                                           "2147483648",
                                           "4294967295",
                                           "4294967296",
                                           "1099511627776",
                                           "-2147483648",
                                           "18446744073709551615",
                                           "18446744073709551616",
                                           "-9223372036854775808",
                                           "0.5",
                                           "-0.0",
                                           "1e-45",
                                           "1e-30",
                                           "1e18",
                                           "1e30",
                                           "3.4e38",
                                           "3.5e38",
                                           "1e308",
                                           "1e999",
                                           "5120",
                                           "5121",
                                           "5122",
                                           "5123",
                                           "5125",
                                           "5126",
                                           "1.5",
                                           "33071"};
const std::vector<std::string> kValues = {
    "null",        "true",         "false",         "[]",           "{}",
    "\"\"",        "-1",           "[0]",           "[[[[]]]]",     "{\"a\":{\"a\":0}}",
    "\"a\\nb\"",   "\"\\u0000\"",  "\"\\ud800\"",   "\"../a.bin\"", "\"a.bin\"",
    "\"a.png\"",   "\"%2e%2e/a\"", "\"/dev/zero\"", "\"data:,\"",   "\"data:x;base64,AAAA\"",
    "\"SCALAR\"",  "\"VEC3\"",     "\"VEC4\"",      "\"MAT4\"",     "\"CUBICSPLINE\"",
    "\"weights\"", "\"rotation\"", "\"arbitrary\""};

bool is_number_char(char c) {
    return std::isdigit(static_cast<unsigned char>(c)) || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E';
}

/// [begin, end) in a text.
struct Range {
    size_t begin = 0, end = 0;
};

/// The first number at or after a random place.
std::optional<Range> some_number(const std::string& json, Rng& rng) {
    const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) || c == '-'; };
    Range range;
    range.begin = static_cast<size_t>(
        std::find_if(json.begin() + static_cast<ptrdiff_t>(position_in(json, rng)), json.end(), is_digit) - json.begin());
    if (range.begin == json.size()) return std::nullopt;
    while (range.begin > 0 && is_number_char(json[range.begin - 1])) --range.begin;
    range.end = range.begin;
    while (range.end < json.size() && is_number_char(json[range.end])) ++range.end;
    return range;
}

/// The first string at or after a random place, quotes included.
std::optional<Range> some_string(const std::string& json, Rng& rng) {
    const size_t begin = json.find('"', position_in(json, rng));
    const size_t end = begin == std::string::npos ? begin : json.find('"', begin + 1);
    if (end == std::string::npos) return std::nullopt;
    return Range{begin, end + 1};
}

/// Where the value ends that begins at `at`: at the comma or bracket after it.
size_t end_of_value(const std::string& json, size_t at) {
    int depth = 0;
    bool in_string = false;
    for (; at < json.size(); ++at) {
        const char c = json[at];
        if (in_string) {
            if (c == '\\') ++at;
            in_string = c != '"';
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            ++depth;
        } else if ((c == ']' || c == '}') && --depth < 0) {
            break;
        } else if (c == ',' && depth == 0) {
            break;
        }
    }
    return std::min(at, json.size());
}

/// A value: what stands after a colon, comma or bracket. Of members after a comma: with their names.
std::optional<Range> some_value(const std::string& json, Rng& rng) {
    const size_t before = json.find_first_of(":,[", position_in(json, rng));
    if (before == std::string::npos) return std::nullopt;
    return Range{before + 1, end_of_value(json, before + 1)};
}

void replace(std::string& json, const std::optional<Range>& range, const std::string& with) {
    if (range) json.replace(range->begin, range->end - range->begin, with);
}

void change_json(std::string& json, std::span<const std::string> others, Rng& rng) {
    if (json.empty()) return;
    switch (rng.below(12)) {
        case 0:
        case 1:
        case 2:
            replace(json, some_number(json, rng), pick(kNumbers, rng));
            break;
        case 3:
        case 4: {
            const std::optional<Range> from = some_number(json, rng);
            if (from) replace(json, some_number(json, rng), json.substr(from->begin, from->end - from->begin));
            break;
        }
        case 5: {
            const std::optional<Range> from = some_string(json, rng);
            if (from) replace(json, some_string(json, rng), json.substr(from->begin, from->end - from->begin));
            break;
        }
        case 6:
        case 7:
            replace(json, some_value(json, rng), pick(kValues, rng));
            break;
        case 8: {  // Left out, with its comma.
            std::optional<Range> range = some_value(json, rng);
            if (range && range->end < json.size() && json[range->end] == ',') ++range->end;
            replace(json, range, "");
            break;
        }
        case 9: {  // Once more, and more often still.
            const std::optional<Range> range = some_value(json, rng);
            if (!range) break;
            const std::string again = "," + json.substr(range->begin, range->end - range->begin);
            if (again.size() > 2000) break;
            for (uint32_t left = 1 + (rng.below(8) == 0 ? rng.below(100) : 0); left > 0; --left)
                json.insert(range->end, again);
            break;
        }
        case 10: {
            const std::optional<Range> from = some_value(json, rng);
            if (from && from->end - from->begin < 2000)
                replace(json, some_value(json, rng), json.substr(from->begin, from->end - from->begin));
            break;
        }
        default:
            mutate_bytes(json, others, rng);
    }
}

uint32_t word_at(const std::string& file, size_t at) {
    uint32_t word = 0;
    if (at + sizeof word <= file.size()) std::memcpy(&word, &file[at], sizeof word);
    return word;
}

void put(std::string& file, size_t word) {
    for (int shift = 0; shift < 32; shift += 8) file.push_back(static_cast<char>(word >> shift & 0xff));
}

std::string join_glb(std::string json, const std::string& binary, Rng& rng) {
    const size_t lie = rng.below(16) == 0 ? rng.below(17) - size_t{8} : 0;
    const uint32_t lying = rng.below(3);
    if (rng.below(32) != 0) json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string file;
    put(file, kMagic);
    put(file, 2);
    put(file, 20 + json.size() + (binary.empty() ? 0 : 8 + binary.size()) + (lying == 0 ? lie : 0));
    put(file, json.size() + (lying == 1 ? lie : 0));
    put(file, kJsonChunk);
    file += json;
    if (binary.empty()) return file;
    put(file, binary.size() + (lying == 2 ? lie : 0));
    put(file, kBinChunk);
    return file + binary;
}

}  // namespace

void mutate_gltf(std::string& file, std::span<const std::string> others, Rng& rng) {
    if (rng.below(16) == 0) return mutate_bytes(file, others, rng);
    const bool is_glb = word_at(file, 0) == kMagic;
    std::string json = file, binary;
    if (is_glb) {
        const size_t json_end = std::min<size_t>(20 + size_t{word_at(file, 12)}, file.size());
        json = file.size() < 20 ? "" : file.substr(20, json_end - 20);
        binary = file.substr(std::min(json_end + 8, file.size()));
    }
    const uint32_t change_count = 1 + rng.below(rng.below(8) == 0 ? 8 : 1);
    for (uint32_t k = 0; k < change_count; ++k) {
        if (!binary.empty() && rng.below(4) == 0) {
            mutate_bytes(binary, others, rng);
        } else {
            change_json(json, others, rng);
        }
    }
    file = is_glb ? join_glb(std::move(json), binary, rng) : json;
}

void mutate_sequence(std::string& files, std::span<const std::string> others, Rng& rng) {
    if (files.size() < 6 || rng.below(8) == 0) return mutate_bytes(files, others, rng);
    // The first file; the others stay as they are.
    const size_t length = std::min<size_t>(word_at(files, 1), files.size() - 5);
    std::string first = files.substr(5, length);
    mutate_gltf(first, others, rng);
    std::string changed = files.substr(0, 1);
    put(changed, first.size());
    files = changed + first + files.substr(5 + length);
}

}  // namespace zoe::test
