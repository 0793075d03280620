#include "apps/common/parse.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "apps/common/usage_error.h"

namespace zoe {

std::optional<int> parse_count(std::string_view text, int max) {
    int value = 0;
    const char* const end = text.data() + text.size();
    if (text.empty() || text[0] < '0' || text[0] > '9') return std::nullopt;  // from_chars takes a sign
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || rest != end || value > max) return std::nullopt;
    return value;
}

std::optional<double> parse_number(std::string_view text) {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text, size_t count) {
    std::vector<double> numbers;
    std::string_view rest = text;
    for (size_t i = 0; i < count; ++i) {
        const size_t comma = i + 1 < count ? rest.find(',') : rest.size();
        if (comma == std::string_view::npos) return std::nullopt;
        const std::optional<double> number = parse_number(rest.substr(0, comma));
        if (!number) return std::nullopt;
        numbers.push_back(*number);
        if (i + 1 < count) rest.remove_prefix(comma + 1);
    }
    return numbers;
}

FrameRange parse_frames(std::string_view text) {
    constexpr int kMaxFrame = 999'999'999;
    const size_t dash = text.find('-');
    const std::optional<int> first = parse_count(text.substr(0, dash), kMaxFrame);
    const std::optional<int> last = dash == std::string_view::npos ? first : parse_count(text.substr(dash + 1), kMaxFrame);
    if (!first || !last) throw UsageError(fmt::format("--frames {}: give A-B or one number, such as 0-23", text));
    if (*last < *first) throw UsageError(fmt::format("--frames {}: the last frame comes before the first", text));
    if (*last - *first >= kMaxFrameCount)
        throw UsageError(fmt::format("--frames {}: too many; at most {} at once", text, kMaxFrameCount));
    return {*first, *last};
}

Shard parse_shard(std::string_view text) {
    const size_t slash = text.find('/');
    const std::optional<int> index = parse_count(text.substr(0, slash), kMaxFrameCount);
    const std::optional<int> count =
        slash == std::string_view::npos ? std::nullopt : parse_count(text.substr(slash + 1), kMaxFrameCount);
    if (!index || !count || *index < 1 || *index > *count)
        throw UsageError(fmt::format("--shard {}: give K/N, K from 1 to N, such as 3/8", text));
    return {*index, *count};
}

PictureSize parse_size(std::string_view text) {
    const size_t cross = text.find('x');
    const std::optional<int> width = parse_count(text.substr(0, cross), 1'000'000'000);
    const std::optional<int> height =
        cross == std::string_view::npos ? std::nullopt : parse_count(text.substr(cross + 1), 1'000'000'000);
    if (!width || !height) throw UsageError(fmt::format("--size {}: give WIDTHxHEIGHT in pixels, such as 640x360", text));
    if (*width == 0 || *height == 0)
        throw UsageError(fmt::format("--size {}: a picture has at least one pixel each way", text));
    if (*width > kMaxSide || *height > kMaxSide || int64_t{*width} * *height > kMaxPixels) {
        throw UsageError(fmt::format("--size {}: too large; at most {} pixels a side and {} in all, for memory's sake", text,
                                     kMaxSide, kMaxPixels));
    }
    return {*width, *height};
}

glm::dvec3 parse_point(std::string_view text, const std::string& option) {
    const std::optional<std::vector<double>> numbers = parse_numbers(text, 3);
    if (!numbers) throw UsageError(fmt::format("{} {}: give X,Y,Z in metres, such as 0,1.5,4", option, text));
    const glm::dvec3 point((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(point[axis]) > kMaxPlace)
            throw UsageError(fmt::format("{} {}: too far; at most {:g} metres along each axis", option, text, kMaxPlace));
    }
    return point;
}

}  // namespace zoe
