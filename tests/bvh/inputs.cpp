#include "tests/bvh/inputs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/bvh/build_agglomerative.h"
#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_median.h"
#include "engine/bvh/build_ploc.h"
#include "engine/bvh/build_poses.h"
#include "engine/bvh/build_sweep.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

bool is_finite(const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Moves every corner by a function of where it is.
TestMesh mapped(TestMesh mesh, const std::string& name, const std::function<glm::vec3(const glm::vec3&)>& map) {
    mesh.name = name;
    for (glm::vec3& p : mesh.positions) p = map(p);
    return mesh;
}

TestMesh first(const TestMesh& mesh, int count, const std::string& name) {
    TestMesh result = mesh;
    result.name = name;
    result.corners.resize(count);
    return result;
}

// The boxes where they are, backwards, and somewhere else each.
Bvh over_three_poses(std::span<const Aabb> boxes) {
    std::vector<Aabb> poses(boxes.begin(), boxes.end());
    poses.insert(poses.end(), boxes.rbegin(), boxes.rend());
    for (size_t k = 0; k < boxes.size(); ++k) poses.push_back(boxes[(k * 7919) % boxes.size()]);
    return build_poses(poses, 3, {.bin_count = 8, .block_size = 4, .node_cost = 0.5f});
}

}  // namespace

void TestMesh::add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto k = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    corners.push_back({k, k + 1, k + 2});
}

Triangle TestMesh::triangle(uint32_t primitive) const {
    const glm::uvec3 c = corners[primitive];
    return {positions[c.x], positions[c.y], positions[c.z], primitive};
}

std::vector<Aabb> TestMesh::boxes() const {
    std::vector<Aabb> result;
    for (uint32_t k = 0; k < corners.size(); ++k) {
        const Triangle t = triangle(k);
        result.push_back(is_finite(t.a) && is_finite(t.b) && is_finite(t.c) ? bounds(t) : Aabb{});
    }
    return result;
}

TestMesh random_soup(int triangle_count, float size, uint64_t seed) {
    TestMesh mesh{"random soup", {}, {}};
    Rng rng(seed);
    for (int k = 0; k < triangle_count; ++k) {
        const glm::vec3 place = random_point(rng, 10.0f);
        const glm::vec3 a = random_point(rng, size), b = random_point(rng, size), c = random_point(rng, size);
        mesh.add(place + a, place + b, place + c);
    }
    return mesh;
}

TestMesh large_among_small(uint64_t seed) {
    TestMesh mesh = random_soup(3000, 0.1f, seed);
    Rng rng(seed);
    for (int k = 0; k < 60; ++k) mesh.add(random_point(rng, 10.0f), random_point(rng, 10.0f), random_point(rng, 10.0f));
    return mesh;
}

TestMesh stack_of_triangles(int count) {
    TestMesh mesh{"chain", {}, {}};
    for (int k = 0; k < count; ++k) {
        const auto z = static_cast<float>(k);
        mesh.add({-1, -1, z}, {1, -1, z}, {0, 1, z});
    }
    return mesh;
}

Bvh chain_over(const std::vector<Aabb>& boxes) {
    const auto n = static_cast<uint32_t>(boxes.size());
    Bvh bvh;
    bvh.nodes.resize(2 * n - 1);
    Aabb rest;
    for (uint32_t k = n; k-- > 0;) {
        // Chain node 2k - 1 (the root is 0) over primitives [k, n); its leaf stands right before the next chain node.
        rest.extend(boxes[k]);
        const uint32_t chain = k == 0 ? 0 : 2 * k;
        if (k == n - 1) {
            bvh.nodes[chain] = {rest.lo, k, rest.hi, 1};
        } else {
            bvh.nodes[chain] = {rest.lo, 2 * k + 1, rest.hi, 0};
            bvh.nodes[2 * k + 1] = {boxes[k].lo, k, boxes[k].hi, 1};
        }
    }
    for (uint32_t k = 0; k < n; ++k) bvh.primitives.push_back(k);
    return bvh;
}

