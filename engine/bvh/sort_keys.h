#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace zoe {

/// Packs a number and an index so that unsigned comparison orders by the number, then by the index. -0 counts as +0.
/// x          not NaN.
inline uint64_t sort_key(float x, uint32_t index) {
    const auto bits = std::bit_cast<uint32_t>(x + 0.0f);
    const uint32_t ordered = bits & 0x80000000u ? ~bits : bits | 0x80000000u;
    return uint64_t(ordered) << 32 | index;
}
inline uint32_t index_of(uint64_t key) {
    return static_cast<uint32_t>(key);
}

/// Sorts keys ascending.
/// keys       with indices that ascend: ties need no work then.
/// scratch    is resized as needed and may be shared by later calls.
/// Cost       O(n): three passes by radix; small ones are sorted by comparison.
/// Source     Knuth. The Art of Computer Programming 3: Sorting and Searching, 5.2.5, Sorting by Distribution. 1998.
///            Deviation: digits of 11 bits, all counted in one pass.
void sort_keys(std::vector<uint64_t>* keys, std::vector<uint64_t>* scratch);

}  // namespace zoe
