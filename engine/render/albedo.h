#pragma once

namespace zoe {

/// How much of what arrives from one direction microfacets reflect in all, seen once only: light that would meet a second
/// facet is lost. For a reflectance f0 + (f90 - f0) (1 - cosine)^5 that is f0 * (all - edge) + f90 * edge.
struct Albedo {
    float all = 1.0f;   ///< Of facets that reflect everything.
    float edge = 0.0f;  ///< The part that (1 - cosine)^5 weighs.
};

/// For light at a cosine to the normal; both in [0, 1].
/// Cost       four reads of a table that the first call makes: about 40 ms. The same numbers on any number of threads.
Albedo ggx_albedo(float cosine, float roughness);

/// For light from everywhere.
Albedo mean_ggx_albedo(float roughness);

/// What of its nominal strength is left of sheen, so that even at grazing angles no more comes out than went in.
float sheen_scale(float roughness);

/// Of white sheen so scaled; at most 1.
float sheen_albedo(float cosine, float roughness);

}  // namespace zoe
