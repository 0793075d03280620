#include "engine/scene/srgb.h"

#include <algorithm>
#include <array>
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

}  // namespace

float linear_from_srgb(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linear_from_srgb_byte(uint8_t encoded) {
    return kLinearFromByte[encoded];
}

uint8_t srgb_byte_from_linear(float linear) {
    if (!(linear > 0.0f)) return 0;
    const auto above = std::upper_bound(kStepAfterByte.begin(), kStepAfterByte.end(), linear);
    return static_cast<uint8_t>(above - kStepAfterByte.begin());
}

}  // namespace zoe
