#include <cmath>

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

}  // namespace

void TileTracer::add_sun(const Surface& surface, const Bsdf& bsdf, uint32_t path_index, uint32_t bounce) {
    const glm::vec3& irradiance = pass_->lighting.sun_irradiance;
    if (irradiance == glm::vec3(0.0f)) return;
    const glm::vec3 toward = sample_sun(uniform_2d(paths_[path_index].key, dimension(Use::kSun, bounce)));
    const Bsdf::Value scattered = bsdf.evaluate(toward);
    const float weight = is_last(bounce) ? 1.0f : weight_of(sun_density(), scattered.density);
    add_shadow(surface, {.origin = leave(surface, toward), .direction = toward}, path_index,
               irradiance * scattered.value * (weight * past_terminator(surface, toward)));
}

/// Looks for light of an environment where it is bright. Only where a bounce may find it, too.
void TileTracer::add_environment(const Surface& surface, const Bsdf& bsdf, uint32_t path_index, uint32_t bounce) {
    const Environment* const environment = pass_->lighting.environment;
    if (environment == nullptr || is_last(bounce)) return;
    const glm::vec3 toward = environment->sample(uniform_2d(paths_[path_index].key, dimension(Use::kSky, bounce)));
    const float density = environment->density(toward);
    const Bsdf::Value scattered = bsdf.evaluate(toward);
    if (!(density > 0.0f) || !(largest(scattered.value) > 0.0f)) return;
    const float weight = weight_of(density, scattered.density) / density;
    add_shadow(surface, {.origin = leave(surface, toward), .direction = toward}, path_index,
               pass_->lighting.sky(toward) * scattered.value * weight);
}

/// Picks one light with a probability proportional to what it would bring unshadowed: a single light brings its exact
/// value, and many cost one ray.
void TileTracer::add_punctual_light(const Surface& surface, const Bsdf& bsdf, uint32_t path_index, uint32_t bounce) {
    const auto& lights = pass_->lighting.lights;
    const auto brings = [&](const PunctualLight& light, glm::vec3* toward) {
        const Illumination at = illuminate(light, surface.position);
        *toward = at.toward;
        return at.irradiance == glm::vec3(0.0f)
                   ? glm::vec3(0.0f)
                   : at.irradiance * bsdf.evaluate(at.toward).value * past_terminator(surface, at.toward);
    };
    glm::vec3 toward;
    float total = 0.0f;
    for (const PunctualLight& light : lights) total += largest(brings(light, &toward));
    if (!(total > 0.0f) || !std::isfinite(total)) return;

    float left = total * uniform_1d(paths_[path_index].key, dimension(Use::kLight, bounce));
    const PunctualLight* chosen = nullptr;
    for (const PunctualLight& light : lights) {
        const float weight = largest(brings(light, &toward));
        if (!(weight > 0.0f)) continue;
        chosen = &light;  // The last that brings anything stands in for what rounding leaves over.
        left -= weight;
        if (left < 0.0f) break;
    }
    const glm::vec3 radiance = brings(*chosen, &toward);
    Ray ray{.origin = leave(surface, toward), .direction = toward};
    if (chosen->kind != LightKind::kDirectional) {
        ray.direction = chosen->position - ray.origin;
        ray.t_max = 1.0f - 0x1p-20f;  // What holds the light at its very place does not shade it.
    }
    add_shadow(surface, ray, path_index, radiance * (total / largest(radiance)));
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
    const Surface lamp = surface_at(pass_->scene, pass_->tlas, {.origin = surface.position, .direction = toward}, place);
    const float density = density_seen(lamp, surface.position, toward);
    if (!(density > 0.0f) || !std::isfinite(density)) return;
    Ray ray{.origin = leave(surface, toward)};
    ray.direction = leave(lamp, -toward) - ray.origin;
    ray.t_max = 1.0f;
    const glm::vec3 radiance = lamp.emission * lamp.opacity * scattered.value;
    add_shadow(surface, ray, path_index, radiance * (weight_of(density, scattered.density) / density), Toward::kSurface);
}

/// The weight of light that a path meets on a surface, which `add_glow` may have found before.
float TileTracer::glow_weight(const Surface& surface, const Ray& ray, const Path& path) const {
    if (!(path.density > 0.0f) || surface.emission == glm::vec3(0.0f)) return 1.0f;
    const float density = density_seen(surface, path.from, ray.direction);
    return std::isfinite(density) ? weight_of(path.density, density) : 0.0f;
}

/// The density of `add_glow`, per steradian, for the direction in which a point sees a glowing surface.
float TileTracer::density_seen(const Surface& lamp, const glm::vec3& from, const glm::vec3& toward) const {
    const glm::vec3 apart = lamp.position - from;
    return pass_->glow.density(lamp.material) * glm::dot(apart, apart) / std::abs(glm::dot(lamp.ng, toward));
}

void TileTracer::add_shadow(const Surface& surface, const Ray& ray, uint32_t path_index, const glm::vec3& radiance,
                            Toward toward) {
    // Beyond the offset the light may turn out to be on the other side: then the surface itself is in the way.
    if (!(largest(radiance) > 0.0f) || !(glm::dot(surface.ng, ray.direction) > 0.0f)) return;
    shadows_.push(ray, path_index, paths_[path_index].throughput * radiance, toward);
}

}  // namespace zoe
