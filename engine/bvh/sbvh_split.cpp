#include "engine/bvh/sbvh_split.h"

#include <algorithm>
#include <cmath>

#include "engine/bvh/sort_keys.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr int kMaxBins = 64;
constexpr size_t kParallelSize = 65536;  // From here the three axes are worth a thread each.

template <typename Body>
void for_each_axis(size_t count, const Body& body) {
    const size_t grain = count >= kParallelSize ? 1 : 3;
    parallel_for(0, 3, grain, [&](size_t begin, size_t end) {
        for (size_t axis = begin; axis < end; ++axis) body(static_cast<int>(axis));
    });
}

float centre(const Reference& reference, int axis) {
    const Aabb& box = reference.box;
    return box.is_empty() ? 0.0f : 0.5f * box.lo[axis] + 0.5f * box.hi[axis];
}

uint32_t unevenness(uint32_t position, uint32_t count) {
    return std::max(position, count - position);
}

uint32_t blocks(uint32_t count, int block_shift) {
    return ((count - 1) >> block_shift) + 1;
}

struct Position {
    uint32_t position = 0;
    double cost = std::numeric_limits<double>::infinity();
};

// Costs that differ by rounding only are equal: boxes that all coincide are split in the middle.
bool is_better(const Position& a, const Position& b, uint32_t count) {
    const double slack = 1e-12 * b.cost;
    if (b.position == 0 || a.cost < b.cost - slack) return true;
    return a.cost <= b.cost + slack && unevenness(a.position, count) < unevenness(b.position, count);
}

Position best_position(std::span<const Reference> references, const std::vector<uint64_t>& order, int block_shift,
                       std::vector<double>* right_areas) {
    const auto count = static_cast<uint32_t>(references.size());
    right_areas->resize(count);
    Aabb right;
    for (uint32_t k = count; --k > 0;) {
        right.extend(references[index_of(order[k])].box);
        (*right_areas)[k] = right.half_area();
    }
    Position best;
    Aabb left;
    for (uint32_t k = 1; k < count; ++k) {
        left.extend(references[index_of(order[k - 1])].box);
        const Position here{k,
                            left.half_area() * blocks(k, block_shift) + (*right_areas)[k] * blocks(count - k, block_shift)};
        if (is_better(here, best, count)) best = here;
    }
    return best;
}

struct Bin {
    Aabb bounds;
    uint32_t first_count = 0, last_count = 0;  // References whose first and whose last bin this is.
};

// Planes between the bins of one axis.
class Planes {
public:
    Planes(float lo, float hi, int bin_count) : count_(bin_count) {
        const double width = (double(hi) - lo) / bin_count;
        for (int k = 1; k < bin_count; ++k) planes_[k] = static_cast<float>(lo + k * width);
        lo_ = lo;
        scale_ = static_cast<float>(1.0 / width);
    }
    float operator[](int k) const { return planes_[k]; }  // Between bins k - 1 and k.
    bool is_usable() const { return std::isfinite(scale_) && scale_ > 0.0f; }
    // Near enough: `split_box` decides what is really on either side of a plane.
    int bin_of(float x) const {
        const float bin = (x - lo_) * scale_;
        return bin < static_cast<float>(count_ - 1) ? static_cast<int>(std::max(bin, 0.0f)) : count_ - 1;
    }

private:
    std::array<float, kMaxBins> planes_{};
    float lo_, scale_;
    int count_;
};

