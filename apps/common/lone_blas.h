#pragma once

#include "engine/bvh/traverse.h"

namespace zoe {

/// A frame that shows one tree, in the world as it is.
class LoneBlas {
public:
    /// blas       not empty; stays with the caller, as it is.
    explicit LoneBlas(const Blas& blas);

    /// Hits have id 0.
    TwoLevels levels() const;

private:
    WideBvh top_;
    PlacedBlas placed_;
    Aabb bounds_;
};

}  // namespace zoe
