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

namespace {

struct Union {
    Aabb bounds;
    uint32_t left = 0, right = 0;
};

/// Merges all that are each other's best, by the lower id.
/// Returns    how many pairs.
size_t merge_mutual(std::vector<ListedCluster>* list, std::vector<Union>* made) {
    std::vector<size_t> partners;
    for (size_t k = 0; k < list->size(); ++k) partners.push_back(linear_best_partner(*list, k));
    std::vector<ListedCluster> rest, unions;
    for (size_t a = 0; a < list->size(); ++a) {
        const size_t b = partners[a];
        if (partners[b] != a) rest.push_back((*list)[a]);
        if (partners[b] != a || b < a) continue;
        made->push_back({merge((*list)[a].bounds, (*list)[b].bounds), (*list)[a].id, (*list)[b].id});
        unions.push_back({made->back().bounds, static_cast<uint32_t>(made->size() - 1)});
    }
    *list = rest;
    list->insert(list->end(), unions.begin(), unions.end());
    return unions.size();
}

}  // namespace

Bvh linear_clustering(std::span<const Aabb> boxes) {
    Bvh bvh;
    if (boxes.empty()) return bvh;
    std::vector<ListedCluster> list;  // By rising id, while there are rounds.
    std::vector<Union> made;          // [id], boxes too.
    for (const Aabb& box : boxes) {
        list.push_back({box, static_cast<uint32_t>(list.size())});
        made.push_back({box});
    }
    while (list.size() > 128) {
        const size_t before = list.size();
        if (16 * merge_mutual(&list, &made) < before) break;
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
