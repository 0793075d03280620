#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/render/shutter.h"

namespace zoe {

/// When a pixel has enough samples.
struct NoiseConfig {
    /// Standard error of pixels' luminance, relative to it, in the root mean square over a block of them.
    float target = 0.01f;
    /// Of every pixel, before it is judged; a power of two, 2 or more. Chart `noise`.
    int least_samples = 16;
    /// Darker pixels count as if they had this luminance: noise in the dark is not seen.
    float least_luminance = 0.1f;
};

/// Gives pixels samples until they are as clean as asked for, and judges them in blocks of 8 x 8. The first and the second
/// half of a pixel's samples are two pictures, each with its samples spread evenly; half their difference is the standard
/// error of their mean. Blocks that are too noisy get twice the samples, or fewer where fewer will do.
///
/// Who stops where luck was good is left with too little light. So a pixel's own samples never say when it has enough: in
/// each block those on the white squares of a chessboard judge those on the black ones, and reverse. What lights a few
/// pixels only, and was not found by others, is looked for by the blocks around: half of a neighbour's error is theirs, too.
/// What is left of the loss is of second order: how many samples the judges had was up to those that they judge.
///
/// Memory is kept from picture to picture.
/// Source     Dammertz, Hanika, Keller, Lensch. A Hierarchical Automatic Stopping Condition for Monte Carlo Global
///            Illumination. WSCG 2010 (the two halves). Deviation: blocks of one size, judged by neighbours, as
///            Kirk and Arvo (Unbiased Sampling Techniques for Image Synthesis, SIGGRAPH 1991) keep apart the samples that
///            judge; squares in place of magnitudes.
class NoiseLimit {
public:
    /// Adds samples to an exposure that has none: to all its pixels `least_samples`, then to those that need them, up to
    /// `most_samples`.
    /// may_go_on  asked between passes: false to end with what is there; empty: it always may.
    /// report     called now and then with the share of `most_samples` that is done.
    /// Returns    false where it was cancelled.
    bool expose(const NoiseConfig& config, int most_samples, Exposure* exposure, const std::function<bool()>& may_go_on,
                const std::function<void(double share)>& report);

private:
    /// The variances of pixels on the squares of one colour, in a block.
    struct Sum {
        double variances = 0.0;
        uint32_t pixel_count = 0;
        double mean() const { return pixel_count > 0 ? variances / pixel_count : 0.0; }
    };
    struct Block {
        Sum on[2];
    };

    void measure(const NoiseConfig& config, const Film& film);
    /// Returns the most samples that any pixel is to have.
    uint32_t judge(const NoiseConfig& config, Film* film);

    std::vector<float> half_luminance_;            // [pixel_count] of the first half of the samples, summed
    std::vector<float> variance_;                  // [pixel_count] of one sample, relative: what was last known
    std::vector<Block> blocks_;                    // [blocks down * blocks across]
    std::vector<std::array<uint32_t, 2>> needed_;  // the same: samples of pixels on each colour
};

/// Samples a pixel, in the mean.
double mean_samples(const Film& film);

}  // namespace zoe
