#include "engine/render/tile.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "engine/render/bsdf.h"
#include "engine/render/direction.h"
#include "engine/render/inspect.h"

namespace zoe {

namespace {

constexpr uint32_t kMaxPassThrough = 1024;  // see-through surfaces in a row; what lies behind so many is taken as dark
constexpr uint32_t kShadowHash = 0x80000000u;
constexpr uint32_t kRouletteFromBounce = 2;

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Tells apart the rays of a frame: `which` counts bounces, and see-through surfaces within them.
uint64_t hash_key(const SampleKey& key, uint64_t which) {
    return mix_bits(mix_bits(static_cast<uint64_t>(key.pixel) << 32 | key.sample) + which);
}

uint64_t ray_number(uint32_t bounce, uint32_t pass_through) {
    return static_cast<uint64_t>(bounce) << 16 | pass_through;
}

}  // namespace

void TileTracer::Rays::clear() {
    rays.clear();
    paths.clear();
}

void TileTracer::Rays::push(const Ray& ray, uint32_t path) {
    rays.push_back(ray);
    paths.push_back(path);
}

void TileTracer::Shadows::clear() {
    Rays::clear();
    radiance.clear();
}

void TileTracer::Shadows::push(const Ray& ray, uint32_t path, const glm::vec3& brings) {
    Rays::push(ray, path);
    radiance.push_back(brings);
}

bool TileTracer::trace(const Pass& pass, const Tile& tile, Film* film, TileStats* stats) {
    pass_ = &pass;
    film_ = film;
    stats_ = stats;
    for (int i = 0; i < pass.sample_count; ++i) {
        if (pass.config.cancel != nullptr && pass.config.cancel->load(std::memory_order_relaxed)) return false;
        start_paths(tile, static_cast<uint32_t>(pass.first_sample + i));
        if (pass.config.shade == Shade::kCost) {
            trace_cost();
        } else {
            const bool is_lit = pass.config.shade == Shade::kPath;
            const uint32_t last_bounce = is_lit ? static_cast<uint32_t>(pass.config.max_bounces) : 0;
            for (uint32_t bounce = 0; bounce <= last_bounce && !current_.rays.empty(); ++bounce) trace_bounce(bounce);
        }
        for (const Path& path : paths_) film->sum[path.pixel] += glm::vec4(path.radiance, path.coverage);
    }
    return true;
}

/// The camera's ray through a point of a pixel; (0, 0) is its top left.
Ray TileTracer::pixel_ray(size_t pixel, const glm::vec2& within) const {
    const size_t width = static_cast<size_t>(film_->width);
    return camera_ray(pass_->view, static_cast<float>(pixel % width) + within.x,
                      static_cast<float>(pixel / width) + within.y, film_->width, film_->height);
}

/// The first sample goes through pixel centres: the layers are its.
void TileTracer::start_paths(const Tile& tile, uint32_t sample) {
    paths_.clear();
    current_.clear();
    for (int y = tile.y_begin; y < tile.y_end; ++y) {
        for (int x = tile.x_begin; x < tile.x_end; ++x) {
            const uint32_t pixel = static_cast<uint32_t>(y) * static_cast<uint32_t>(film_->width) + static_cast<uint32_t>(x);
            const SampleKey key{pixel, sample};
            glm::vec2 within(0.5f);
            if (pass_->config.is_jittered && sample > 0) within = uniform_2d(key, dimension(Use::kPixel, 0));
            current_.push(pixel_ray(pixel, within), static_cast<uint32_t>(paths_.size()));
            paths_.push_back({.key = key, .pixel = pixel});
        }
    }
}

/// batch      of primary rays; `hits_` are its hits.
void TileTracer::record_layers(const Rays& batch) {
    for (size_t i = 0; i < batch.rays.size(); ++i) {
        const Path& path = paths_[batch.paths[i]];
        if (path.key.sample != 0) return;
        const Ray& ray = batch.rays[i];
        const Hit& hit = hits_[i];
        film_->depth[path.pixel] = hit ? depth(pass_->view, ray.origin) - hit.t * glm::dot(ray.direction, pass_->view.axis_z)
                                       : std::numeric_limits<float>::infinity();
        film_->node[path.pixel] = index(hit.node);
        film_->primitive[path.pixel] = hit.primitive;
    }
}

void TileTracer::trace_cost() {
    const Clock::time_point start = Clock::now();
    hits_.resize(current_.rays.size());
    for (size_t i = 0; i < current_.rays.size(); ++i) {
        TraverseCounts counts;
        hits_[i] = closest_hit(pass_->tlas, current_.rays[i], &counts);
        paths_[current_.paths[i]].radiance = cost_color(counts.nodes + counts.triangles);
    }
    stats_->primary.ms += ms_since(start);
    stats_->primary.rays += current_.rays.size();
    for (size_t i = 0; i < current_.rays.size(); ++i) {
        Path& path = paths_[current_.paths[i]];
        stats_->hits += hits_[i] ? 1 : 0;
        stats_->hits_hash += hash(hits_[i], hash_key(path.key, 0));
        if (hits_[i]) path.coverage = 1.0f;
    }
    record_layers(current_);
}

/// One bounce of every path that is still under way: finds what its ray meets, lights it, and makes the next ray.
void TileTracer::trace_bounce(uint32_t bounce) {
    next_.clear();
    shadows_.clear();
    FrameStats::Kind* const kind = bounce == 0 ? &stats_->primary : &stats_->diffuse;
    for (uint32_t pass_through = 0; !current_.rays.empty() && pass_through < kMaxPassThrough; ++pass_through) {
        find_closest(current_, bounce, pass_through, kind);
        if (bounce == 0 && pass_through == 0) record_layers(current_);
        passing_.clear();
        shade_hits(bounce, pass_through);
        std::swap(current_, passing_);
    }
    trace_shadows(bounce);
    std::swap(current_, next_);
}

void TileTracer::find_closest(const Rays& batch, uint32_t which, uint32_t pass_through, FrameStats::Kind* kind) {
    hits_.resize(batch.rays.size());
    const Clock::time_point start = Clock::now();
    closest_hits(pass_->tlas, batch.rays, hits_);
    kind->ms += ms_since(start);
    kind->rays += batch.rays.size();
    for (size_t i = 0; i < hits_.size(); ++i) {
        stats_->hits += hits_[i] ? 1 : 0;
        stats_->hits_hash += hash(hits_[i], hash_key(paths_[batch.paths[i]].key, ray_number(which, pass_through)));
    }
}

void TileTracer::shade_hits(uint32_t bounce, uint32_t pass_through) {
    for (size_t i = 0; i < current_.rays.size(); ++i) {
        const Ray& ray = current_.rays[i];
        const uint32_t path_index = current_.paths[i];
        Path& path = paths_[path_index];
        if (!hits_[i]) {
            if (pass_through == 0 || bounce == 0) add_sky(ray, path_index, bounce);
            continue;
        }
        const Surface surface = surface_at(pass_->scene, pass_->tlas, ray, hits_[i]);
        if (pass_through == 0 && bounce > 0) add_sky_behind(surface, ray, path_index);
        if (surface.opacity < 1.0f) {
            const float u = uniform_1d(path.key, dimension(Use::kAlpha, bounce, pass_through));
            if (u >= surface.opacity) {
                passing_.push({.origin = leave(surface, ray.direction), .direction = ray.direction}, path_index);
                continue;
            }
        }
        shade_hit(surface, ray, hits_[i], path_index, bounce);
    }
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
    path.radiance += path.throughput * surface.emission;
    if (surface.is_unlit) {
        path.radiance += path.throughput * surface.base_color;
        return;
    }
    path.throughput *= surface.base_color;
    if (largest(path.throughput) <= 0.0f) return;
    add_sun(surface, path_index, bounce);
    add_punctual_light(surface, path_index, bounce);
    if (bounce < static_cast<uint32_t>(pass_->config.max_bounces)) bounce_on(surface, path_index, bounce);
}

/// What a ray sees that leaves the scene. Diffuse bounces don't see the sun's disc: shadow rays bring its light.
void TileTracer::add_sky(const Ray& ray, uint32_t path_index, uint32_t bounce) {
    if (pass_->config.shade != Shade::kPath) return;
    const Lighting& lighting = pass_->lighting;
    Path& path = paths_[path_index];
    path.radiance += path.throughput * (bounce == 0 ? lighting.background(ray.direction) : lighting.sky(ray.direction));
}

/// Sky light from the direction of a bounce may pass what the bounce itself ends at, and stop where the bounce goes on. It
/// is told apart at the first surface that both meet: from there on a shadow ray brings it, and the bounce surfaces only.
void TileTracer::add_sky_behind(const Surface& surface, const Ray& ray, uint32_t path_index) {
    const glm::vec3 radiance = (1.0f - surface.light_opacity) * pass_->lighting.sky(ray.direction);
    if (radiance == glm::vec3(0.0f)) return;
    shadows_.push({.origin = leave(surface, ray.direction), .direction = ray.direction}, path_index,
                  paths_[path_index].throughput * radiance);
}

void TileTracer::add_sun(const Surface& surface, uint32_t path_index, uint32_t bounce) {
    const glm::vec3& irradiance = pass_->lighting.sun_irradiance;
    if (irradiance == glm::vec3(0.0f)) return;
    const glm::vec3 toward = sample_sun(uniform_2d(paths_[path_index].key, dimension(Use::kSun, bounce)));
    const float share = diffuse(surface.ns, surface.ng, toward);
    add_shadow(surface, {.origin = leave(surface, toward), .direction = toward}, path_index, irradiance * share);
}

/// Picks one light with a probability proportional to what it would bring unshadowed: a single light brings its exact
/// value, and many cost one ray.
void TileTracer::add_punctual_light(const Surface& surface, uint32_t path_index, uint32_t bounce) {
    const auto& lights = pass_->lighting.lights;
    const auto brings = [&](const PunctualLight& light, glm::vec3* toward) {
        const Illumination at = illuminate(light, surface.position);
        *toward = at.toward;
        return at.irradiance * diffuse(surface.ns, surface.ng, at.toward);
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

void TileTracer::add_shadow(const Surface& surface, const Ray& ray, uint32_t path_index, const glm::vec3& radiance) {
    // Beyond the offset the light may turn out to be on the other side: then the surface itself is in the way.
    if (!(largest(radiance) > 0.0f) || !(glm::dot(surface.ng, ray.direction) > 0.0f)) return;
    shadows_.push(ray, path_index, paths_[path_index].throughput * radiance);
}

void TileTracer::bounce_on(const Surface& surface, uint32_t path_index, uint32_t bounce) {
    Path& path = paths_[path_index];
    if (bounce >= kRouletteFromBounce) {
        // Dim paths end early; those that go on carry the light of those that did not.
        const float survival = std::min(1.0f, largest(path.throughput));
        if (uniform_1d(path.key, dimension(Use::kRoulette, bounce)) >= survival) return;
        path.throughput /= survival;
    }
    const glm::vec2 u = uniform_2d(path.key, dimension(Use::kDirection, bounce));
    const glm::vec3 direction = sample_diffuse(surface.ns, surface.ng, u);
    next_.push({.origin = leave(surface, direction), .direction = direction}, path_index);
}

void TileTracer::trace_shadows(uint32_t bounce) {
    if (pass_->lets_light_pass) return look_through_shadows(bounce);
    is_hit_.resize(shadows_.rays.size());
    const Clock::time_point start = Clock::now();
    any_hits(pass_->tlas, shadows_.rays, is_hit_);
    stats_->shadow.ms += ms_since(start);
    stats_->shadow.rays += shadows_.rays.size();
    for (size_t i = 0; i < is_hit_.size(); ++i) {
        if (is_hit_[i] == 0) paths_[shadows_.paths[i]].radiance += shadows_.radiance[i];
        stats_->hits += is_hit_[i];
    }
}

/// Follows shadow rays surface by surface: each lets pass what it does not stop.
void TileTracer::look_through_shadows(uint32_t bounce) {
    for (uint32_t pass_through = 0; !shadows_.rays.empty() && pass_through < kMaxPassThrough; ++pass_through) {
        find_closest(shadows_, kShadowHash | bounce, pass_through, &stats_->shadow);
        onward_.clear();
        for (size_t i = 0; i < hits_.size(); ++i) {
            const Ray& ray = shadows_.rays[i];
            const glm::vec3& radiance = shadows_.radiance[i];
            if (!hits_[i]) {
                paths_[shadows_.paths[i]].radiance += radiance;
                continue;
            }
            const Surface surface = surface_at(pass_->scene, pass_->tlas, ray, hits_[i]);
            if (surface.light_opacity >= 1.0f) continue;
            const Ray onward{.origin = leave(surface, ray.direction),
                             .direction = ray.direction,
                             .t_max = std::max(0.0f, ray.t_max - hits_[i].t)};
            onward_.push(onward, shadows_.paths[i], radiance * (1.0f - surface.light_opacity));
        }
        std::swap(shadows_, onward_);
    }
}

}  // namespace zoe
