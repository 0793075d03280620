#pragma once

#include <cstddef>

#include "engine/frame/trace.h"
#include "engine/render/film.h"
#include "engine/render/layers.h"
#include "engine/render/view.h"

namespace zoe {

/// Writes what the ray through a pixel's centre meets into the film's layers of geometry.
void record_geometry(const View& view, const Ray& ray, const Hit& hit, size_t pixel, Film* film);

/// Fills all of them, and the layers beside them, by rays of their own: where the film's samples are not of one time.
/// layers     may be null.
void see_geometry(const Scene& scene, const Tlas& tlas, const View& view, Film* film, Layers* layers);

}  // namespace zoe
