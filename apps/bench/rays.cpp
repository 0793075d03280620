#include "apps/bench/rays.h"

#include <algorithm>

#include "engine/math/parallel.h"
#include "engine/render/bsdf.h"
#include "engine/render/sampler.h"
#include "engine/render/surface.h"

namespace zoe {
namespace {

constexpr int kBlock = 4;
constexpr uint64_t kDirection = 0, kLightPoint = 1;  // dimensions of random numbers, two a ray kind

// Two uniform numbers for a ray of a batch.
glm::vec2 random_2d(size_t ray, RayKind kind, uint64_t use) {
    return uniform_2d({.pixel = static_cast<uint32_t>(ray), .sample = 0}, 2 * static_cast<uint64_t>(kind) + use);
}

// Appends `make(ray_index)` for every hit, in order.
template <typename Make>
void add_at_hits(std::span<const Hit> hits, std::vector<Ray>* made, Make&& make) {
    static thread_local std::vector<uint32_t> ray_of_hit;
    ray_of_hit.clear();
    for (size_t k = 0; k < hits.size(); ++k) {
        if (hits[k]) ray_of_hit.push_back(static_cast<uint32_t>(k));
    }
    const size_t first = made->size();
    made->resize(first + ray_of_hit.size());
    const std::span<const uint32_t> rays = ray_of_hit;  // the vector is another one in each thread
    parallel_for(0, rays.size(), kRaysATask, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) (*made)[first + k] = make(rays[k]);
    });
}

}  // namespace

void make_primary_rays(const View& view, int width, int height, std::vector<Ray>* rays) {
    rays->resize(static_cast<size_t>(width) * static_cast<size_t>(height));
    size_t at = 0;
    for (int block_y = 0; block_y < height; block_y += kBlock) {
        for (int block_x = 0; block_x < width; block_x += kBlock) {
            for (int y = block_y; y < std::min(block_y + kBlock, height); ++y) {
                for (int x = block_x; x < std::min(block_x + kBlock, width); ++x) {
                    (*rays)[at++] = camera_ray(view, float(x) + 0.5f, float(y) + 0.5f, width, height);
                }
            }
        }
    }
}

void add_diffuse_rays(const Scene& scene, const Tlas& tlas, std::span<const Ray> rays, std::span<const Hit> hits,
                      std::vector<Ray>* diffuse_rays) {
    add_at_hits(hits, diffuse_rays, [&](uint32_t k) {
        const Surface surface = surface_at(scene, tlas, rays[k], hits[k]);
        const glm::vec3 direction = sample_diffuse(surface.ng, surface.ng, random_2d(k, RayKind::kDiffuse, kDirection));
        return Ray{.origin = leave(surface, direction), .direction = direction};
    });
}

void add_shadow_rays(const Scene& scene, const Tlas& tlas, std::span<const Ray> rays, std::span<const Hit> hits,
                     RayKind kind, std::vector<Ray>* shadow_rays) {
    const Aabb box = tlas.bounds();
    const glm::vec3 size = box.extent();
    add_at_hits(hits, shadow_rays, [&](uint32_t k) {
        const Surface surface = surface_at(scene, tlas, rays[k], hits[k]);
        const glm::vec2 u = random_2d(k, kind, kLightPoint) - 0.5f;
        const glm::vec3 light = box.centre() + glm::vec3(0.25f * u.x * size.x, 0.45f * size.y, 0.25f * u.y * size.z);
        const glm::vec3 origin = leave(surface, light - surface.position);
        return Ray{.origin = origin, .direction = light - origin, .t_max = 1.0f};
    });
}

}  // namespace zoe
