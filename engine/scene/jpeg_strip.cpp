#include "engine/scene/jpeg_strip.h"

#include <cstdint>

namespace zoe {

std::vector<std::byte> without_metadata(std::span<const std::byte> jpeg) {
    constexpr uint32_t kApp0 = 0xe0, kApp15 = 0xef, kAdobe = 0xee, kComment = 0xfe, kScan = 0xda;
    const auto byte = [&](size_t at) { return std::to_integer<uint32_t>(jpeg[at]); };
    std::vector<std::byte> kept(jpeg.begin(), jpeg.begin() + static_cast<ptrdiff_t>(jpeg.size() < 2 ? jpeg.size() : 2));
    size_t at = kept.size();
    // Segments: ff, a marker, a length that counts itself. Adobe's tells how colours are stored.
    while (at + 4 <= jpeg.size() && byte(at) == 0xff && byte(at + 1) != kScan) {
        if (byte(at + 1) == 0xff) {  // Padding.
            ++at;
            continue;
        }
        const uint32_t marker = byte(at + 1);
        const size_t size = 2 + (byte(at + 2) << 8 | byte(at + 3));
        if (size < 4 || size > jpeg.size() - at) break;
        const bool is_metadata = (marker > kApp0 && marker <= kApp15 && marker != kAdobe) || marker == kComment;
        if (!is_metadata) kept.insert(kept.end(), &jpeg[at], &jpeg[at] + size);
        at += size;
    }
    const bool is_scan = at + 1 < jpeg.size() && byte(at) == 0xff && byte(at + 1) == kScan;
    if (is_scan) kept.insert(kept.end(), jpeg.begin() + static_cast<ptrdiff_t>(at), jpeg.end());
    return kept;
}

}  // namespace zoe
