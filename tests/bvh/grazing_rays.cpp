#include "tests/bvh/grazing_rays.h"

#include <glm/geometric.hpp>

#include "engine/bvh/build_sweep.h"
#include "engine/bvh/clip.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

TestMesh crossing_triangles(int triangle_count, uint64_t seed) {
    TestMesh mesh{"crossing triangles", {}, {}};
    Rng rng(seed);
    for (int k = 0; k < triangle_count; ++k) {
        glm::vec3 a = random_point(rng, 10.0f), b = random_point(rng, 10.0f), c = random_point(rng, 10.0f);
        switch (rng.below(6)) {
            case 0:  // A needle.
                c = glm::mix(a, b, rng.uniform()) + random_point(rng, log_uniform(rng, 1e-5, 1.0));
                break;
            case 1: {  // In a plane of integer distance along an axis: several share it.
                const int axis = int(rng.below(3));
                a[axis] = b[axis] = c[axis] = static_cast<float>(rng.below(5)) - 2.0f;
                break;
            }
            case 2:  // Hung on an edge of another.
                if (mesh.positions.size() < 3) break;
                a = mesh.positions[mesh.positions.size() - 2];
                b = mesh.positions[mesh.positions.size() - 1];
                break;
            case 3:  // Small.
                b = a + random_point(rng, 0.3f);
                c = a + random_point(rng, 0.3f);
                break;
            default:
                break;
        }
        mesh.add(a, b, c);
    }
    return mesh;
}

StaticBvh tree_of_pieces(const TestMesh& mesh, int cuts_a_triangle, uint64_t seed) {
    Rng rng(seed);
    std::vector<Aabb> boxes;
    std::vector<uint32_t> primitive_of_box;
    for (uint32_t primitive = 0; primitive < mesh.corners.size(); ++primitive) {
        const Triangle triangle = mesh.triangle(primitive);
        std::vector<Aabb> pieces{bounds(triangle)};
        for (int k = 0; k < cuts_a_triangle; ++k) {
            Aabb& piece = pieces[rng.below(static_cast<uint32_t>(pieces.size()))];
            const int axis = int(rng.below(3));
            const float plane = glm::mix(piece.lo[axis], piece.hi[axis], rng.uniform());
            if (!(piece.lo[axis] < plane && plane < piece.hi[axis])) continue;
            const ClippedBoxes cut = split_box(triangle, piece, axis, plane);
            if (cut.left.is_empty() && cut.right.is_empty()) continue;
            piece = cut.left.is_empty() ? cut.right : cut.left;
            if (!cut.left.is_empty() && !cut.right.is_empty()) pieces.push_back(cut.right);
        }
        for (const Aabb& piece : pieces) {
            boxes.push_back(padded(piece, triangle));
            primitive_of_box.push_back(primitive);
        }
    }
    StaticBvh bvh{build_sweep(boxes, {.max_leaf_size = 1, .node_cost = 0.0f}), static_cast<uint32_t>(mesh.corners.size())};
    for (uint32_t& primitive : bvh.tree.primitives) primitive = primitive_of_box[primitive];
    return bvh;
}

std::vector<Ray> grazing_rays(const TestMesh& mesh, int count, uint64_t seed) {
    Rng rng(seed);
    std::vector<Ray> rays;
    for (int k = 0; k < count; ++k) {
        const Triangle t = mesh.triangle(rng.below(static_cast<uint32_t>(mesh.corners.size())));
        const auto on_plane = [&](float u, float v) { return t.a + u * (t.b - t.a) + v * (t.c - t.a); };
        const float u = rng.uniform(), v = rng.uniform() * (1.0f - u);
        glm::vec3 target = on_plane(u, v);
        if (rng.below(4) == 0) target = on_plane(u, 0.0f);
        if (rng.below(8) == 0) target = t.c;
        Ray ray;
        switch (rng.below(6)) {
            case 0:
            case 1:
                ray.origin = on_plane(rng.uniform(-3.0f, 4.0f), rng.uniform(-3.0f, 4.0f));
                break;
            case 2:
                ray.origin = on_plane(rng.uniform(-3.0f, 4.0f), rng.uniform(-3.0f, 4.0f)) +
                             random_point(rng, log_uniform(rng, 1e-6, 1e-3));
                break;
            case 3:
                ray.origin = random_direction(rng) * log_uniform(rng, 10.0, 1e6);
                break;
            case 4:
                ray.origin = on_plane(rng.uniform(), rng.uniform() * 0.5f);
                break;
            default:
                ray.origin = random_point(rng, 12.0f);
                break;
        }
        ray.direction = target - ray.origin;
        if (rng.below(4) == 0) ray.direction *= log_uniform(rng, 1e-6, 1e6);
        if (rng.below(8) == 0) {
            const int axis = int(rng.below(3));
            ray.direction = glm::vec3(rng.below(2) ? 0.0f : -0.0f);
            ray.direction[axis] = random_sign(rng);
            ray.origin = target;
            ray.origin[axis] += 30.0f * rng.uniform(-1.0f, 1.0f);
        }
        if (rng.below(16) == 0) ray.t_max = rng.uniform(0.0f, 2.0f);
        rays.push_back(ray);
    }
    return rays;
}

}  // namespace zoe::test
