#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/frame/trace.h"
#include "engine/render/view.h"

namespace zoe {

/// What the rays through pixels' centres meet, beside what a film holds: for those who filter or compose pictures. All
/// arrays [height * width], top row first.
struct Layers {
    int width = 0, height = 0;
    std::vector<Hit> hits;
    std::vector<glm::vec3> albedo;  ///< Linear base colour; 0 on a miss.
    std::vector<glm::vec3> normal;  ///< Shading normal, world space, towards the viewer; 0 on a miss.
    /// How far what is shown has moved since another time, across the picture: pixels to the right and up. 0 until
    /// `add_motion`.
    std::vector<glm::vec2> motion;

    std::vector<glm::vec3> points;  ///< Where they hit, in the world; on a miss, the ray's direction.
    /// Which mesh each instance shows: one of another version, or another mesh, has other triangles.
    struct Shown {
        const Mesh* mesh = nullptr;
        uint64_t version = 0;
    };
    std::vector<Shown> shown;  ///< [node_count]
};

/// tlas       of the last frame that was made.
/// layers     result; its memory is reused.
void see_layers(const Scene& scene, const Tlas& tlas, const View& view, int width, int height, Layers* layers);

/// Follows what each pixel shows, the sky too, from another time. What has no place there (the node was hidden, or its mesh
/// had other triangles) is taken to have stood still. 0 for what was behind that camera, or in its very place.
/// view       of the layers; `then`, `view_then`: the frame that was made last, and its view.
void add_motion(const View& view, const Tlas& then, const View& view_then, Layers* layers);

}  // namespace zoe
