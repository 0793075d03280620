#include "engine/render/tile.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <glm/geometric.hpp>

#include "engine/render/geometry.h"
#include "engine/render/inspect.h"

namespace zoe {

namespace {

constexpr uint32_t kMaxPassThrough = 1024;  // see-through surfaces in a row; what lies behind so many is taken as dark
constexpr uint32_t kShadowHash = 0x80000000u;

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Tells apart the rays of a frame: `which` counts bounces, and see-through surfaces within them.
uint64_t hash_key(const SampleKey& key, uint64_t which) {
    return mix_bits(mix_bits(static_cast<uint64_t>(key.pixel) << 32 | key.sample) + which);
}

/// A pixel's width, as far as a ray has come.
RayCone camera_cone(const View& view, int height) {
    const float pixel = 2.0f * view.half_height / static_cast<float>(height);
    return view.is_perspective ? RayCone{0.0f, pixel} : RayCone{pixel, 0.0f};
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
    toward.clear();
}

void TileTracer::Shadows::push(const Ray& ray, uint32_t path, const glm::vec3& brings, Toward what) {
    Rays::push(ray, path);
    radiance.push_back(brings);
    toward.push_back(what);
}

bool TileTracer::trace(const Pass& pass, const Tile& tile, Film* film, TileStats* stats) {
    pass_ = &pass;
    film_ = film;
    stats_ = stats;
    const uint32_t slices = pass.slice.count, end = static_cast<uint32_t>(pass.first_sample + pass.sample_count);
    for (uint32_t turn = static_cast<uint32_t>(pass.first_sample) / slices; turn * slices < end; ++turn) {
        if (pass.config.cancel != nullptr && pass.config.cancel->load(std::memory_order_relaxed)) return false;
        start_paths(tile, turn);
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

/// Tells whether the pass takes this sample.
bool TileTracer::is_wanted(uint32_t pixel, uint32_t sample) const {
    const uint32_t first = static_cast<uint32_t>(pass_->first_sample), count = static_cast<uint32_t>(pass_->sample_count);
    return sample - first < count && (pass_->enough.empty() || sample < pass_->enough[pixel]);
}

/// A sample of each pixel, one in so many samples as there are slices.
void TileTracer::start_paths(const Tile& tile, uint32_t turn) {
    paths_.clear();
    current_.clear();
    const RayCone cone = camera_cone(pass_->view, film_->height);
    for (int y = tile.y_begin; y < tile.y_end; ++y) {
        for (int x = tile.x_begin; x < tile.x_end; ++x) {
            const uint32_t pixel = static_cast<uint32_t>(y) * static_cast<uint32_t>(film_->width) + static_cast<uint32_t>(x);
            const Slice& slice = pass_->slice;
            const uint32_t sample = sample_in_slice(pixel, turn, slice.number, slice.count);
            if (!is_wanted(pixel, sample)) continue;
            const SampleKey key{pixel, pass_->config.first_number + sample};
            const bool is_first = pass_->has_layers && sample == 0;
            glm::vec2 within(0.5f);
            if (pass_->config.is_jittered && !is_first) within = uniform_2d(key, dimension(Use::kPixel, 0));
            current_.push(pixel_ray(pixel, within), static_cast<uint32_t>(paths_.size()));
            paths_.push_back({.key = key, .is_first = is_first, .pixel = pixel, .cone = cone});
        }
    }
}

/// batch      of primary rays; `hits_` are its hits.
void TileTracer::record_layers(const Rays& batch) {
    if (!pass_->has_layers) return;
    for (size_t i = 0; i < batch.rays.size(); ++i) {
        const Path& path = paths_[batch.paths[i]];
        if (!path.is_first) return;
        record_geometry(pass_->view, batch.rays[i], hits_[i], path.pixel, film_);
        if (pass_->layers == nullptr) continue;
        pass_->layers->see(path.pixel, pass_->scene, pass_->tlas, pass_->view, batch.rays[i], hits_[i]);
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
            const Surface surface = surface_at(pass_->scene, pass_->tlas, ray, hits_[i], {}, Detail::kLight);
            const Toward toward = shadows_.toward[i];
            const float opacity = toward == Toward::kLight ? surface.light_opacity : surface.opacity;
            const glm::vec3 passes = passing_share(surface, opacity, -ray.direction);
            if (passes == glm::vec3(0.0f)) continue;
            // What has an end keeps it: the new origin is beside the old ray.
            Ray onward{.origin = leave(surface, ray.direction), .direction = ray.direction};
            if (std::isfinite(ray.t_max)) {
                onward.direction = ray.origin + ray.t_max * ray.direction - onward.origin;
                onward.t_max = glm::dot(onward.direction, ray.direction) > 0.0f ? 1.0f : 0.0f;
            }
            onward_.push(onward, shadows_.paths[i], radiance * passes, toward);
        }
        std::swap(shadows_, onward_);
    }
}

}  // namespace zoe
