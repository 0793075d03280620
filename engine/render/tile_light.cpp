#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "engine/render/direction.h"
#include "engine/render/tile.h"

namespace zoe {

// Rays towards lights, from a surface that a path has met.

namespace {

glm::vec3 point_of(const Instance& instance, const Hit& hit) {
    const glm::uvec3& corner = instance.mesh->corners[hit.primitive];
    const glm::vec3 local = (1.0f - hit.u - hit.v) * instance.positions[corner.x] + hit.u * instance.positions[corner.y] +
                            hit.v * instance.positions[corner.z];
    return instance.world_from_local.point(local);
}

/// From a ray's origin, a light may turn out to be on the surface's other side: the surface itself is in the way.
/// normal     of the surface that the ray leaves.
/// toward     the light, from the surface.
bool is_behind(const glm::vec3& normal, const glm::vec3& toward, const Ray& ray) {
    return (glm::dot(normal, ray.direction) > 0.0f) != (glm::dot(normal, toward) > 0.0f);
}

}  // namespace

/// The weight of what a ray towards a light brings.
/// other      the density by which a bounce finds it.
float TileTracer::weight_of_light(float density, float other) const {
    const LightSearch search = pass_->config.search;
    if (search == LightSearch::kBoth) return weight_of(density, other);
    return search == LightSearch::kLights || !(other > 0.0f) ? 1.0f : 0.0f;
}

/// The weight of what a bounce brings.
/// other      the density by which a ray towards a light finds it.
float TileTracer::weight_of_bounce(float density, float other) const {
    const LightSearch search = pass_->config.search;
    if (search == LightSearch::kBoth) return weight_of(density, other);
    return search == LightSearch::kBounces || !(other > 0.0f) ? 1.0f : 0.0f;
}

void TileTracer::add_sun(const Surface& surface, const Hit& hit, const Bsdf& bsdf, uint32_t path_index, uint32_t bounce) {
    const Sun& sun = pass_->lighting.sun;
    if (sun.is_dark()) return;
    const glm::vec3 toward = sun.sample(uniform_2d(paths_[path_index].key, dimension(Use::kSun, bounce)));
    const glm::vec3 value = bsdf.evaluate_sharp(toward);
    if (!(largest(value) > 0.0f)) return;
    const std::optional<glm::vec3> origin = leave_smoothly(pass_->tlas, hit, surface, toward);
    if (!origin) return;
    const float weight = is_last(bounce) ? 1.0f : weight_of_light(sun.density(), bsdf.evaluate(toward).density);
    add_shadow({.origin = *origin, .direction = toward}, path_index, sun.irradiance() * value * weight);
}

/// Looks for light of an environment where it is bright. Only where a bounce may find it, too.
void TileTracer::add_environment(const Surface& surface, const Bsdf& bsdf, uint32_t path_index, uint32_t bounce) {
    const Environment* const environment = pass_->lighting.environment;
    if (environment == nullptr || is_last(bounce)) return;
    const glm::vec3 toward = environment->sample(uniform_2d(paths_[path_index].key, dimension(Use::kSky, bounce)));
    const float density = environment->density(toward);
    const Bsdf::Value scattered = bsdf.evaluate(toward);
    if (!(density > 0.0f) || !(largest(scattered.value) > 0.0f)) return;
    const float weight = weight_of_light(density, scattered.density) / density;
    add_shadow({.origin = leave(surface, toward), .direction = toward}, path_index,
               pass_->lighting.sky(toward) * scattered.value * weight);
}

/// Picks one light with a probability proportional to what it would bring unshadowed: a single light brings its exact
/// value, and many cost one ray.
void TileTracer::add_punctual_light(const Surface& surface, const Hit& hit, const Bsdf& bsdf, uint32_t path_index,
                                    uint32_t bounce) {
    offers_.clear();
    float total = 0.0f;
    for (const PunctualLight& light : pass_->lighting.lights) {
        const Illumination at = illuminate(light, surface.position);
        if (at.irradiance == glm::vec3(0.0f)) continue;
        const glm::vec3 radiance = at.irradiance * bsdf.evaluate_sharp(at.toward);
        const float weight = largest(radiance);
        total += weight;
        if (weight > 0.0f) offers_.push_back({&light, at.toward, radiance, weight});
    }
    if (!(total > 0.0f) || !std::isfinite(total)) return;

    float left = total * uniform_1d(paths_[path_index].key, dimension(Use::kLight, bounce));
    const Offer* chosen = nullptr;
    for (const Offer& offer : offers_) {
        chosen = &offer;  // The last stands in for what rounding leaves over.
        left -= offer.weight;
        if (left < 0.0f) break;
    }
    const std::optional<glm::vec3> origin = leave_smoothly(pass_->tlas, hit, surface, chosen->toward);
    if (!origin) return;
    Ray ray{.origin = *origin, .direction = chosen->toward};
    if (chosen->light->kind != LightKind::kDirectional) {
        ray.direction = chosen->light->position - ray.origin;
        ray.t_max = 1.0f - 0x1p-20f;  // What holds the light at its very place does not shade it.
        const glm::vec3& normal = is_turned_away(surface, chosen->toward) ? surface.smooth : surface.ng;
        if (is_behind(normal, chosen->toward, ray)) return;
    }
    add_shadow(ray, path_index, chosen->radiance * (total / chosen->weight));
}

/// Looks for light of an emissive surface. Only where a bounce may find it, too, so that both ways see as far.
void TileTracer::add_glow(const Surface& surface, const Bsdf& bsdf, uint32_t path_index, uint32_t bounce) {
    if (pass_->glow.is_dark() || is_last(bounce)) return;
    const SampleKey& key = paths_[path_index].key;
    const Hit place = pass_->glow.sample(uniform_1d(key, dimension(Use::kGlow, bounce)),
                                         uniform_2d(key, dimension(Use::kGlowPlace, bounce)));
    // The surface's front or back is told by the direction from here: a rough one will do for that.
    const glm::vec3 rough = point_of(pass_->tlas[place.node], place) - surface.position;
    const glm::vec3 toward = unit_or(rough, glm::vec3(0.0f));
    const Bsdf::Value scattered = bsdf.evaluate(toward);
    if (!(largest(scattered.value) > 0.0f)) return;
    const Surface lamp =
        surface_at(pass_->scene, pass_->tlas, {.origin = surface.position, .direction = toward}, place, {}, Detail::kLight);
    const float density = density_seen(lamp, surface.position, toward);
    if (!(density > 0.0f) || !std::isfinite(density)) return;
    Ray ray{.origin = leave(surface, toward)};
    ray.direction = leave(lamp, -toward) - ray.origin;
    ray.t_max = 1.0f;
    const glm::vec3 radiance = lamp.emission * lamp.opacity * scattered.value;
    if (is_behind(surface.ng, toward, ray)) return;
    add_shadow(ray, path_index, radiance * (weight_of_light(density, scattered.density) / density), Toward::kSurface);
}

/// The weight of light that a path meets on a surface, which `add_glow` may have found before.
float TileTracer::glow_weight(const Surface& surface, const Ray& ray, const Path& path) const {
    if (!(path.density > 0.0f) || surface.emission == glm::vec3(0.0f)) return 1.0f;
    const float density = density_seen(surface, path.from, ray.direction);
    return std::isfinite(density) ? weight_of_bounce(path.density, density) : 0.0f;
}

/// The density of `add_glow`, per steradian, for the direction in which a point sees a glowing surface.
float TileTracer::density_seen(const Surface& lamp, const glm::vec3& from, const glm::vec3& toward) const {
    const glm::vec3 apart = lamp.position - from;
    return pass_->glow.density(lamp.material) * glm::dot(apart, apart) / std::abs(glm::dot(lamp.ng, toward));
}

void TileTracer::add_shadow(const Ray& ray, uint32_t path_index, const glm::vec3& radiance, Toward toward) {
    if (!(largest(radiance) > 0.0f)) return;
    shadows_.push(ray, path_index, paths_[path_index].throughput * radiance, toward);
}

}  // namespace zoe
