#pragma once

#include <cstdint>

namespace zoe {

/// An sRGB value as linear light; both in [0, 1].
float linear_from_srgb(float encoded);

/// The same of a byte, by a table.
float linear_from_srgb_byte(uint8_t encoded);

/// The byte whose light is nearest, as the eye counts: where the encoded value is rounded. Below 0 and NaN: 0.
uint8_t srgb_byte_from_linear(float linear);

}  // namespace zoe
