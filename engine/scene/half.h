#pragma once

#include <bit>
#include <cstdint>

namespace zoe {

/// Floats of 16 bits that are not negative, as pictures of light have them: 5 bits of exponent, 10 of mantissa.
inline constexpr uint16_t kHalfOne = 0x3c00, kHalfLargest = 0x7bff, kHalfInfinity = 0x7c00;

/// Requires   a half in [0, 65504]. Exact.
inline float float_from_half(uint16_t half) {
    // Exponents of floats begin 112 lower. As a factor, that is right for subnormal numbers, too.
    return std::bit_cast<float>(uint32_t{half} << 13) * 0x1p112f;
}

/// The nearest half; of two the even one.
/// Requires   a number in [0, 65504].
inline uint16_t half_from_float(float number) {
    // Subnormal halves are as far apart as floats from 0.5 to 1.
    if (number < 0x1p-14f)
        return static_cast<uint16_t>(std::bit_cast<uint32_t>(number + 0.5f) - std::bit_cast<uint32_t>(0.5f));
    const uint32_t bits = std::bit_cast<uint32_t>(number) - (uint32_t{112} << 23);
    return static_cast<uint16_t>((bits + 0xfff + (bits >> 13 & 1)) >> 13);
}

}  // namespace zoe
