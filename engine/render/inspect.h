#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "engine/render/path.h"
#include "engine/render/surface.h"

namespace zoe {

/// The colour of a motion class, linear: grey, blue, orange, magenta. Told apart by people with any colour vision, and by
/// brightness alone: the more a class can do, the further it is from grey.
glm::vec3 motion_color(Motion motion);

/// What a surface looks like in a shade other than path and cost.
/// toward_viewer   unit.
glm::vec3 inspect(Shade shade, const Surface& surface, Motion motion, const glm::vec3& toward_viewer);

/// The heat of a count of box and triangle tests, linear: from dark blue (none) over violet and orange to yellow
/// (kCostScale and more), on a logarithmic scale. Each step is brighter than the one before.
glm::vec3 cost_color(uint64_t tests);
inline constexpr uint32_t kCostScale = 1024;

}  // namespace zoe
