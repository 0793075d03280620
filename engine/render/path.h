#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "engine/frame/frame.h"
#include "engine/render/film.h"
#include "engine/render/view.h"

namespace zoe {

class Environment;  // engine/render/environment.h
struct Guides;      // engine/render/guides.h
struct Layers;      // engine/render/layers.h

/// What a pixel shows: the lit picture, the surface's colour, its normal, its motion class, or the work of its ray.
enum class Shade : uint8_t { kPath, kAlbedo, kNormal, kMotion, kCost };
std::optional<Shade> shade_from_name(std::string_view name);

/// Which of two ways finds the light of lamps, suns and environments: rays towards them, bounces that happen to meet them,
/// or both, each by what it is better at. The mean is the same.
enum class LightSearch : uint8_t { kBoth, kLights, kBounces };

/// A part of the time that a shutter is open.
struct Slice {
    uint32_t number = 0, count = 1;  ///< Number is below count, a power of two.
};

struct RenderConfig {
    Shade shade = Shade::kPath;
    int max_bounces = 4;                       ///< After the first hit. Chart `picture`.
    float sun_strength = 1.0f;                 ///< Times the sun; 0 for none.
    float sky_strength = 1.0f;                 ///< Times the sky without its sun; 0 for a black one.
    std::optional<glm::vec3> uniform_sky;      ///< Radiance of a sky of one colour, and no sun: a furnace.
    const Environment* environment = nullptr;  ///< Instead of the default sky and sun; outlives the render.
    LightSearch search = LightSearch::kBoth;   ///< Chart `lights`.
    bool is_lit = true;                        ///< Else pixels show emission, unlit colours and the sky only.
    bool is_jittered = true;                   ///< Else all rays go through pixel centres, as the first sample's always do.
    /// Only the samples that fall into this slice, of those that the call is for; pixels' centres have no sample then, and
    /// the film's geometry stays. The film's count grows with the last slice: all slices are rendered one after another, for
    /// the same samples.
    std::optional<Slice> slice;
    uint32_t first_number = 0;                  ///< Of the random numbers of the film's first sample: frames take turns.
    Guides* guides = nullptr;                   ///< Filled by the film's first sample, where there are no slices.
    Layers* layers = nullptr;                   ///< The same.
    const std::atomic<bool>* cancel = nullptr;  ///< Set by another thread to leave early; the film is then not changed.
};

/// Traces `sample_count` more samples of each pixel that has not enough into the film, in parallel over tiles. Numbers are
/// keyed by pixel, sample and dimension: passes may be split anywhere, and threads do not matter.
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
/// Throws     std::logic_error while another thread makes the scene's next frame, which meanwhile is refused.
bool render(const Scene& scene, const Tlas& tlas, const View& view, const RenderConfig& config, int sample_count, Film* film,
            FrameStats* stats);

}  // namespace zoe
