#pragma once

#include <cstdint>

#include <glm/vec2.hpp>

#include "engine/math/rng.h"

namespace zoe {

/// Which sample of which pixel asks: random numbers depend on this and on their dimension, on nothing else.
struct SampleKey {
    uint32_t pixel = 0;   ///< y * width + x.
    uint32_t sample = 0;  ///< From 0, over all passes.
};

/// What a number is for. Each use of a bounce has a dimension of its own.
enum class Use : uint32_t { kPixel, kDirection, kLobe, kSun, kLight, kGlow, kGlowPlace, kSky, kRoulette, kAlpha };

/// pass       counts the see-through surfaces that the ray of this bounce has passed.
inline uint64_t dimension(Use use, uint32_t bounce, uint32_t pass = 0) {
    return static_cast<uint64_t>(pass) << 32 | bounce << 4 | static_cast<uint32_t>(use);
}

namespace detail {

inline uint32_t reverse_bits(uint32_t x) {
    x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    return __builtin_bswap32(x);
}

/// A random nested permutation: every operation lets a bit depend on itself and the bits below it only. On reversed bits
/// that is Owen's scrambling: a digit is flipped depending on the digits before it.
inline uint32_t scramble_from_low(uint32_t x, uint32_t seed) {
    x ^= x * 0x6b8d2f4cu;
    x += seed;
    x *= (seed >> 15) | 1u;
    x ^= x * 0x2f6e1d3au;
    x ^= x * 0x5c91a7b6u;
    x += seed * 0x9e3779b9u;
    x ^= x * 0x45d9f3b4u;
    return x;
}

/// Bits of an index times Pascal's triangle modulo 2: the second Sobol' dimension, reversed. Entry (i, j) of the triangle
/// is odd where the bits of i are among the bits of j, so the product is a sum over supersets, five steps for 32 bits.
inline uint32_t times_pascal(uint32_t x) {
    x ^= x >> 1 & 0x55555555u;
    x ^= x >> 2 & 0x33333333u;
    x ^= x >> 4 & 0x0f0f0f0fu;
    x ^= x >> 8 & 0x00ff00ffu;
    x ^= x >> 16 & 0x0000ffffu;
    return x;
}

/// [0, 1) from the upper 24 bits.
inline float to_unit(uint32_t bits) {
    return static_cast<float>(bits >> 8) * 0x1p-24f;
}

}  // namespace detail

/// The one of a pixel's samples [turn * count, (turn + 1) * count) that falls into a slice of the time that a shutter is
/// open. Runs of 2^k samples lie in slices that are count / 2^k apart, from a random one on: fewer samples than slices are
/// noise, and no ghosts, and `count` of them lie in every slice once.
/// slice      below `count`, a power of two.
inline uint32_t sample_in_slice(uint32_t pixel, uint32_t turn, uint32_t slice, uint32_t count) {
    if (count == 1) return turn;
    const uint64_t seed = mix_bits(static_cast<uint64_t>(turn) << 32 | pixel) + 0x9e3779b97f4a7c15ull;
    const uint32_t shifted = (slice ^ static_cast<uint32_t>(mix_bits(seed))) & (count - 1);
    return turn * count + (detail::reverse_bits(shifted) >> __builtin_clz(count) >> 1);
}

/// Two uniform numbers in [0, 1). Over the samples of a pixel each dimension is a (0,2)-sequence of its own: any aligned run
/// of 2^k samples has one point in each of the 2^k boxes of every shape 2^-i x 2^-(k-i).
/// Source     Burley. Practical Hash-based Owen Scrambling. JCGT 2020 (shuffled, scrambled and padded (0,2) pairs).
///            Deviation: own mixing constants; the second dimension by a superset sum instead of direction numbers.
inline glm::vec2 uniform_2d(const SampleKey& key, uint64_t dimension) {
    const uint64_t seed = mix_bits(mix_bits(static_cast<uint64_t>(key.pixel) + 0x9e3779b97f4a7c15ull) ^ dimension);
    const uint64_t more = mix_bits(seed + 0x9e3779b97f4a7c15ull);
    const uint32_t reversed = detail::scramble_from_low(detail::reverse_bits(key.sample), static_cast<uint32_t>(seed >> 32));
    const uint32_t index = detail::reverse_bits(reversed);
    const uint32_t x = detail::scramble_from_low(index, static_cast<uint32_t>(more));
    const uint32_t y = detail::scramble_from_low(detail::times_pascal(index), static_cast<uint32_t>(more >> 32));
    return {detail::to_unit(detail::reverse_bits(x)), detail::to_unit(detail::reverse_bits(y))};
}

/// One uniform number in [0, 1), stratified over the samples of a pixel.
inline float uniform_1d(const SampleKey& key, uint64_t dimension) {
    return uniform_2d(key, dimension).x;
}

}  // namespace zoe
