#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/render/light.h"
#include "engine/render/path.h"
#include "engine/render/sampler.h"
#include "engine/render/surface.h"

namespace zoe {

/// What all tiles of one call of `render` read.
struct Pass {
    const Scene& scene;
    const Tlas& tlas;
    const View& view;
    const RenderConfig& config;
    const Lighting& lighting;
    bool lets_light_pass = false;  ///< Some material on show does: shadow rays must look at what they meet.
    int first_sample = 0, sample_count = 0;
};

/// Rays of a tile by kind, times summed over the tiles.
struct TileStats {
    FrameStats::Kind primary, diffuse, shadow;
    uint64_t hits = 0, hits_hash = 0;
};

/// Pixels [x_begin, x_end) x [y_begin, y_end).
struct Tile {
    int x_begin = 0, y_begin = 0, x_end = 0, y_end = 0;
};

/// Traces the paths of a tile together, one sample and one bounce of all its pixels after another: a batch of rays to
/// their closest hits, those to a batch of shadow rays and a batch of bounces. Its memory is kept for the next tile.
class TileTracer {
public:
    /// Adds the pass's samples to the tile's pixels.
    /// Returns    false where it was cancelled; the film's tile is then half done.
    bool trace(const Pass& pass, const Tile& tile, Film* film, TileStats* stats);

private:
    struct Path {
        SampleKey key;
        size_t pixel = 0;  // in the film
        glm::vec3 throughput{1.0f};
        glm::vec3 radiance{0.0f};
        float coverage = 0.0f;
    };
    /// Rays on their way to a closest hit, and the path that each belongs to.
    struct Rays {
        std::vector<Ray> rays;
        std::vector<uint32_t> paths;
        void clear();
        void push(const Ray& ray, uint32_t path);
    };
    /// Rays towards lights, and what they bring where nothing is in the way.
    struct Shadows : Rays {
        std::vector<glm::vec3> radiance;
        void clear();
        void push(const Ray& ray, uint32_t path, const glm::vec3& radiance);
    };

    Ray pixel_ray(size_t pixel, const glm::vec2& within) const;
    void start_paths(const Tile& tile, uint32_t sample);
    void record_layers(const Rays& batch);
    void trace_cost();
    void trace_bounce(uint32_t bounce);
    void find_closest(const Rays& batch, uint32_t bounce, uint32_t pass_through, FrameStats::Kind* kind);
    void shade_hits(uint32_t bounce, uint32_t pass_through);
    void shade_hit(const Surface& surface, const Ray& ray, const Hit& hit, uint32_t path, uint32_t bounce);
    void add_sky(const Ray& ray, uint32_t path, uint32_t bounce);
    void add_sky_behind(const Surface& surface, const Ray& ray, uint32_t path);
    void add_sun(const Surface& surface, uint32_t path, uint32_t bounce);
    void add_punctual_light(const Surface& surface, uint32_t path, uint32_t bounce);
    void add_shadow(const Surface& surface, const Ray& ray, uint32_t path, const glm::vec3& radiance);
    void bounce_on(const Surface& surface, uint32_t path, uint32_t bounce);
    void trace_shadows(uint32_t bounce);
    void look_through_shadows(uint32_t bounce);

    const Pass* pass_ = nullptr;  // while tracing
    Film* film_ = nullptr;
    TileStats* stats_ = nullptr;
    std::vector<Path> paths_;
    std::vector<Hit> hits_;
    std::vector<uint8_t> is_hit_;
    Rays current_, passing_, next_;
    Shadows shadows_, onward_;
};

}  // namespace zoe
