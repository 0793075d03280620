#include "engine/bvh/static_bvh.h"

#include <algorithm>
#include <numeric>

namespace zoe {

namespace {

bool contains(const Aabb& box, const glm::dvec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(box.lo[axis] <= p[axis] && p[axis] <= box.hi[axis])) return false;
    }
    return true;
}

// The tree with every reference as a primitive of its own, which `validate` takes. Boxes of references: none, as a piece's
// is not known any more.
std::string check_links(const Bvh& tree) {
    Bvh numbered = tree;
    std::iota(numbered.primitives.begin(), numbered.primitives.end(), 0u);
    return validate(numbered, std::vector<Aabb>(tree.primitives.size()));
}

}  // namespace

bool is_held(const Triangle& t, std::span<const Aabb> boxes) {
    // In double: most of these are no floats.
    const glm::dvec3 a(t.a), b(t.b), c(t.c);
    const glm::dvec3 samples[] = {
        a, b, c, 0.5 * a + 0.5 * b, 0.5 * b + 0.5 * c, 0.5 * c + 0.5 * a, a / 3.0 + b / 3.0 + c / 3.0};
    return std::all_of(std::begin(samples), std::end(samples), [&](const glm::dvec3& sample) {
        return std::any_of(boxes.begin(), boxes.end(), [&](const Aabb& box) { return contains(box, sample); });
    });
}

std::string validate(const StaticBvh& bvh, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners) {
    const Bvh& tree = bvh.tree;
    if (bvh.primitive_count != corners.size()) {
        return "built over " + std::to_string(bvh.primitive_count) + " triangles, not " + std::to_string(corners.size());
    }
    for (const uint32_t primitive : tree.primitives) {
        if (primitive >= corners.size()) return "primitive " + std::to_string(primitive) + " out of range";
    }
    if (std::string broken = check_links(tree); !broken.empty()) return broken;
    // The leaves of each primitive, one after another.
    struct Place {
        uint32_t primitive, leaf;
    };
    std::vector<Place> places;
    for (uint32_t k = 0; k < tree.nodes.size(); ++k) {
        const BvhNode& node = tree.nodes[k];
        for (uint32_t i = 0; i < node.count; ++i) places.push_back({tree.primitives[node.first + i], k});
    }
    std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.primitive < b.primitive; });
    std::vector<Aabb> boxes;
    size_t at = 0;
    for (uint32_t primitive = 0; primitive < corners.size(); ++primitive) {
        const size_t begin = at;
        while (at < places.size() && places[at].primitive == primitive) ++at;
        const std::string name = "primitive " + std::to_string(primitive);
        if (at == begin) return name + " is in no leaf";
        for (size_t k = begin + 1; k < at; ++k) {
            if (places[k].leaf == places[k - 1].leaf) return name + " stands twice in a leaf";
        }
        const glm::uvec3& c = corners[primitive];
        const Triangle triangle{positions[c.x], positions[c.y], positions[c.z], primitive};
        if (!is_finite(triangle.a) || !is_finite(triangle.b) || !is_finite(triangle.c)) continue;
        if (at - begin == 1) {
            if (!tree.nodes[places[begin].leaf].bounds().contains(bounds(triangle)))
                return name + " sticks out of its only leaf";
            continue;
        }
        boxes.clear();
        for (size_t k = begin; k < at; ++k) boxes.push_back(tree.nodes[places[k].leaf].bounds());
        if (!is_held(triangle, boxes)) return name + " sticks out of its leaves";
    }
    return "";
}

}  // namespace zoe