// Adds a reference to the bins that it crosses, cut at the planes between them.
void bin(const Reference& reference, const Triangle& triangle, int axis, const Planes& planes, Bin* bins) {
    int first = planes.bin_of(reference.box.lo[axis]);
    const int last = planes.bin_of(reference.box.hi[axis]);
    Aabb rest = reference.box;
    int entered = -1, left = first;
    for (int k = first; k < last && !rest.is_empty(); ++k) {
        const float plane = planes[k + 1];
        if (rest.hi[axis] <= plane) break;
        if (rest.lo[axis] >= plane) continue;
        const ClippedBoxes pieces = split_box(triangle, rest, axis, plane);
        if (!pieces.left.is_empty()) {
            bins[k].bounds.extend(pieces.left);
            if (entered < 0) entered = k;
            left = k;
        }
        rest = pieces.right;
    }
    if (!rest.is_empty()) {
        // The bin that the rest begins in: rounding may have put it one off its planes.
        while (first < last && rest.lo[axis] >= planes[first + 1]) ++first;
        left = std::max(left, first);
        bins[left].bounds.extend(rest);
        if (entered < 0) entered = left;
    }
    ++bins[std::max(entered, 0)].first_count;
    ++bins[left].last_count;
}

}  // namespace

ObjectSplit best_object_split(std::span<const Reference> references, int block_shift, SplitScratch* scratch) {
    const auto count = static_cast<uint32_t>(references.size());
    std::array<Position, 3> best;
    for_each_axis(count, [&](int axis) {
        std::vector<uint64_t>& order = scratch->orders[axis];
        order.resize(count);
        for (uint32_t k = 0; k < count; ++k) order[k] = sort_key(centre(references[k], axis), k);
        sort_keys(&order, &scratch->keys[axis]);
        best[axis] = best_position(references, order, block_shift, &scratch->right_areas[axis]);
    });
    ObjectSplit split;
    split.axis = 0;
    for (int axis = 1; axis < 3; ++axis) {
        if (is_better(best[axis], best[split.axis], count)) split.axis = axis;
    }
    split.position = best[split.axis].position;
    split.cost = best[split.axis].cost;
    const std::vector<uint64_t>& order = scratch->orders[split.axis];
    for (uint32_t k = 0; k < count; ++k) {
        (k < split.position ? split.left : split.right).extend(references[index_of(order[k])].box);
    }
    return split;
}

SpatialSplit best_spatial_split(std::span<const Reference> references, const Aabb& bounds,
                                std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, int bin_count,
                                int block_shift) {
    std::array<SpatialSplit, 3> best;
    for_each_axis(references.size(), [&](int axis) {
        const Planes planes(bounds.lo[axis], bounds.hi[axis], bin_count);
        if (!planes.is_usable()) return;
        std::array<Bin, kMaxBins> bins;
        uint32_t nowhere_count = 0;
        for (const Reference& reference : references) {
            if (reference.box.is_empty()) {
                ++nowhere_count;
                continue;
            }
            const glm::uvec3& c = corners[reference.primitive];
            const Triangle triangle{positions[c.x], positions[c.y], positions[c.z], reference.primitive};
            bin(reference, triangle, axis, planes, bins.data());
        }
        std::array<Bin, kMaxBins> rights;
        Bin right;
        for (int k = bin_count; --k > 0;) {
            right.bounds.extend(bins[k].bounds);
            right.last_count += bins[k].last_count;
            rights[k] = right;
        }
        Aabb left;
        uint32_t left_count = nowhere_count;  // What has no box goes left.
        for (int k = 1; k < bin_count; ++k) {
            left.extend(bins[k - 1].bounds);
            left_count += bins[k - 1].first_count;
            const uint32_t right_count = rights[k].last_count;
            if (left_count == 0 || right_count == 0) continue;
            if (!(planes[k] > bounds.lo[axis] && planes[k] < bounds.hi[axis])) continue;
            const double cost = left.half_area() * blocks(left_count, block_shift) +
                                rights[k].bounds.half_area() * blocks(right_count, block_shift);
            if (cost < best[axis].cost) {
                best[axis] = {axis, planes[k], cost, left, rights[k].bounds, left_count, right_count};
            }
        }
    });
    return *std::min_element(best.begin(), best.end(),
                             [](const SpatialSplit& a, const SpatialSplit& b) { return a.cost < b.cost; });
}

}  // namespace zoe
