#pragma once

#include <functional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "apps/chart/csv.h"
#include "apps/common/open_scene.h"
#include "engine/render/path.h"

namespace zoe::chart {

/// Samples from this one on are the references': tested pictures have those before.
inline constexpr int kReferenceBegin = 1 << 20;

/// A way of rendering one picture again and again.
struct Rendering {
    std::string series;
    /// Adds samples to a picture, from its own number of samples on.
    std::function<void(int sample_count, Film* film)> render;
    bool is_spread = true;  ///< Samples one after the other, which the sampler spreads evenly; else any of them.
    bool is_default = false;
};

/// A frame of the default scene.
struct DefaultPicture {
    Content content = open_scene("default", 24.0);
    const Tlas& tlas = advance(content, 1.0, nullptr);
    int width, height;
    View view;

    DefaultPicture(int width, int height);
    /// Renders so. The result refers to this object.
    std::function<void(int, Film*)> with(const RenderConfig& config) const;
};

/// Linear radiance of a picture of so many samples that no others are, [height * width].
std::vector<glm::dvec3> render_reference(const Rendering& rendering, int width, int height, int sample_count);

/// Error against time after 1, 2, 4, ... samples: a row each in the panels for RMSE and for the relative error, labelled
/// with the samples. relative_panel  mean of squares over squared brightness; empty: no such rows.
std::vector<Row> measure_noise(const std::vector<Rendering>& renderings, int width, int height, int most_samples,
                               const std::vector<glm::dvec3>& reference, const std::string& rmse_panel,
                               const std::string& relative_panel);

}  // namespace zoe::chart
