#pragma once

#include <glm/vec3.hpp>

#include "engine/render/environment.h"

namespace zoe {

/// Where the sun stands unless told, degrees: above the horizon, and round from -Z over +X, as pictures of skies have it.
inline constexpr double kSunElevation = 48.0, kSunAzimuth = 138.0;

/// The unit direction of such a place.
glm::vec3 sky_direction(double elevation_degrees, double azimuth_degrees);

/// A clear day's or evening's sky with its sun, as seen from the ground: sunlight that air, haze and the ground scattered,
/// less what ozone and haze took. Below the horizon lies plain ground in that light. In units where a white wall that faces
/// the sun above the air is 1.
///
/// Made of physics rather than of a fit to measured or simulated skies, because that holds wherever the sun is: fitted skies
/// end at the horizon, and have tables.
/// toward_sun unit; below the horizon too: then it is dusk, and in the end night.
/// Cost       about 0.16 s of one thread; in parallel over rows.
/// Source     Nishita, Sirai, Tadamura, Nakamae. Display of the Earth Taking into Account Atmospheric Scattering. SIGGRAPH
///            1993. Hillaire. A Scalable and Production Ready Sky and Atmosphere Rendering Technique. EGSR 2020, for light
///            that was scattered more than once, and ozone. Deviation: three wavelengths stand for red, green and blue.
Environment make_physical_sky(const glm::vec3& toward_sun);

}  // namespace zoe
