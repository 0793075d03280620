#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <glm/vec3.hpp>

namespace zoe {

/// How light of any brightness becomes what a screen can show.
enum class Tone : uint8_t {
    kNeutral,  ///< True colours up to four fifths of white, then compressed towards white.
    kAces,     ///< A film's curve: more contrast, bright colours bleach.
    kLinear,   ///< Nothing is compressed: what is brighter than white is cut off.
};
std::optional<Tone> tone_from_name(std::string_view name);

/// How a film becomes a picture for a screen.
struct Grade {
    float exposure = 1.0f;  ///< What radiance is multiplied by.
    Tone tone = Tone::kNeutral;
    friend bool operator==(const Grade&, const Grade&) = default;
};

/// color      linear, Rec. 709 primaries, exposed; of any size, infinite too. NaN counts as 0.
/// Returns    linear, in [0, 1].
/// Source     kNeutral: Khronos Group. PBR Neutral Tone Mapper. 2024. kAces: Narkowicz. ACES Filmic Tone Mapping Curve.
/// 2016.
glm::vec3 tone_map(Tone tone, const glm::vec3& color);

}  // namespace zoe
