#include "engine/frame/trace.h"

#include <bit>
#include <cassert>
#include <utility>

#include "engine/bvh/small_stack.h"
#include "engine/math/rng.h"

namespace zoe {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Entry {
    uint32_t node;
    float t;  // Entry into the node's box.
};

// The ray in the space of an instance. The direction is not normalised, so t stays in the world's unit.
RayFrame local_frame(const Instance& instance, const Ray& ray) {
    Ray local = ray;
    local.origin = instance.local_from_world.point(ray.origin);
    local.direction = instance.local_from_world.vector(ray.direction);
    return RayFrame(local);
}

void hit_instance(const Instance& instance, const Ray& ray, const RayFrame& world, float t_entry, Hit* hit,
                  TraverseCounts* counts) {
    BlasHit found{.t = hit->t};
    const bool is_found = instance.is_identity
                              ? closest_hit(*instance.blas, world, t_entry, ray.t_min, &found, counts)
                              : closest_hit(*instance.blas, local_frame(instance, ray), t_entry, ray.t_min, &found, counts);
    if (is_found && (found.t < hit->t || instance.node < hit->node)) {
        *hit = {found.t, found.u, found.v, instance.node, found.primitive};
    }
}

}  // namespace

Hit closest_hit(const Tlas& tlas, const Ray& ray, TraverseCounts* counts) {
    const RayFrame world(ray);
    Hit hit;
    if (tlas.bvh.nodes.empty() || !world.is_valid) return hit;
    hit.t = ray.t_max;
    const BvhNode* nodes = tlas.bvh.nodes.data();
    uint32_t node_count = 1;
    SmallStack<Entry, 64> open;
    Entry at{0, entry(world, nodes[0].lo, nodes[0].hi, hit.t)};
    for (;;) {
        if (at.t <= hit.t && at.t < kInfinity) {
            const BvhNode& node = nodes[at.node];
            if (!node.is_leaf()) {
                Entry near{node.first, entry(world, nodes[node.first].lo, nodes[node.first].hi, hit.t)};
                Entry far{node.first + 1, entry(world, nodes[node.first + 1].lo, nodes[node.first + 1].hi, hit.t)};
                node_count += 2;
                if (far.t < near.t) std::swap(near, far);
                if (far.t < kInfinity) open.push(far);
                at = near;
                continue;
            }
            // A leaf is one instance, and its box that instance's: the entry is the same whatever the tree.
            hit_instance(tlas.instances[tlas.bvh.primitives[node.first]], ray, world, at.t, &hit, counts);
        }
        if (open.is_empty()) break;
        at = open.pop();
    }
    if (counts) counts->nodes += node_count;
    return hit ? hit : Hit{};
}

bool any_hit(const Tlas& tlas, const Ray& ray, TraverseCounts* counts) {
    const RayFrame world(ray);
    if (tlas.bvh.nodes.empty() || !world.is_valid) return false;
    uint32_t node_count = 0;
    bool is_hit = false;
    SmallStack<uint32_t, 64> open;
    open.push(0);
    while (!open.is_empty() && !is_hit) {
        const BvhNode& node = tlas.bvh.nodes[open.pop()];
        ++node_count;
        const float t = entry(world, node.lo, node.hi, ray.t_max);
        if (!(t < kInfinity)) continue;
        if (!node.is_leaf()) {
            open.push(node.first + 1);
            open.push(node.first);
            continue;
        }
        const Instance& instance = tlas.instances[tlas.bvh.primitives[node.first]];
        is_hit = instance.is_identity ? any_hit(*instance.blas, world, t, ray.t_min, ray.t_max, counts)
                                      : any_hit(*instance.blas, local_frame(instance, ray), t, ray.t_min, ray.t_max, counts);
    }
    if (counts) counts->nodes += node_count;
    return is_hit;
}

void closest_hits(const Tlas& tlas, std::span<const Ray> rays, std::span<Hit> hits) {
    assert(rays.size() == hits.size());
    for (size_t k = 0; k < rays.size(); ++k) hits[k] = closest_hit(tlas, rays[k]);
}

void any_hits(const Tlas& tlas, std::span<const Ray> rays, std::span<uint8_t> is_hit) {
    assert(rays.size() == is_hit.size());
    for (size_t k = 0; k < rays.size(); ++k) is_hit[k] = any_hit(tlas, rays[k]);
}

uint64_t hash(const Hit& hit, uint64_t key) {
    uint64_t h = mix_bits(key ^ 0x9e3779b97f4a7c15ull);
    h = mix_bits(h ^ (uint64_t(std::bit_cast<uint32_t>(hit.t)) << 32 | index(hit.node)));
    h = mix_bits(h ^ (uint64_t(std::bit_cast<uint32_t>(hit.u)) << 32 | std::bit_cast<uint32_t>(hit.v)));
    return mix_bits(h ^ hit.primitive);
}

}  // namespace zoe
