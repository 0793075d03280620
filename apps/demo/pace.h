#pragma once

namespace zoe {

/// Chooses how large a picture may be so that one is ready in time. It goes by what pictures have taken: a size that
/// would take too long is left at once, for a larger one only after several that it would have done for. Another size is a
/// filter's new beginning.
class Pace {
public:
    /// pixel_count   of the picture in full size.
    /// other_ms      what the next one takes besides its pixels.
    /// Returns       what the picture's sides are to be divided by.
    int choose_divisor(double pixel_count, double other_ms);

    /// Takes in what a picture has taken.
    void note(double pixel_count, double ms);

private:
    int divisor_ = 4;
    int early_count_ = 0;      // pictures in a row that might have been larger
    double ms_a_pixel_ = 0.0;  // smoothed; 0: unknown
};

}  // namespace zoe