std::vector<TestMesh> nasty_meshes() {
    std::vector<TestMesh> meshes;
    const TestMesh soup = random_soup(2000, 1.0f, 51);
    meshes.push_back({"empty", {}, {}});
    meshes.push_back(first(soup, 1, "one triangle"));
    meshes.push_back(first(soup, 2, "two triangles"));
    meshes.push_back(first(soup, 3, "three triangles"));
    meshes.push_back(soup);

    TestMesh concentric{"coincident centroids", {}, {}};
    for (int k = 1; k <= 2000; ++k) {
        const float s = 0.01f * k;
        concentric.add({-s, -s, -s}, {s, s, s}, {s, -s, s});
    }
    meshes.push_back(concentric);

    TestMesh copies{"20,000 copies of one triangle", {}, {}};
    copies.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    copies.corners.assign(20000, copies.corners[0]);
    meshes.push_back(copies);
    meshes.push_back(first(copies, 1500, "1,500 copies of one triangle"));

    TestMesh outlier = first(soup, 2000, "one outlier at 1e18");
    outlier.add({1e18f, 1e18f, 1e18f}, {1.1e18f, 1e18f, 1e18f}, {1e18f, 1.1e18f, 1e18f});
    meshes.push_back(outlier);

    meshes.push_back(mapped(soup, "flat in x", [](const glm::vec3& p) { return glm::vec3(3, p.y, p.z); }));
    meshes.push_back(mapped(soup, "flat in y", [](const glm::vec3& p) { return glm::vec3(p.x, 0, p.z); }));
    meshes.push_back(mapped(soup, "flat in z", [](const glm::vec3& p) { return glm::vec3(p.x, p.y, -1); }));
    meshes.push_back(mapped(soup, "on a line", [](const glm::vec3& p) { return glm::vec3(p.x, 0, 0); }));
    meshes.push_back(mapped(soup, "in one point", [](const glm::vec3&) { return glm::vec3(1, 2, 3); }));
    meshes.push_back(mapped(soup, "far away", [](const glm::vec3& p) { return p + 1e6f; }));
    meshes.push_back(mapped(soup, "tiny", [](const glm::vec3& p) { return p * 1e-15f; }));
    meshes.push_back(mapped(soup, "huge", [](const glm::vec3& p) { return p * 1e15f; }));
    meshes.push_back(mapped(soup, "as huge as floats go", [](const glm::vec3& p) { return p * 3e37f; }));
    meshes.push_back(mapped(soup, "as huge as floats go, and flat",
                            [](const glm::vec3& p) { return glm::vec3(p.x * 3e37f, p.y * 3e37f, 0.0f); }));
    meshes.push_back(mapped(soup, "long in x", [](const glm::vec3& p) { return p * glm::vec3(1e6f, 1.0f, 1e-6f); }));

    TestMesh slivers{"diagonal slivers", {}, {}};
    Rng rng(52);
    for (int k = 0; k < 2000; ++k) {
        const glm::vec3 a = random_point(rng, 1.0f), thin = random_point(rng, 1e-3f);
        slivers.add(a, a + glm::vec3(10, 10, 10), a + thin);
    }
    meshes.push_back(slivers);

    TestMesh geometric{"each twice as far as the one before", {}, {}};
    for (int k = -50; k <= 50; ++k) {
        const float s = std::ldexp(1.0f, k);
        geometric.add({s, 0, 0}, {s, 0.1f * s, 0}, {s, 0, 0.1f * s});
    }
    meshes.push_back(geometric);

    TestMesh grid{"a regular grid", {}, {}};  // Ties everywhere.
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 30; ++x) {
            const glm::vec3 p(x, y, 0);
            grid.add(p, p + glm::vec3(1, 0, 0), p + glm::vec3(1, 1, 0));
            grid.add(p, p + glm::vec3(1, 1, 0), p + glm::vec3(0, 1, 0));
        }
    }
    meshes.push_back(grid);

    TestMesh broken = soup;
    broken.name = "every fifth triangle not finite";
    for (size_t k = 0; k < broken.positions.size(); k += 15) {
        broken.positions[k + rng.below(3)][int(rng.below(3))] = k % 2 ? kNan : k % 4 ? kInf : -kInf;
    }
    meshes.push_back(broken);
    meshes.push_back(mapped(soup, "nothing finite", [](const glm::vec3&) { return glm::vec3(kNan, 0, kInf); }));
    TestMesh lonely =
        mapped(soup, "one finite triangle among broken ones", [](const glm::vec3&) { return glm::vec3(kNan); });
    lonely.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    meshes.push_back(lonely);
    return meshes;
}

namespace {

Bvh ploc(std::span<const Aabb> boxes, uint32_t search_radius) {
    PlocScratch scratch;
    return build_ploc(boxes, {.search_radius = search_radius}, {}, &scratch);
}

}  // namespace

std::vector<NamedBuilder> all_builders() {
    using Boxes = std::span<const Aabb>;
    return {
        {"sweep", [](Boxes boxes) { return build_sweep(boxes); }},
        {"sweep, leaves of one", [](Boxes boxes) { return build_sweep(boxes, {.max_leaf_size = 1, .node_cost = 0.0f}); }},
        {"sweep, costly nodes", [](Boxes boxes) { return build_sweep(boxes, {.max_leaf_size = 64, .node_cost = 10.0f}); }},
        {"binned", [](Boxes boxes) { return build_binned(boxes); }},
        {"binned, blocks of four", [](Boxes boxes) { return build_binned(boxes, {.block_size = 4, .node_cost = 0.5f}); }},
        {"binned, two bins", [](Boxes boxes) { return build_binned(boxes, {.bin_count = 2, .max_leaf_size = 1}); }},
        {"binned, 64 bins", [](Boxes boxes) { return build_binned(boxes, {.bin_count = 64, .max_leaf_size = 4}); }},
        {"over one pose", [](Boxes boxes) { return build_poses(boxes, 1); }},
        {"over three poses", [](Boxes boxes) { return over_three_poses(boxes); }},
        {"median", [](Boxes boxes) { return build_median(boxes); }},
        {"median, leaves of one", [](Boxes boxes) { return build_median(boxes, 1); }},
        {"agglomerative", [](Boxes boxes) { return build_agglomerative(boxes); }, true, true},
        {"ploc", [](Boxes boxes) { return ploc(boxes, 16); }},
        {"ploc, next neighbours", [](Boxes boxes) { return ploc(boxes, 1); }},
    };
}

