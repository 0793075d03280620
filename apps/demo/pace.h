#pragma once

namespace zoe {

/// What the sides of a picture are divided by: of its light, and of the surfaces that this is shown on. Equal: the light's
/// own are shown.
struct PlaySizes {
    int light = 4, surfaces = 2;
};

/// Chooses how large pictures may be so that one is ready in time. It goes by what pictures have taken: a size that would
/// take too long is left at once, for a larger one only after several that it would have done for. Another size is a
/// filter's new beginning.
///
/// Surfaces take a share of the time at the most, light the rest. Where that would do for light on pixels as small, there
/// need be no surfaces beside it; now and then they are tried again: they may have become cheaper.
class Pace {
public:
    /// pixel_count   of the picture in full size.
    /// other_ms      what the next one takes besides its pixels.
    PlaySizes choose(double pixel_count, double other_ms);
    /// The same for pictures without light, which are surfaces only.
    int choose_unlit(double pixel_count, double other_ms);

    /// Takes in what pixels have taken.
    void note_light(double pixel_count, double ms) { note(pixel_count, ms, &light_ms_); }
    void note_surfaces(double pixel_count, double ms) { note(pixel_count, ms, &surface_ms_); }

private:
    /// A divisor that is slow to grow the picture.
    struct Size {
        int divisor;
        int early_count = 0;  ///< Pictures in a row that might have been larger.
        /// whole_ms   what a picture takes in full size.
        int choose(double whole_ms, double room_ms);
    };
    static void note(double pixel_count, double ms, double* ms_a_pixel);

    Size lone_light_{PlaySizes{}.light}, light_{PlaySizes{}.light}, surfaces_{PlaySizes{}.surfaces},
        lone_surfaces_{PlaySizes{}.surfaces};
    int lone_count_ = 0;                        // pictures in a row without surfaces of their own
    double light_ms_ = 0.0, surface_ms_ = 0.0;  // a pixel, smoothed; 0: unknown
};

}  // namespace zoe
