#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

namespace zoe {

/// Frames first, first + 1, ... last.
struct FrameRange {
    int first = 0, last = 0;
    int count() const { return last - first + 1; }
};

/// Every `count`-th frame of a range, from the `index`-th on, which is 1 to count.
struct Shard {
    int index = 1, count = 1;
    bool has(const FrameRange& range, int frame) const { return (frame - range.first) % count == index - 1; }
};

struct PictureSize {
    int width = 0, height = 0;
};

/// More pixels than this are refused: a picture being made takes about 100 bytes a pixel.
inline constexpr int kMaxPixels = 1 << 25;
inline constexpr int kMaxSide = 16384;

/// A whole number of digits only, at most `max`.
std::optional<int> parse_count(std::string_view text, int max);
/// A decimal number, finite, and nothing after it.
std::optional<double> parse_number(std::string_view text);
/// So many of them with commas between: "1,2.5,-3".
std::optional<std::vector<double>> parse_numbers(std::string_view text, size_t count);

/// More frames than this at once are refused: each has a picture's name in memory, and a file in one folder.
inline constexpr int kMaxFrameCount = 1'000'000;

/// "3-7" or "3".
/// Throws     UsageError that says what is wrong; so do the others below.
FrameRange parse_frames(std::string_view text);
/// "3/8".
Shard parse_shard(std::string_view text);
/// "640x360".
PictureSize parse_size(std::string_view text);
/// A place farther than this along an axis is refused: squared distances would not fit a float.
inline constexpr double kMaxPlace = 1e18;

/// "1,2.5,-3". option  Its name, for the message.
glm::dvec3 parse_point(std::string_view text, const std::string& option);

}  // namespace zoe
