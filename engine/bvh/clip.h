#pragma once

#include "engine/math/triangle.h"

namespace zoe {

struct ClippedBoxes {
    Aabb left, right;  ///< Empty where nothing is left of the triangle on that side.
};

/// Cuts the part of a triangle inside a box by an axis-aligned plane and bounds both pieces. Every point of the triangle,
/// exact, that is inside the box is inside one of the two, but for 2^-50 of its coordinates, which `padded` covers.
/// triangle   finite.
/// box        a box that bounds a part of it; plane strictly inside of box along the axis.
/// Source     Stich, Friedrich, Dietrich. Spatial Splits in Bounding Volume Hierarchies. HPG 2009.
ClippedBoxes split_box(const Triangle& triangle, const Aabb& box, int axis, float plane);

/// Widens the box of a piece of a triangle, so that no hit of a ray on the piece is lost when boxes are culled by it.
///
/// What has to hold: for each hit that `intersect` reports, some piece's box is entered, and at no later a t than the hit's.
/// The box of a whole triangle has that by definition: `intersect` demands it. For a piece, let P be the point of the
/// triangle whose weights the hit has, and r = 2^-24. `intersect` decides exactly on corners that it rounds by at most
/// 4r |P - origin| + 6r L along an axis (L: the triangle's longest extent), so the ray passes P as near as that along every
/// axis; and its t is P's, but for 3r |t| and 3r L along the ray's longest axis. The shares of the distance are covered by
/// kBoxPad of the slab test, which has 12r for them and for its own 4r; those of L by this pad of 16r L. The piece that
/// P is in is thus entered in time. All sides are widened, also those that the whole triangle's box shares: the ray may pass
/// P on the outer side of one of them.
/// Requires   of `intersect` that t is P's to 3r: weights from exact areas, as they are where it works in double.
Aabb padded(const Aabb& box, const Triangle& triangle);

}  // namespace zoe
