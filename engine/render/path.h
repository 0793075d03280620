#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string_view>

#include "engine/frame/frame.h"
#include "engine/render/film.h"
#include "engine/render/view.h"

namespace zoe {

class Environment;  // engine/render/environment.h
struct Guides;      // engine/render/guides.h

/// What a pixel shows: the lit picture, the surface's colour, its normal, its motion class, or the work of its ray.
enum class Shade : uint8_t { kPath, kAlbedo, kNormal, kMotion, kCost };
std::optional<Shade> shade_from_name(std::string_view name);

struct RenderConfig {
    Shade shade = Shade::kPath;
    int max_bounces = 4;                        ///< After the first hit. Chart `picture`.
    float sun_strength = 1.0f;                  ///< Times the default sun; 0 for none.
    float sky_strength = 1.0f;                  ///< Times the default sky; 0 for a black one.
    std::optional<glm::vec3> uniform_sky;       ///< Radiance of a sky of one colour, and no sun: a furnace.
    const Environment* environment = nullptr;   ///< Instead of sky and sun, times sky_strength; outlives the render.
    bool is_jittered = true;                    ///< Else all rays go through pixel centres, as the first sample's always do.
    uint32_t first_number = 0;                  ///< Of the random numbers of the film's first sample: frames take turns.
    Guides* guides = nullptr;                   ///< Filled by the film's first sample.
    const std::atomic<bool>* cancel = nullptr;  ///< Set by another thread to leave early; the film is then not changed.
};

/// Traces `sample_count` more samples a pixel into the film, in parallel over tiles. Numbers are keyed by pixel, sample and
/// dimension: passes may be split anywhere, and threads do not matter.
///
/// The light: a sky seen by every ray that leaves the scene, a sun that such rays see and shadow rays sample, emissive
/// surfaces where a path meets them and by shadow rays, and punctual lights by shadow rays. Surfaces scatter as glTF's
/// materials say (bsdf.h). Sky and sun are there whatever lights the scene has. Alpha blends by chance, shadows by the exact
/// share, and thin sheets that light passes do both. Bodies that it passes bend it, and shade the sun and punctual lights.
/// Single-sided materials are seen from their front only, and neither lit nor shade from behind.
///
/// stats      added to; may be null. rays: all of them; hits: those that hit; hits_hash: over the closest hits, keyed by
///            pixel, sample, bounce and see-through surfaces passed.
/// Returns    false where it was cancelled.
bool render(const Scene& scene, const Tlas& tlas, const View& view, const RenderConfig& config, int sample_count, Film* film,
            FrameStats* stats);

}  // namespace zoe