bool accepts(const NamedBuilder& builder, std::span<const Aabb> boxes) {
    return !builder.needs_finite_boxes ||
           std::all_of(boxes.begin(), boxes.end(), [](const Aabb& box) { return box.is_finite() && !box.is_empty(); });
}

Blas blas_from(const Bvh& bvh, const TestMesh& mesh) {
    Blas blas;
    BlasScratch scratch;
    make_blas(bvh, mesh.positions, mesh.corners, &blas, &scratch);
    return blas;
}

Blas blas_from(const StaticBvh& bvh, const TestMesh& mesh) {
    Blas blas;
    BlasScratch scratch;
    make_blas(bvh, mesh.positions, mesh.corners, &blas, &scratch);
    return blas;
}

BlasHit brute_force(const TestMesh& mesh, const Ray& ray) {
    BlasHit best;
    best.t = ray.t_max;
    const RayFrame frame(ray);
    if (!frame.is_valid) return {};
    for (uint32_t k = 0; k < mesh.corners.size(); ++k) {
        TriangleHit hit;
        if (!intersect(frame, mesh.triangle(k), 0.0f, ray.t_min, ray.t_max, &hit)) continue;
        if (best.primitive == 0xffffffffu || hit.t < best.t) best = {hit.t, hit.u, hit.v, k};
    }
    return best.primitive == 0xffffffffu ? BlasHit{} : best;
}

BlasHit closest_hit(const Blas& blas, const Ray& ray) {
    BlasHit hit;
    hit.t = ray.t_max;
    return closest_hit(blas, RayFrame(ray), 0.0f, ray.t_min, &hit, nullptr) ? hit : BlasHit{};
}

bool any_hit(const Blas& blas, const Ray& ray) {
    return any_hit(blas, RayFrame(ray), 0.0f, ray.t_min, ray.t_max, nullptr);
}

bool is_same(const BlasHit& a, const BlasHit& b) {
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
    return bits(a.t) == bits(b.t) && bits(a.u) == bits(b.u) && bits(a.v) == bits(b.v) && a.primitive == b.primitive;
}

std::string to_string(const BlasHit& hit) {
    if (hit.primitive == 0xffffffffu) return "miss";
    return "t " + std::to_string(hit.t) + " u " + std::to_string(hit.u) + " v " + std::to_string(hit.v) + " primitive " +
           std::to_string(hit.primitive);
}

std::vector<Ray> rays_at(const TestMesh& mesh, int count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Ray> rays;
    Aabb all;
    for (const glm::vec3& p : mesh.positions) {
        if (is_finite(p)) all.extend(p);
    }
    if (all.is_empty()) all = {{-1, -1, -1}, {1, 1, 1}};
    const glm::vec3 half = 0.5f * all.hi - 0.5f * all.lo;
    for (int k = 0; k < count; ++k) {
        glm::vec3 target = all.centre();
        float near = glm::length(half) + 1e-30f;
        if (!mesh.corners.empty()) {
            const Triangle t = mesh.triangle(rng.below(static_cast<uint32_t>(mesh.corners.size())));
            const float u = rng.uniform(), v = rng.uniform() * (1.0f - u);
            const glm::vec3 inside = t.a * (1.0f - u - v) + t.b * u + t.c * v;
            const glm::vec3 edge = glm::mix(t.a, t.b, u);
            const glm::vec3 points[4] = {inside, edge, t.a, inside + (inside - edge)};
            if (is_finite(points[k % 4])) target = points[k % 4];
            const float size = glm::length(t.b - t.a);
            if (k % 8 < 4 && std::isfinite(size) && size > 0.0f) near = 4.0f * size;
        }
        Ray ray;
        if (!std::isfinite(near)) near = 1e30f;
        ray.origin = target + random_direction(rng) * (near * rng.uniform(0.1f, 2.0f));
        ray.direction = target - ray.origin;
        if (k % 16 == 9) {  // Along an axis, with zeros of either sign.
            const int axis = int(rng.below(3));
            ray.origin = target;
            ray.origin[axis] += near * random_sign(rng);
            ray.direction = glm::vec3(rng.below(2) ? 0.0f : -0.0f);
            ray.direction[axis] = target[axis] - ray.origin[axis];
        }
        if (k % 16 == 5) ray.t_max = rng.uniform();
        if (k % 16 == 6) ray.t_min = 1.0f;
        if (k % 16 == 7) ray.origin = target;  // Starts on the triangle; direction 0 hits nothing.
        rays.push_back(ray);
    }
    return rays;
}

}  // namespace zoe::test
