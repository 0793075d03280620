#pragma once

#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/frame/trace.h"
#include "engine/render/view.h"

namespace zoe {

class PastFrame;  // engine/render/past_frame.h

/// What the rays through pixels' centres meet, beside what a film holds: for those who compose pictures. `render` fills it
/// where it is asked to. All arrays [height * width], top row first.
struct Layers {
    /// What motion is measured from; null, or nothing kept in it: everything stood still.
    const PastFrame* past = nullptr;

    int width = 0, height = 0;
    std::vector<glm::vec3> albedo;  ///< Linear base colour; 0 on a miss.
    std::vector<glm::vec3> normal;  ///< Shading normal, world space, towards the viewer; 0 on a miss.
    /// How far what is shown, the sky too, has moved since the past frame, across the picture: pixels to the right and up.
    /// What had no place there (the node was hidden, or its mesh had other triangles) is taken to have stood still; 0 for
    /// what was behind that camera, or in its very place.
    std::vector<glm::vec2> motion;

    /// Makes room.
    void start(int picture_width, int picture_height);
    /// Notes what the ray through a pixel's centre has met, or that it is a miss.
    void see(size_t pixel, const Scene& scene, const Tlas& tlas, const View& view, const Ray& ray, const Hit& hit);
};

}  // namespace zoe
