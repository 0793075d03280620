#include "engine/bvh/morton_order.h"

#include <algorithm>
#include <numeric>

#include "engine/bvh/sort_keys.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 4096;
constexpr int kAxisBits = 21;
constexpr uint64_t kLastCell = (uint64_t{1} << kAxisBits) - 1;
constexpr uint64_t kNoPlace = ~uint64_t{0};  // After every code.

// Moves bit k of 21 to bit 3 k.
uint64_t spread(uint64_t x) {
    x = (x | x << 32) & 0x001f00000000ffffull;
    x = (x | x << 16) & 0x001f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

// A cube over centres, in cells. A code takes the upper 63 bits.
struct Grid {
    explicit Grid(const Aabb& centres) : origin(centres.lo) {
        double widest = 0.0;
        for (int axis = 0; axis < 3; ++axis) widest = std::max(widest, double(centres.hi[axis]) - centres.lo[axis]);
        cells_per_unit = widest > 0.0 ? double(kLastCell) / widest : 0.0;
    }
    bool tells_apart() const { return cells_per_unit > 0.0; }
    uint64_t cell(float x, int axis) const {
        const double at = (double(x) - origin[axis]) * cells_per_unit;
        return at > 0.0 ? static_cast<uint64_t>(std::min(at, double(kLastCell))) : 0;
    }
    uint64_t code(const glm::vec3& centre) const {
        return spread(cell(centre.x, 0)) << 3 | spread(cell(centre.y, 1)) << 2 | spread(cell(centre.z, 2)) << 1;
    }

    glm::vec3 origin;
    double cells_per_unit;
};

Aabb bounds_of_centres(std::span<const Aabb> boxes, std::span<const uint32_t> range, std::vector<Aabb>* parts) {
    parts->resize((range.size() + kGrain - 1) / kGrain);
    parallel_for(0, range.size(), kGrain, [&](size_t begin, size_t end) {
        Aabb bounds;
        for (size_t k = begin; k < end; ++k) {
            if (boxes[range[k]].is_proper()) bounds.extend(boxes[range[k]].centre());
        }
        (*parts)[begin / kGrain] = bounds;
    });
    Aabb bounds;
    for (const Aabb& part : *parts) bounds.extend(part);
    return bounds;
}

// Calls `take(begin, end)` for every two keys or more in a row that are equal in their upper halves.
template <typename Take>
void for_each_run(std::span<const uint64_t> keys, Take&& take) {
    for (size_t begin = 0, end = 1; begin < keys.size(); begin = end++) {
        while (end < keys.size() && (keys[end] ^ keys[begin]) >> 32 == 0) ++end;
        if (end - begin > 1) take(begin, end);
    }
}

// Orders what the upper halves of the codes leave together by the lower halves.
void sort_run(std::span<uint64_t> run, MortonScratch* scratch) {
    scratch->run.clear();
    for (const uint64_t key : run) scratch->run.push_back(scratch->codes[index_of(key)] << 32 | index_of(key));
    sort_keys(&scratch->run, &scratch->sort_scratch);
    std::copy(scratch->run.begin(), scratch->run.end(), run.begin());
}

// Orders a range of ascending indices by a grid of its own. What this leaves in one cell is to be ordered next.
void order_range(std::span<const Aabb> boxes, size_t first, std::span<uint32_t> range, MortonScratch* scratch) {
    const Grid grid(bounds_of_centres(boxes, range, &scratch->centre_bounds));
    std::vector<uint64_t>& keys = scratch->keys;
    keys.resize(range.size());
    parallel_for(0, range.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            const Aabb& box = boxes[range[k]];
            const uint64_t code = box.is_proper() ? grid.code(box.centre()) : kNoPlace;
            scratch->codes[range[k]] = code;
            keys[k] = (code & ~uint64_t{0xffffffffu}) | range[k];
        }
    });
    sort_keys(&keys, &scratch->sort_scratch);
    for_each_run(keys, [&](size_t begin, size_t end) {
        sort_run({&keys[begin], end - begin}, scratch);
        if (!grid.tells_apart()) return;
        for_each_run(scratch->run, [&](size_t from, size_t to) {
            scratch->unordered.push_back({first + begin + from, first + begin + to});
        });
    });
    for (size_t k = 0; k < range.size(); ++k) range[k] = index_of(keys[k]);
}

}  // namespace

void morton_order(std::span<const Aabb> boxes, std::vector<uint32_t>* order, MortonScratch* scratch) {
    const size_t count = boxes.size();
    order->resize(count);
    std::iota(order->begin(), order->end(), 0u);
    scratch->codes.resize(count);
    for (std::vector<uint64_t>* keys : {&scratch->keys, &scratch->run, &scratch->sort_scratch}) keys->reserve(count);
    scratch->unordered.reserve(count / 2 + 1);
    scratch->unordered.clear();
    scratch->unordered.push_back({0, count});
    // Each grid is of cells at most 2^-21 as wide as the one before: floats have room for 14 of them.
    while (!scratch->unordered.empty()) {
        const auto [begin, end] = scratch->unordered.back();
        scratch->unordered.pop_back();
        order_range(boxes, begin, {order->data() + begin, end - begin}, scratch);
    }
}

}  // namespace zoe
