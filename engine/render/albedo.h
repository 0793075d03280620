#pragma once

namespace zoe {

/// How much of what arrives from one direction microfacets reflect in all, seen once only: light that would meet a second
/// facet is lost. For a reflectance f0 + (f90 - f0) (1 - cosine)^5 that is f0 * (all - edge) + f90 * edge.
struct Albedo {
    float all = 1.0f;   ///< Of facets that reflect everything.
    float edge = 0.0f;  ///< The part that (1 - cosine)^5 weighs.
};

/// Of facets of one roughness. The tables behind it are made by the first one that is made: about 40 ms, the same numbers on
/// any number of threads.
class GgxAlbedo {
public:
    /// Facets that reflect all: of no use but to be replaced.
    GgxAlbedo() = default;
    /// roughness  in [0, 1].
    explicit GgxAlbedo(float roughness);

    /// For light at a cosine to the normal, in [0, 1].
    /// Requires   one that was made for a roughness.
    /// Cost       four reads of a table.
    Albedo at(float cosine) const;
    /// For light from everywhere.
    const Albedo& mean() const { return mean_; }

private:
    const Albedo *smoother_ = nullptr, *rougher_ = nullptr;  // rows of the table, over the root of the cosine
    float rest_ = 0.0f;                                      // from the one to the other
    Albedo mean_;
};

/// What of its nominal strength is left of sheen, so that even at grazing angles no more comes out than went in.
float sheen_scale(float roughness);

/// Of white sheen so scaled; at most 1.
float sheen_albedo(float cosine, float roughness);

}  // namespace zoe
