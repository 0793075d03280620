#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "engine/scene/image.h"

namespace zoe {

/// How often both sides of an image are halved at most while it is decoded.
inline constexpr int kMaxHalvings = 3;

/// Tells how often an image is to be halved at least, by its size.
using ChooseHalvings = std::function<int(const Image& size)>;

/// Decodes a scene's picture. PNG, JPEG and WebP become bytes; EXR and HDR, whose numbers are linear, become halves. Its
/// name, `is_color` and `is_light` stay.
/// EXR        one part, scan lines or tiles; red, green and blue, or one grey, and alpha, as they are stored: not divided
///            by alpha. Other channels are not looked at.
/// max_pixels how many the image may have at most, one of halves counting twice: one that has more, as its header tells
///            before pixels are read, is halved row by row while it is decoded; it is refused where kMaxHalvings do not do.
/// choose     asked once, as soon as some rows were read: what follows may be broken even so. Null: no more often than
///            `max_pixels` asks for.
/// Cost       in memory, beside the image: 64 rows (or those of a tile), and what the decoder holds. That is all of the
///            picture where a PNG is interlaced, a JPEG is progressive, or it is a WebP.
/// Returns    false, with the reason in `error`, for broken files and for more than 16384 pixels a side.
bool decode_image(std::span<const std::byte> encoded, Image* image, std::string* error, uint64_t max_pixels = UINT64_MAX,
                  const ChooseHalvings& choose = nullptr);

}  // namespace zoe
