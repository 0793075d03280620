#include "tests/bvh/copies.h"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "engine/bvh/build_agglomerative.h"
#include "tests/bvh/each_target.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {

Blas swept(const TestMesh& mesh) {
    Blas blas;
    build_blas(mesh.positions, mesh.corners, BlasBuilder::kSweep, &blas);
    return blas;
}

// As TwoLevels asks for.
Aabb tight_box(const Affine& map, std::span<const glm::vec3> points) {
    glm::dvec3 lo(HUGE_VAL), hi(-HUGE_VAL);
    for (const glm::vec3& p : points) {
        const glm::dvec3 world = glm::dmat3(map.linear) * glm::dvec3(p) + glm::dvec3(map.translation);
        lo = glm::min(lo, world);
        hi = glm::max(hi, world);
    }
    double size = 0.0;
    for (int k = 0; k < 3; ++k) {
        size = std::max({size, std::abs(lo[k]), std::abs(hi[k]), std::abs(double(map.translation[k]))});
    }
    return {glm::vec3(lo - size * kTightSlack), glm::vec3(hi + size * kTightSlack)};
}

}  // namespace

Copies::Copies(TestMesh mesh, const std::vector<Affine>& world_from_local, float box_scale, Top top)
    : Copies(mesh, swept(mesh), world_from_local, box_scale, top) {}

Copies::Copies(TestMesh mesh, Blas blas, const std::vector<Affine>& world_from_local, float box_scale, Top top)
    : mesh_(std::move(mesh)), blas_(std::move(blas)) {
    std::vector<Aabb> boxes;
    std::vector<PlacedBlas> parts;
    std::vector<Aabb> part_bounds;
    for (const Affine& map : world_from_local) {
        const bool is_identity = map == Affine{};
        const Aabb box = blas_.tree.bounds();
        PlacedBlas one{.blas = &blas_, .is_identity = is_identity};
        Aabb bounds = is_identity ? box : transform(map, box);
        if (!is_identity && !invert(map, &one.local_from_world)) ADD_FAILURE() << "a map without an inverse";
        one.is_shifted = one.local_from_world.linear == glm::mat3(1.0f);
        const glm::vec3 cut = 0.5f * (1.0f - box_scale) * bounds.extent();
        bounds = {bounds.lo + cut, bounds.hi - cut};
        // Lower ids last, so that ties are not broken by the order alone.
        one.id = static_cast<uint32_t>(world_from_local.size() - placed_.size());
        placed_.push_back(one);
        bounds_.push_back(bounds);
        if (top == Top::kParts) {
            const WideNode& root = blas_.tree.nodes[0];
            for (int slot = 0; slot < kWidth && root.child[slot] != kEmptyChild; ++slot) {
                const Aabb part = root.box(slot);
                std::vector<glm::vec3> corners;
                for (int k = 0; k < 8; ++k) {
                    corners.emplace_back(k & 1 ? part.hi.x : part.lo.x, k & 2 ? part.hi.y : part.lo.y,
                                         k & 4 ? part.hi.z : part.lo.z);
                }
                parts.push_back(one);
                parts.back().start = root.child[slot];
                part_bounds.push_back(bounds);
                boxes.push_back(is_identity ? part : tight_box(map, corners));
            }
        } else {
            parts.push_back(one);
            part_bounds.push_back(bounds);
            boxes.push_back(top == Top::kTightBoxes && !is_identity ? tight_box(map, mesh_.positions) : bounds);
        }
    }
    std::vector<uint32_t> slots;
    CollapseScratch scratch;
    collapse(build_agglomerative(boxes, {}), {.block_size = 1, .max_leaf_blocks = 1}, &top_, &slots, &scratch);
    for (const uint32_t slot : slots) {
        traced_.push_back(parts[slot]);
        traced_bounds_.push_back(part_bounds[slot]);
    }
    levels_ = {&top_, traced_.data(), traced_bounds_.data(), top_.stack_size() + blas_.tree.stack_size() + 1,
               top == Top::kWholeBoxes ? 0.0f : kTightSlack};
}

RawHit Copies::brute_force(const Ray& ray) const {
    RawHit best{.t = ray.t_max};
    const SlabRay world(ray);
    if (world.is_valid && ray.t_min <= ray.t_max) {
        for (size_t copy = 0; copy < placed_.size(); ++copy) improve(copy, world, ray, &best);
    }
    return best.id == kEmptyChild ? RawHit{} : best;
}

void Copies::improve(size_t copy, const SlabRay& world, const Ray& ray, RawHit* best) const {
    const PlacedBlas& placed = placed_[copy];
    float t_floor = 0.0f;
    Ray local = ray;
    if (!placed.is_identity) {
        t_floor = entry(world, bounds_[copy].lo, bounds_[copy].hi, best->t);
        local.origin = placed.local_from_world.point(ray.origin);
        local.direction = placed.local_from_world.vector(ray.direction);
    }
    const RayFrame frame(local);
    if (!frame.is_valid) return;
    for (uint32_t primitive = 0; primitive < mesh_.corners.size(); ++primitive) {
        TriangleHit hit;
        if (!intersect(frame, mesh_.triangle(primitive), t_floor, ray.t_min, best->t, &hit)) continue;
        if (std::tuple(hit.t, placed.id, primitive) >= std::tuple(best->t, best->id, best->primitive)) continue;
        *best = {hit.t, hit.u, hit.v, placed.id, primitive};
    }
}

bool is_same(const RawHit& a, const RawHit& b) {
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
    return bits(a.t) == bits(b.t) && bits(a.u) == bits(b.u) && bits(a.v) == bits(b.v) && a.id == b.id &&
           a.primitive == b.primitive;
}

int expect_batches_right(const Copies& copies, const std::vector<Ray>& rays) {
    std::vector<RawHit> expected;
    for (const Ray& ray : rays) expected.push_back(copies.brute_force(ray));
    on_each_target([&] {
        std::vector<RawHit> hits(rays.size());
        std::vector<uint8_t> is_hit(rays.size(), 2);
        closest_hits(copies.levels(), rays, hits.data(), nullptr);
        any_hits(copies.levels(), rays, is_hit.data(), nullptr);
        for (size_t k = 0; k < rays.size(); ++k) {
            ASSERT_TRUE(is_same(hits[k], expected[k]))
                << "ray " << k << ": t " << hits[k].t << " of " << hits[k].id << ", " << hits[k].primitive << "; expected "
                << expected[k].t << " of " << expected[k].id << ", " << expected[k].primitive;
            ASSERT_EQ(is_hit[k], expected[k].id != kEmptyChild) << "ray " << k;
            RawHit single;
            closest_hits(copies.levels(), {&rays[k], 1}, &single, nullptr);
            ASSERT_TRUE(is_same(single, expected[k])) << "alone, ray " << k;
        }
    });
    return static_cast<int>(std::ranges::count_if(expected, [](const RawHit& hit) { return hit.id != kEmptyChild; }));
}

std::vector<Affine> random_affines(int count, double scale_lo, double scale_hi, float translation, uint64_t seed) {
    Rng rng(seed);
    std::vector<Affine> maps;
    for (int k = 0; k < count; ++k) maps.push_back(random_affine(rng, scale_lo, scale_hi, translation));
    return maps;
}

}  // namespace zoe::test
