#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/render/bsdf.h"
#include "engine/render/glow.h"
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
    const Glow& glow;
    bool lets_light_pass = false;  ///< Some material on show does: shadow rays must look at what they meet.
    Guides* guides = nullptr;      ///< Of the film's first sample, where that is in this pass.
    Layers* layers = nullptr;      ///< The same.
    int first_sample = 0, sample_count = 0;
    std::span<const uint32_t> enough;  ///< The film's.
    Slice slice;                       ///< Without slices, the only one.
    bool has_layers = false;           ///< Sample 0 writes the film's layers, and goes through pixels' centres.
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
        bool is_first = false;  // of its pixel
        size_t pixel = 0;       // in the film
        glm::vec3 throughput{1.0f};
        glm::vec3 radiance{0.0f};
        float coverage = 0.0f;
        /// Of the direction that the path goes in, where lights were looked for by another way, too; 0: this is the only
        /// one.
        float density = 0.0f;
        glm::vec3 from{0.0f};       // where it was scattered last
        bool is_scattered = false;  // since the camera, by anything but the surfaces of bodies that light passes through
        RayCone cone;               // at the origin of its ray
    };
    /// Rays on their way to a closest hit, and the path that each belongs to.
    struct Rays {
        std::vector<Ray> rays;
        std::vector<uint32_t> paths;
        void clear();
        void push(const Ray& ray, uint32_t path);
    };
    /// What a shadow ray looks for: light, which arrives at the backs of single-sided surfaces and passes; or, as bounces
    /// do, a surface, which their fronts hide.
    enum class Toward : uint8_t { kLight, kSurface };
    /// Rays towards lights, and what they bring where nothing is in the way.
    struct Shadows : Rays {
        std::vector<glm::vec3> radiance;
        std::vector<Toward> toward;
        void clear();
        void push(const Ray& ray, uint32_t path, const glm::vec3& radiance, Toward toward);
    };

    /// What a punctual light would bring if nothing were in its way.
    struct Offer {
        const PunctualLight* light;
        glm::vec3 toward;
        glm::vec3 radiance;
        float weight;  // its strongest colour; above 0
    };

    Ray pixel_ray(size_t pixel, const glm::vec2& within) const;
    bool is_wanted(uint32_t pixel, uint32_t sample) const;
    void start_paths(const Tile& tile, uint32_t turn);
    void record_layers(const Rays& batch);
    void trace_cost();
    void trace_bounce(uint32_t bounce);
    void find_closest(const Rays& batch, uint32_t bounce, uint32_t pass_through, FrameStats::Kind* kind);
    void shade_hits(uint32_t bounce, uint32_t pass_through);
    void shade_hit(const Surface& surface, const Ray& ray, const Hit& hit, uint32_t path, uint32_t bounce);
    void add_sky(const Ray& ray, uint32_t path, uint32_t bounce);
    void add_sky_behind(const Surface& surface, const Ray& ray, uint32_t path);
    glm::vec3 sky_seen(const Path& path, const glm::vec3& direction) const;
    bool pass_straight(const Surface& surface, const Ray& ray, uint32_t path, uint32_t bounce, uint32_t pass_through);
    bool is_last(uint32_t bounce) const { return bounce >= static_cast<uint32_t>(pass_->config.max_bounces); }
    void add_sun(const Surface& surface, const Hit& hit, const Bsdf& bsdf, uint32_t path, uint32_t bounce);
    void add_environment(const Surface& surface, const Bsdf& bsdf, uint32_t path, uint32_t bounce);
    void add_punctual_light(const Surface& surface, const Hit& hit, const Bsdf& bsdf, uint32_t path, uint32_t bounce);
    void add_glow(const Surface& surface, const Bsdf& bsdf, uint32_t path, uint32_t bounce);
    float weight_of_light(float density, float other) const;
    float weight_of_bounce(float density, float other) const;
    float density_seen(const Surface& lamp, const glm::vec3& from, const glm::vec3& toward) const;
    float glow_weight(const Surface& surface, const Ray& ray, const Path& path) const;
    void add_shadow(const Ray& ray, uint32_t path, const glm::vec3& radiance, Toward toward = Toward::kLight);
    void bounce_on(const Surface& surface, const Bsdf& bsdf, float distance, uint32_t path, uint32_t bounce);
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
    std::vector<Offer> offers_;
};

}  // namespace zoe
