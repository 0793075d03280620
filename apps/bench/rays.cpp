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

Ray diffuse_ray(const Surface& surface, const glm::vec2& u) {
    const glm::vec3 direction = sample_cosine(surface.ng, u);
    return {.origin = leave(surface, direction), .direction = direction};
}

Ray shadow_ray(const Surface& surface, const Aabb& box, const glm::vec2& u) {
    const glm::vec3 size = box.extent();
    const glm::vec3 light =
        box.centre() + glm::vec3(0.25f * (u.x - 0.5f) * size.x, 0.45f * size.y, 0.25f * (u.y - 0.5f) * size.z);
    const glm::vec3 origin = leave(surface, light - surface.position);
    return {.origin = origin, .direction = light - origin, .t_max = 1.0f};
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

void add_rays_at_hits(const Scene& scene, const Tlas& tlas, std::span<const Ray> rays, std::span<const Hit> hits,
                      RayKind kind, std::vector<Ray>* diffuse_rays, std::vector<Ray>* shadow_rays) {
    std::vector<uint32_t> ray_of_hit;
    for (size_t k = 0; k < hits.size(); ++k) {
        if (hits[k]) ray_of_hit.push_back(static_cast<uint32_t>(k));
    }
    const size_t first_diffuse = diffuse_rays ? diffuse_rays->size() : 0, first_shadow = shadow_rays->size();
    if (diffuse_rays) diffuse_rays->resize(first_diffuse + ray_of_hit.size());
    shadow_rays->resize(first_shadow + ray_of_hit.size());
    const Aabb box = tlas.bounds();
    parallel_for(0, ray_of_hit.size(), kRaysATask, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
            const uint32_t ray = ray_of_hit[k];
            const Surface surface = surface_at(scene, tlas, rays[ray], hits[ray]);
            if (diffuse_rays) (*diffuse_rays)[first_diffuse + k] = diffuse_ray(surface, random_2d(ray, kind, kDirection));
            (*shadow_rays)[first_shadow + k] = shadow_ray(surface, box, random_2d(ray, kind, kLightPoint));
        }
    });
}

}  // namespace zoe
