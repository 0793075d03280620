#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/frame/trace.h"
#include "engine/render/surface.h"
#include "engine/render/view.h"

namespace zoe {

class PastFrame;  // engine/render/past_frame.h

/// The least that light is divided by where a surface's colour is taken out of it: what a dielectric reflects whatever its
/// colour.
inline constexpr float kLeastAlbedo = 0.04f;

/// What the first sample of each pixel has met, by which a filter tells light that belongs together: `render` fills it where
/// it is asked to. All arrays [height * width], top row first.
struct Guides {
    /// Where pixels' points were; null, or nothing kept in it: not known.
    const PastFrame* past = nullptr;

    int width = 0, height = 0;
    std::vector<glm::vec3> albedo;      ///< Linear base colour; 0 for the sky.
    std::vector<glm::vec3> normal;      ///< Shading normal, world space, towards the viewer; 0: the sky, or unlit.
    std::vector<glm::vec3> unfiltered;  ///< Radiance without noise: emission, unlit colours, the sky.
    std::vector<float> depth;           ///< Metres along the camera's axis; +infinity for the sky.
    std::vector<uint32_t> node;         ///< 0xffffffff for the sky.
    std::vector<glm::vec2> was_at;      ///< Pixels from the top left of the past frame; NaN: unknown.
    std::vector<float> was_depth;       ///< Metres along that frame's camera's axis.

    /// Makes room; every pixel shows the sky, black.
    void start(int picture_width, int picture_height);
    /// Notes what a pixel shows.
    /// so_far     what its path has brought up to here.
    void see_sky(size_t pixel, const glm::vec3& so_far) { unfiltered[pixel] = so_far; }
    void see_surface(size_t pixel, const Tlas& tlas, const View& view, const Hit& hit, const Surface& surface,
                     const glm::vec3& so_far);
};

}  // namespace zoe
