#include "engine/bvh/clip.h"

#include <algorithm>
#include <limits>

namespace zoe {

namespace {

constexpr float kLargest = std::numeric_limits<float>::max();

// Finite always: what lies past the largest float is past every corner.
float rounded_down(double x) {
    const auto nearest = static_cast<float>(std::clamp<double>(x, -kLargest, kLargest));
    return nearest <= x ? nearest : std::nextafter(nearest, -kLargest);
}
float rounded_up(double x) {
    const auto nearest = static_cast<float>(std::clamp<double>(x, -kLargest, kLargest));
    return nearest >= x ? nearest : std::nextafter(nearest, kLargest);
}

// Both ends outwards by an ulp: the point itself is not a float, and what rounds to one is off by half of that.
void extend(Aabb& box, const glm::dvec3& point) {
    const glm::vec3 nearest(point);
    const glm::vec3 slack = glm::abs(nearest) * 0x1p-23f + std::numeric_limits<float>::min();
    box.lo = glm::min(box.lo, nearest - slack);
    box.hi = glm::max(box.hi, nearest + slack);
}

Aabb common(const Aabb& a, const Aabb& b) {
    const Aabb box{glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
    return box.is_empty() ? Aabb{} : box;
}

}  // namespace

ClippedBoxes split_box(const Triangle& triangle, const Aabb& box, int axis, float plane) {
    const glm::vec3* corners[3] = {&triangle.a, &triangle.b, &triangle.c};
    ClippedBoxes pieces;
    for (int k = 0; k < 3; ++k) {
        const glm::vec3 *p = corners[k], *q = corners[k == 2 ? 0 : k + 1];
        if ((*p)[axis] <= plane) pieces.left.extend(*p);
        if ((*p)[axis] >= plane) pieces.right.extend(*p);
        if ((*p)[axis] > (*q)[axis]) std::swap(p, q);
        if (!((*p)[axis] < plane && plane < (*q)[axis])) continue;
        const glm::dvec3 from(*p), to(*q);
        const glm::dvec3 cut = from + (to - from) * ((plane - from[axis]) / (to[axis] - from[axis]));
        extend(pieces.left, cut);
        extend(pieces.right, cut);
    }
    pieces.left.hi[axis] = std::min(pieces.left.hi[axis], plane);
    pieces.right.lo[axis] = std::max(pieces.right.lo[axis], plane);
    return {common(pieces.left, box), common(pieces.right, box)};
}

Aabb padded(const Aabb& box, const Triangle& triangle) {
    const Aabb whole = bounds(triangle);
    const glm::dvec3 extent = glm::dvec3(whole.hi) - glm::dvec3(whole.lo);
    const double pad = 0x1p-20 * std::max({extent.x, extent.y, extent.z});
    Aabb wide;
    for (int axis = 0; axis < 3; ++axis) {
        wide.lo[axis] = rounded_down(box.lo[axis] - pad);
        wide.hi[axis] = rounded_up(box.hi[axis] + pad);
    }
    return wide;
}

}  // namespace zoe
