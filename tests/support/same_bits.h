#pragma once

#include <algorithm>
#include <span>
#include <type_traits>

namespace zoe::test {

/// Compares two arrays byte by byte: NaNs of the same bits are the same, zeros of different signs are not; empty arrays are
/// the same.
template <typename Array>
bool has_same_bits(const Array& a, const Array& b) {
    const std::span x(a), y(b);
    static_assert(std::is_trivially_copyable_v<typename decltype(x)::element_type>);
    return std::ranges::equal(std::as_bytes(x), std::as_bytes(y));
}

}  // namespace zoe::test
