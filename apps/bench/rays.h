#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "apps/bench/ray_kind.h"
#include "engine/frame/frame.h"
#include "engine/render/view.h"

namespace zoe {

/// A ray through the centre of every pixel, in blocks of 4 x 4 pixels so that neighbours in the batch are neighbours in the
/// picture.
/// rays       [width * height], resized.
void make_primary_rays(const View& view, int width, int height, std::vector<Ray>* rays);

/// Appends rays from every hit of a traced batch of the frame: one into a random direction above the surface,
/// cosine-weighted, and one to a random point of a level square light under the top of the scene's box, a quarter as wide as
/// the box; the latter's t is 1 at the light.
/// rays, hits    [ray_count]
/// kind          of `rays`: random numbers are keyed by it.
/// diffuse_rays  null where none are wanted.
void add_rays_at_hits(const Scene& scene, const Tlas& tlas, std::span<const Ray> rays, std::span<const Hit> hits,
                      RayKind kind, std::vector<Ray>* diffuse_rays, std::vector<Ray>* shadow_rays);

}  // namespace zoe
