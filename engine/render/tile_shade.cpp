#include <algorithm>
#include <cmath>

#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "engine/render/direction.h"
#include "engine/render/guides.h"
#include "engine/render/inspect.h"
#include "engine/render/tile.h"

namespace zoe {

namespace {

constexpr uint32_t kRouletteFromBounce = 2;
/// What a bounce widens a path's cone by, of the angle that its direction stands for: samples of a pixel share that angle.
constexpr float kBounceSpread = 1.0f / 16.0f;
/// Triangles lie all over the memory: those of later hits are fetched while one is shaded, corners first.
constexpr size_t kCornersAhead = 8, kVerticesAhead = 4;

void fetch_corners(const Tlas& tlas, const Hit& hit) {
    if (hit) __builtin_prefetch(&tlas[hit.node].mesh->corners[hit.primitive]);
}

void fetch_vertices(const Tlas& tlas, const Hit& hit) {
    if (!hit) return;
    const Instance& instance = tlas[hit.node];
    const uint32_t vertex = instance.mesh->corners[hit.primitive].x;  // the others are near it, as a rule
    __builtin_prefetch(&instance.positions[vertex]);
    if (!instance.normals.empty()) __builtin_prefetch(&instance.normals[vertex]);
}

}  // namespace

void TileTracer::shade_hits(uint32_t bounce, uint32_t pass_through) {
    for (size_t i = 0; i < current_.rays.size(); ++i) {
        const Ray& ray = current_.rays[i];
        const uint32_t path_index = current_.paths[i];
        if (i + kCornersAhead < hits_.size()) fetch_corners(pass_->tlas, hits_[i + kCornersAhead]);
        if (i + kVerticesAhead < hits_.size()) fetch_vertices(pass_->tlas, hits_[i + kVerticesAhead]);
        if (!hits_[i]) {
            if (pass_through == 0 || bounce == 0) add_sky(ray, path_index, bounce);
            continue;
        }
        const Surface surface = surface_at(pass_->scene, pass_->tlas, ray, hits_[i], paths_[path_index].cone);
        if (pass_through == 0 && bounce > 0) add_sky_behind(surface, ray, path_index);
        if (pass_straight(surface, ray, path_index, bounce, pass_through)) {
            Path& path = paths_[path_index];
            path.cone.width += path.cone.spread * hits_[i].t;
            passing_.push({.origin = leave(surface, ray.direction), .direction = ray.direction}, path_index);
        } else {
            shade_hit(surface, ray, hits_[i], path_index, bounce);
        }
    }
}

/// Decides by chance whether a path goes straight through a surface, and weighs it so that the mean is right.
bool TileTracer::pass_straight(const Surface& surface, const Ray& ray, uint32_t path_index, uint32_t bounce,
                               uint32_t pass_through) {
    const glm::vec3 through_sheet = surface.opacity * passes_straight(surface, -ray.direction);
    const glm::vec3 passes = (1.0f - surface.opacity) + through_sheet;
    const float chance = std::min(largest(passes), 1.0f);
    if (!(chance > 0.0f)) return false;
    Path& path = paths_[path_index];
    const bool does_pass = uniform_1d(path.key, dimension(Use::kAlpha, bounce, pass_through)) >= 1.0f - chance;
    if (through_sheet == glm::vec3(0.0f)) return does_pass;
    path.throughput *= does_pass ? passes / chance : glm::vec3(surface.opacity / (1.0f - chance));
    return does_pass;
}

void TileTracer::shade_hit(const Surface& surface, const Ray& ray, const Hit& hit, uint32_t path_index, uint32_t bounce) {
    Path& path = paths_[path_index];
    if (bounce == 0) {
        path.coverage = 1.0f;
        if (pass_->config.shade != Shade::kPath) {
            path.radiance = inspect(pass_->config.shade, surface, pass_->tlas[hit.node].motion, -ray.direction);
            return;
        }
    }
    if (surface.is_body() && surface.is_inside) path.throughput *= glm::exp(-hit.t * surface.absorption);
    path.radiance += path.throughput * surface.emission * glow_weight(surface, ray, path);
    if (surface.is_unlit) path.radiance += path.throughput * surface.base_color;
    if (bounce == 0 && path.is_first && pass_->guides != nullptr) {
        pass_->guides->see_surface(path.pixel, pass_->tlas, pass_->view, hit, surface, path.radiance);
    }
    if (surface.is_unlit || !pass_->config.is_lit) return;
    const Bsdf bsdf(surface, -ray.direction);
    if (bsdf.is_black()) return;
    add_sun(surface, hit, bsdf, path_index, bounce);
    add_environment(surface, bsdf, path_index, bounce);
    add_punctual_light(surface, hit, bsdf, path_index, bounce);
    add_glow(surface, bsdf, path_index, bounce);
    if (!is_last(bounce)) bounce_on(surface, bsdf, hit.t, path_index, bounce);
}

/// Sky and sun in the direction of a path that leaves the scene. Where shadow rays look for them, too, both ways share.
/// What falls through a body onto a surface brings no sun: its disc is too small to be found that way.
glm::vec3 TileTracer::sky_seen(const Path& path, const glm::vec3& direction) const {
    const Lighting& lighting = pass_->lighting;
    glm::vec3 sky = lighting.sky(direction);
    const glm::vec3 sun = lighting.sun.radiance(direction);
    if (lighting.environment != nullptr && path.density > 0.0f) {
        sky *= weight_of_bounce(path.density, lighting.environment->density(direction));
    }
    if (sun == glm::vec3(0.0f)) return sky;
    if (path.density > 0.0f) return sky + sun * weight_of_bounce(path.density, lighting.sun.density());
    return path.is_scattered ? sky : sky + sun;
}

void TileTracer::add_sky(const Ray& ray, uint32_t path_index, uint32_t bounce) {
    if (pass_->config.shade != Shade::kPath) return;
    Path& path = paths_[path_index];
    path.radiance += path.throughput * sky_seen(path, ray.direction);
    if (bounce == 0 && path.is_first && pass_->guides != nullptr) pass_->guides->see_sky(path.pixel, path.radiance);
}

/// Sky light from the direction of a bounce may pass what the bounce itself ends at, and stop where the bounce goes on. It
/// is told apart at the first surface that both meet: from there on a shadow ray brings it, and the bounce surfaces only.
void TileTracer::add_sky_behind(const Surface& surface, const Ray& ray, uint32_t path_index) {
    const Path& path = paths_[path_index];
    const glm::vec3 passes = passing_share(surface, surface.light_opacity, -ray.direction);
    if (passes == glm::vec3(0.0f)) return;
    const glm::vec3 radiance = passes * sky_seen(path, ray.direction);
    if (radiance == glm::vec3(0.0f)) return;
    shadows_.push({.origin = leave(surface, ray.direction), .direction = ray.direction}, path_index,
                  path.throughput * radiance, Toward::kLight);
}

void TileTracer::bounce_on(const Surface& surface, const Bsdf& bsdf, float distance, uint32_t path_index, uint32_t bounce) {
    Path& path = paths_[path_index];
    const glm::vec2 u = uniform_2d(path.key, dimension(Use::kDirection, bounce));
    const std::optional<Bsdf::Sample> sample = bsdf.sample(u, uniform_1d(path.key, dimension(Use::kLobe, bounce)));
    if (!sample) return;
    path.throughput *= sample->weight;
    const float brightest = largest(path.throughput);
    if (!(brightest > 0.0f)) return;
    if (bounce >= kRouletteFromBounce) {
        // Dim paths end early; those that go on carry the light of those that did not.
        const float survival = std::min(1.0f, brightest);
        if (uniform_1d(path.key, dimension(Use::kRoulette, bounce)) >= survival) return;
        path.throughput /= survival;
    }
    path.density = sample->density;
    path.from = surface.position;
    path.is_scattered |= sample->density > 0.0f;
    path.cone.width += path.cone.spread * distance;
    path.cone.spread += kBounceSpread * sample->spread;
    next_.push({.origin = leave(surface, sample->direction), .direction = sample->direction}, path_index);
}

}  // namespace zoe
