#pragma once

#include <cstdint>
#include <functional>

#include "engine/render/path.h"

namespace zoe {

/// When a frame's light is gathered.
struct Shutter {
    double opens_s = 0.0;  ///< The scene's time; a film camera's frame begins here.
    double open_s = 0.0;   ///< For so long; 0: only a moment.
    /// Times, one in each equal part of it, that samples are dealt over: a power of two. Chart `shutter`.
    uint32_t slices = 16;
    uint64_t seed = 0;  ///< Of where in its part each time lies: the frame's number.
};

/// The time of a slice: anywhere in its part, by the seed.
double slice_time(const Shutter& shutter, uint32_t slice);

/// A scene that plays before a camera.
struct Take {
    Scene& scene;
    std::function<const Tlas&(double time_s, FrameStats* stats)> advance;  ///< Makes the frame at a time.
    std::function<View()> view;                                            ///< Of the frame that was made last.
};

/// Takes one picture of a scene that moves while the shutter is open, the camera too. The scene is made anew at the time of
/// each slice: whatever moves by whatever method is where it is at that time, and so are its lights. Each pixel deals its
/// samples over the slices in an order of its own.
///
/// A picture depends on the take, the shutter, the config and how many samples each `add` was for; never on threads.
/// Cost       a frame's trees for each slice, in every `add`; with a shutter that is open for a moment only, none but the
///            first.
/// Source     Haeberli and Akeley. The Accumulation Buffer: Hardware Support for High-Quality Rendering. SIGGRAPH 1990.
///            Deviation: a pixel's samples are dealt over the pictures, which are of one sample for each pixel or less.
class Exposure {
public:
    /// Makes the frame at which the shutter opens, and clears the film; its layers of geometry are of that time,
    /// as are the config's, where it has some.
    /// take       it, and the film and the stats, outlive this. stats: added to; all frames that are made.
    /// Throws     what the take does.
    Exposure(const Take& take, const Shutter& shutter, const RenderConfig& config, Film* film, FrameStats* stats);

    /// The frame at which the shutter opens; the tree is there until `add`.
    const Tlas& tlas() const { return *tlas_; }
    const View& view() const { return view_; }
    bool is_sliced() const { return shutter_.open_s > 0.0; }
    const Shutter& shutter() const { return shutter_; }
    Film& film() { return *film_; }

    /// Adds samples to each pixel that has not enough. The rays of slices are reported to the scene (`report_rays`); those
    /// of a single frame are the caller's to report, when all are traced.
    /// report     called now and then with the share of them that is done.
    /// Returns    false where it was cancelled; the film is then not to be used.
    bool add(int sample_count, const std::function<void(double share)>& report = {});

private:
    const Take& take_;
    Shutter shutter_;
    RenderConfig config_;
    Film* film_;
    FrameStats* stats_;
    const Tlas* tlas_;
    View view_;
};

}  // namespace zoe
