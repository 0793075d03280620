#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "engine/math/aabb.h"

namespace zoe::binning {

// Four floats in a register, on any processor: g++ and clang make them SSE or NEON.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

inline constexpr int kMaxBins = 64;

inline Float4 splat(float x) {
    return Float4{x, x, x, x};
}
// A NaN in `a` gives `b`, as everything here counts on.
inline Float4 min(Float4 a, Float4 b) {
    return a < b ? a : b;
}
inline Float4 max(Float4 a, Float4 b) {
    return a > b ? a : b;
}

/// A box and whose it is, moved about as the tree is built, so that memory is read in order. The fourth lanes hold the
/// index in two parts, as numbers: bit patterns would be denormal, and slow.
struct Item {
    Float4 lo, hi;

    Item() = default;
    /// A box that is not finite counts as empty: it changes no bounds, and its centre is NaN.
    Item(const Aabb& box, uint32_t index);
    uint32_t index() const { return static_cast<uint32_t>(lo[3]) | static_cast<uint32_t>(hi[3]) << 24; }
    Float4 centre() const { return 0.5f * lo + 0.5f * hi; }
};

/// Bounds of boxes and of their centres; the fourth lanes mean nothing.
struct Extents {
    Float4 lo = splat(std::numeric_limits<float>::infinity()), hi = -lo;
    Float4 centre_lo = lo, centre_hi = hi;

    void extend(const Item& item) {
        const Float4 centre = item.centre();
        lo = min(item.lo, lo);
        hi = max(item.hi, hi);
        centre_lo = min(centre, centre_lo);
        centre_hi = max(centre, centre_hi);
    }
    void extend(const Extents& other) {
        lo = min(other.lo, lo);
        hi = max(other.hi, hi);
        centre_lo = min(other.centre_lo, centre_lo);
        centre_hi = max(other.centre_hi, centre_hi);
    }
};

/// Maps centres to bins of equal width, along all axes at once.
struct BinMap {
    Float4 origin, scale, last;
    int bin_count;

    BinMap(const Extents& extents, int bin_count);
    /// True where centres differ along an axis: elsewhere all are in bin 0.
    bool is_usable() const { return scale[0] > 0.0f || scale[1] > 0.0f || scale[2] > 0.0f; }
    /// A centre that is NaN goes to the last bin.
    Int4 operator()(const Item& item) const {
        const Float4 bin = min((item.centre() - origin) * scale, last);
        return __builtin_convertvector(max(bin, splat(0.0f)), Int4);
    }
};

/// Boxes and counts, a bin an axis.
struct Bins {
    struct Bin {
        Float4 lo[3], hi[3];
        Int4 count;
    };
    std::array<Bin, kMaxBins> bins;

    void clear(int bin_count);
    void add(std::span<const Item> items, const BinMap& map);
    void add(const Bins& other, int bin_count);
};

struct Split {
    int axis = -1;  ///< -1: nothing is to be split, all centres are in one bin.
    int bin = 0;    ///< First bin of the right side.
    float cost = std::numeric_limits<float>::infinity();
};

/// Areas relative to a power of two near a node's largest, so that none overflows.
class AreaScale {
public:
    explicit AreaScale(const Extents& extents);
    float area(Float4 lo, Float4 hi) const;
    /// Of three boxes at once, one a lane.
    Float4 areas(const Float4 lo[3], const Float4 hi[3]) const;

private:
    Float4 extent(Float4 lo, Float4 hi) const;
    Float4 scale_;
};

/// block_shift   items are counted in blocks of 2^block_shift.
/// Returns       the plane between bins of least area times blocks; among equal costs (no area at all) the most even one.
Split best_split(const Bins& bins, int bin_count, uint32_t item_count, int block_shift, const AreaScale& scale);

/// Puts the items left of a split before those right of it; keeps the order on both sides.
/// moved      room for as many items.
/// Returns    how many are left.
uint32_t partition(std::span<Item> items, const BinMap& map, const Split& split, Item* moved);

}  // namespace zoe::binning
