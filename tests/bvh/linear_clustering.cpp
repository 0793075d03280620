#include "tests/bvh/linear_clustering.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace zoe::test {

size_t linear_best_partner(std::span<const ListedCluster> list, size_t position) {
    std::tuple<double, uint32_t, uint32_t> best{std::numeric_limits<double>::infinity(), 0u, 0u};
    size_t partner = list.size();
    const ListedCluster& a = list[position];
    for (size_t k = 0; k < list.size(); ++k) {
        if (k == position) continue;
        const ListedCluster& b = list[k];
        const std::tuple key{merge(a.bounds, b.bounds).half_area(), std::min(a.id, b.id), std::max(a.id, b.id)};
        if (key < best) {
            best = key;
            partner = k;
        }
    }
    return partner;
}

Bvh linear_clustering(std::span<const Aabb> boxes) {
    Bvh bvh;
    if (boxes.empty()) return bvh;
    struct Union {
        Aabb bounds;
        uint32_t left = 0, right = 0;
    };
    std::vector<ListedCluster> list;
    std::vector<Union> made;  // [id], boxes too.
    for (const Aabb& box : boxes) {
        list.push_back({box, static_cast<uint32_t>(list.size())});
        made.push_back({box});
    }
    size_t a = 0;
    while (list.size() > 1) {
        size_t b = linear_best_partner(list, a);
        for (size_t c = linear_best_partner(list, b); c != a; c = linear_best_partner(list, b)) {
            a = b;
            b = c;
        }
        made.push_back({merge(list[a].bounds, list[b].bounds), list[a].id, list[b].id});
        list[a] = {made.back().bounds, static_cast<uint32_t>(made.size() - 1)};
        list.erase(list.begin() + static_cast<ptrdiff_t>(b));
        if (b < a) --a;
    }

    std::vector<uint32_t> ids{static_cast<uint32_t>(made.size() - 1)};
    for (size_t k = 0; k < ids.size(); ++k) {
        const uint32_t id = ids[k];
        const Aabb& box = made[id].bounds;
        if (id < boxes.size()) {
            bvh.nodes.push_back({box.lo, static_cast<uint32_t>(bvh.primitives.size()), box.hi, 1});
            bvh.primitives.push_back(id);
        } else {
            bvh.nodes.push_back({box.lo, static_cast<uint32_t>(ids.size()), box.hi, 0});
            ids.push_back(made[id].left);
            ids.push_back(made[id].right);
        }
    }
    return bvh;
}

}  // namespace zoe::test
