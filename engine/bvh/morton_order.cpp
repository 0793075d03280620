#include "engine/bvh/morton_order.h"

#include <algorithm>

#include "engine/bvh/sort_keys.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 4096;
constexpr int kAxisBits = 21;
constexpr uint64_t kLastCell = (uint64_t{1} << kAxisBits) - 1;
constexpr uint64_t kNoPlace = ~uint64_t{0};  // After every code.

bool has_place(const Aabb& box) {
    return box.is_finite() && !box.is_empty();
}

// Moves bit k of 21 to bit 3 k.
uint64_t spread(uint64_t x) {
    x = (x | x << 32) & 0x001f00000000ffffull;
    x = (x | x << 16) & 0x001f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

// A cube over all centres, in cells. A code takes the upper 63 bits.
struct Grid {
    explicit Grid(const Aabb& centres) : origin(centres.lo) {
        double widest = 0.0;
        for (int axis = 0; axis < 3; ++axis) widest = std::max(widest, double(centres.hi[axis]) - centres.lo[axis]);
        cells_per_unit = widest > 0.0 ? double(kLastCell) / widest : 0.0;
    }
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

Aabb bounds_of_centres(std::span<const Aabb> boxes, std::vector<Aabb>* parts) {
    parts->resize((boxes.size() + kGrain - 1) / kGrain);
    parallel_for(0, boxes.size(), kGrain, [&](size_t begin, size_t end) {
        Aabb bounds;
        for (size_t k = begin; k < end; ++k) {
            if (has_place(boxes[k])) bounds.extend(boxes[k].centre());
        }
        (*parts)[begin / kGrain] = bounds;
    });
    Aabb bounds;
    for (const Aabb& part : *parts) bounds.extend(part);
    return bounds;
}

// Orders what the upper halves of the codes leave together by the lower halves.
void sort_run(std::span<uint64_t> run, MortonScratch* scratch) {
    scratch->run.clear();
    for (const uint64_t key : run) scratch->run.push_back(scratch->codes[index_of(key)] << 32 | index_of(key));
    sort_keys(&scratch->run, &scratch->sort_scratch);
    std::copy(scratch->run.begin(), scratch->run.end(), run.begin());
}

}  // namespace

void morton_order(std::span<const Aabb> boxes, std::vector<uint32_t>* order, MortonScratch* scratch) {
    const size_t count = boxes.size();
    order->resize(count);
    if (count == 0) return;
    const Grid grid(bounds_of_centres(boxes, &scratch->centre_bounds));
    scratch->codes.resize(count);
    scratch->keys.resize(count);
    parallel_for(0, count, kGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            const uint64_t code = has_place(boxes[k]) ? grid.code(boxes[k].centre()) : kNoPlace;
            scratch->codes[k] = code;
            scratch->keys[k] = (code & ~uint64_t{0xffffffffu}) | k;
        }
    });
    scratch->run.reserve(count);
    scratch->sort_scratch.reserve(count);
    sort_keys(&scratch->keys, &scratch->sort_scratch);
    std::vector<uint64_t>& keys = scratch->keys;
    for (size_t begin = 0, end = 1; begin < count; begin = end++) {
        while (end < count && (keys[end] ^ keys[begin]) >> 32 == 0) ++end;
        if (end - begin > 1) sort_run({&keys[begin], end - begin}, scratch);
    }
    for (size_t k = 0; k < count; ++k) (*order)[k] = index_of(keys[k]);
}

}  // namespace zoe
