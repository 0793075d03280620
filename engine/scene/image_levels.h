#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/image.h"

namespace zoe {

/// Half a picture's sides, rounded up: every texel is the mean of what it covers, so the picture's mean stays, up to the
/// rounding of bytes or halves.
/// is_color   red, green and blue of bytes are sRGB: their light is averaged.
/// is_half    texels are four halves; else four bytes.
ImageLevel halved(const ImageLevel& from, bool is_color, bool is_half);

/// Makes all coarser levels of an image that has pixels, down to one texel.
/// Cost       as many texels as a third of the image's, in parallel over rows.
void make_levels(Image* image);

/// Takes the finest level away: both sides are halved.
/// Requires   that there are coarser ones.
void drop_finest(Image* image);

/// The pixels of an image's finest level, those of halves counting twice.
uint64_t pixel_worth(const Image& image);

/// Halves the largest images until all of them together have at most so many pixels in their finest levels, those of halves
/// counting twice; of equally large ones the first. What is left when they are single texels is dropped from the last image
/// on.
void fit_images(std::vector<Image>* images, uint64_t max_pixels);

/// Halves images as `fit_images` would if there were one more.
/// added      that one, by its size.
/// Returns    how often it would be halved.
int make_room(const Image& added, std::vector<Image>* images, uint64_t max_pixels);

/// Makes images that are copies of others, and halves all as `fit_images` does. Takes no more memory than what is there
/// before or after it.
/// originals  [images] position of the image that each is a copy of: its own, or a lower one's that is no copy.
void copy_and_fit(const std::vector<size_t>& originals, std::vector<Image>* images, uint64_t max_pixels);

/// What images and their levels take in memory.
uint64_t byte_count(std::span<const Image> images);

}  // namespace zoe
