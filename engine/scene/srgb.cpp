#include "engine/scene/srgb.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace zoe {

namespace {

/// Light of the encoded values (i + offset) / 255.
template <size_t kCount>
std::array<float, kCount> make_table(float offset) {
    std::array<float, kCount> table{};
    for (size_t i = 0; i < kCount; ++i) table[i] = linear_from_srgb((static_cast<float>(i) + offset) / 255.0f);
    return table;
}

const std::array<float, 256> kLinearFromByte = make_table<256>(0.0f);
const std::array<float, 255> kStepAfterByte = make_table<255>(0.5f);

/// Light below is black. From there to 1, each power of two has 128 bins, by the first bits of the number: a bin's byte is
/// that of its beginning, and what lies in it has that one or the next.
constexpr float kLeast = 0x1p-13f;
constexpr uint32_t kBinShift = 16, kBinCount = 13 * 128;

uint32_t bin_of(float linear) {
    return (std::bit_cast<uint32_t>(linear) - std::bit_cast<uint32_t>(kLeast)) >> kBinShift;
}

std::array<uint8_t, kBinCount> make_bins() {
    std::array<uint8_t, kBinCount> bins{};
    for (uint32_t i = 0; i < kBinCount; ++i) {
        const float begin = std::bit_cast<float>(std::bit_cast<uint32_t>(kLeast) + (i << kBinShift));
        const auto above = std::upper_bound(kStepAfterByte.begin(), kStepAfterByte.end(), begin);
        bins[i] = static_cast<uint8_t>(above - kStepAfterByte.begin());
    }
    return bins;
}

const std::array<uint8_t, kBinCount> kByteFromBin = make_bins();

}  // namespace

float linear_from_srgb(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linear_from_srgb_byte(uint8_t encoded) {
    return kLinearFromByte[encoded];
}

uint8_t srgb_byte_from_linear(float linear) {
    if (!(linear >= kLeast)) return 0;
    if (linear >= 1.0f) return 255;
    uint32_t byte = kByteFromBin[bin_of(linear)];
    while (byte < 255 && linear >= kStepAfterByte[byte]) ++byte;
    return static_cast<uint8_t>(byte);
}

}  // namespace zoe
