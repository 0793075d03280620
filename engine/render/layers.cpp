#include "engine/render/layers.h"

#include <glm/geometric.hpp>

#include "engine/math/parallel.h"
#include "engine/render/surface.h"

namespace zoe {

namespace {

constexpr size_t kRowGrain = 8;

// The node of each instance shows a mesh with these triangles.
void note_shown(const Scene& scene, const Tlas& tlas, std::vector<Layers::Shown>* shown) {
    shown->assign(scene.nodes.size(), {});
    for (const Instance& instance : tlas.instances) (*shown)[index(instance.node)] = {instance.mesh, instance.mesh->version};
}

// Where a point of a triangle was; false where there was no such triangle.
bool find_point(const Hit& hit, const Layers::Shown& shown, const Tlas& then, glm::vec3* point) {
    if (then.instance_of_node[index(hit.node)] == kNoInstance) return false;
    const Instance& instance = then[hit.node];
    if (instance.mesh != shown.mesh || instance.mesh->version != shown.version) return false;
    const glm::uvec3& corners = instance.mesh->corners[hit.primitive];
    const glm::vec3 &a = instance.positions[corners.x], &b = instance.positions[corners.y],
                    &c = instance.positions[corners.z];
    *point = instance.world_from_local.point((1.0f - hit.u - hit.v) * a + hit.u * b + hit.v * c);
    return true;
}

}  // namespace

void see_layers(const Scene& scene, const Tlas& tlas, const View& view, int width, int height, Layers* layers) {
    const RayBatch batch(tlas.watch.get());
    const size_t row = static_cast<size_t>(width), pixel_count = row * static_cast<size_t>(height);
    layers->width = width;
    layers->height = height;
    layers->hits.resize(pixel_count);
    layers->albedo.resize(pixel_count);
    layers->normal.resize(pixel_count);
    layers->points.resize(pixel_count);
    layers->motion.assign(pixel_count, glm::vec2(0.0f));
    note_shown(scene, tlas, &layers->shown);
    parallel_for(0, static_cast<size_t>(height), kRowGrain, [&](size_t begin, size_t end) {
        thread_local std::vector<Ray> rays;
        rays.clear();
        for (size_t k = begin * row; k < end * row; ++k) {
            rays.push_back(
                camera_ray(view, static_cast<float>(k % row) + 0.5f, static_cast<float>(k / row) + 0.5f, width, height));
        }
        const std::span<Hit> hits = std::span(layers->hits).subspan(begin * row, rays.size());
        closest_hits(tlas, rays, hits);
        for (size_t i = 0; i < rays.size(); ++i) {
            const size_t k = begin * row + i;
            layers->albedo[k] = layers->normal[k] = glm::vec3(0.0f);
            layers->points[k] = rays[i].direction;
            if (!hits[i]) continue;
            const Surface surface = surface_at(scene, tlas, rays[i], hits[i]);
            layers->albedo[k] = surface.base_color;
            layers->normal[k] = surface.ns;
            find_point(hits[i], layers->shown[index(hits[i].node)], tlas, &layers->points[k]);
        }
    });
}

void add_motion(const View& view, const Tlas& then, const View& view_then, Layers* layers) {
    const size_t row = static_cast<size_t>(layers->width);
    parallel_for(0, layers->hits.size(), kRowGrain * row, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            const Hit& hit = layers->hits[k];
            const glm::vec3 point = layers->points[k];
            glm::vec3 before = point;
            glm::vec2 at, was_at;
            if (hit) find_point(hit, layers->shown[index(hit.node)], then, &before);
            layers->motion[k] = glm::vec2(0.0f);
            if (!project(view, hit ? point - view.origin : point, !hit, layers->width, layers->height, &at)) continue;
            if (!project(view_then, hit ? before - view_then.origin : before, !hit, layers->width, layers->height, &was_at))
                continue;
            layers->motion[k] = {at.x - was_at.x, was_at.y - at.y};
        }
    });
}

}  // namespace zoe
