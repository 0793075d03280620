#include "tests/bvh/linear_clustering.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace zoe::test {

namespace {

float float_half_area(const Aabb& a, const Aabb& b) {
    float extent[3];
    for (int axis = 0; axis < 3; ++axis) {
        const float hi = std::clamp(std::max(a.hi[axis], b.hi[axis]), -1e18f, 1e18f);
        const float lo = std::clamp(std::min(a.lo[axis], b.lo[axis]), -1e18f, 1e18f);
        extent[axis] = hi - lo;
    }
    return extent[0] * (extent[1] + extent[2]) + extent[1] * extent[2];
}

}  // namespace

Aabb grown(Aabb box) {
    for (int axis = 0; axis < 3; ++axis) {
        const float lo = std::clamp(box.lo[axis], -1e18f, 1e18f);
        box.hi[axis] = std::max(box.hi[axis], lo + std::ldexp(1.0f, -62));
    }
    return box;
}

size_t linear_best_partner(std::span<const ListedCluster> list, size_t position) {
    std::tuple<float, uint32_t, uint32_t, uint32_t> best{std::numeric_limits<float>::infinity(), 0u, 0u, 0u};
    size_t partner = list.size();
    const ListedCluster& a = list[position];
    for (size_t k = 0; k < list.size(); ++k) {
        if (k == position) continue;
        const ListedCluster& b = list[k];
        const std::tuple key{float_half_area(a.bounds, b.bounds), a.box_count + b.box_count, std::min(a.id, b.id),
                             std::max(a.id, b.id)};
        if (key < best) {
            best = key;
            partner = k;
        }
    }
    return partner;
}

Bvh linear_clustering(std::span<const Aabb> boxes) {
    struct Made {
        Aabb bounds;
        uint32_t left = 0, right = 0;
    };
    Bvh bvh;
    if (boxes.empty()) return bvh;
    std::vector<ListedCluster> list;
    std::vector<Made> made;            // Boxes, then unions.
    std::vector<uint32_t> made_of_id;  // The last one.
    for (const Aabb& box : boxes) {
        made_of_id.push_back(static_cast<uint32_t>(list.size()));
        list.push_back({grown(box), static_cast<uint32_t>(list.size())});
        made.push_back({box});
    }
    size_t a = 0;
    while (list.size() > 1) {
        size_t b = linear_best_partner(list, a);
        for (size_t c = linear_best_partner(list, b); c != a; c = linear_best_partner(list, b)) {
            a = b;
            b = c;
        }
        const ListedCluster &low = list[list[a].id < list[b].id ? a : b], &high = list[list[a].id < list[b].id ? b : a];
        const uint32_t left = made_of_id[low.id], right = made_of_id[high.id];
        made.push_back({merge(made[left].bounds, made[right].bounds), left, right});
        made_of_id[low.id] = static_cast<uint32_t>(made.size() - 1);
        list[a] = {merge(low.bounds, high.bounds), low.id, low.box_count + high.box_count};
        list.erase(list.begin() + static_cast<ptrdiff_t>(b));
        if (b < a) --a;
    }

    std::vector<uint32_t> open{static_cast<uint32_t>(made.size() - 1)};
    for (size_t k = 0; k < open.size(); ++k) {
        const uint32_t at = open[k];
        const Aabb& box = made[at].bounds;
        if (at < boxes.size()) {
            bvh.nodes.push_back({box.lo, static_cast<uint32_t>(bvh.primitives.size()), box.hi, 1});
            bvh.primitives.push_back(at);
        } else {
            bvh.nodes.push_back({box.lo, static_cast<uint32_t>(open.size()), box.hi, 0});
            open.push_back(made[at].left);
            open.push_back(made[at].right);
        }
    }
    return bvh;
}

}  // namespace zoe::test
