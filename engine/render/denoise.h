#pragma once

#include "engine/render/denoise_planes.h"
#include "engine/render/film.h"
#include "engine/render/guides.h"

namespace zoe {

/// Error against time: chart `denoise`.
struct DenoiseConfig {
    int most_frames = 8;    ///< That a pixel's mean looks back on; fewer follow the light faster. Chart `denoise`.
    int rounds = 4;         ///< Of the spatial filter, each as wide as those before it together. Chart `denoise`.
    float strength = 3.0f;  ///< Of a pixel's noise, what its neighbours' light may differ by. Chart `denoise`.
};

/// Makes a picture of few samples smooth by those beside it, and those of the frames before.
///
///     light = (radiance - what has no noise) / albedo
///     its mean with the light of the frames before, followed by the points' motion
///     its variance, over time, or where that is short, over neighbours
///     a wavelet's smoothing in rounds, 3 x 3 pixels 1, 2, 4, ... apart, no farther than noise explains
///     radiance = what has no noise + albedo * light
///
/// The sky, emission and unlit colours pass as they are. The result depends on the frames before, and on nothing else: not
/// on threads. Samples that are not finite count as none.
///
/// Source     Schied et al. Spatiotemporal Variance-Guided Filtering. HPG 2017. Deviation: frames hand on their mean as it
///            is before smoothing; nodes and past depths instead of meshes and derivatives; 3 x 3 instead of 5 x 5 pixels;
///            polynomials instead of powers and exponentials; the variance is the mean's, not a sample's; a surface that
///            turns counts less of its past.
class Denoiser {
public:
    /// The next frame is a first one: after a cut. A frame of another size is one anyway.
    void forget() { is_first_ = true; }

    /// guides     of the same picture, with its past where it has one.
    /// film       at least one sample, of rays through pixels' centres. Its radiance is replaced, and nothing else of it.
    /// Cost       a fixed number of passes over the pixels, in parallel; no allocation once sizes have settled.
    void filter(const Guides& guides, const DenoiseConfig& config, Film* film);

private:
    DenoiseFrame frame_;
    DenoiseLight smoothed_;
    bool is_first_ = true;
};

}  // namespace zoe
