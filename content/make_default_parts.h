#pragma once

#include "content/make_default_writer.h"
#include "content/shapes.h"

namespace zoe {

/// The parts of the default scene. Metres, Y up; the floor is y = 0, the table stands around the Y axis, the room opens
/// towards +Z, where the camera is.

inline constexpr float kTableTop = 0.76f;
inline constexpr MaterialId kPaintByVertex{0};  ///< The first material: white, for coloured vertices.

void add_room(GlbWriter& glb);       ///< Floor, walls, windows, rafters. Static.
void add_furniture(GlbWriter& glb);  ///< Rug, table, stool, shelf, pictures, bunting, lamp and its light. Static.
void add_zoetrope(GlbWriter& glb);   ///< Drum, rabbits, balls, gears, crank. Rigid.
void add_clock(GlbWriter& glb);      ///< A pendulum clock on the back wall. Rigid.
void add_yarn(GlbWriter& glb);       ///< A ball of wool that rolls to and fro. Rigid.
void add_cat(GlbWriter& glb);        ///< A cat that watches the drum. Skinned.
void add_flower(GlbWriter& glb);     ///< A flower that opens and closes and sways. Morph targets.
void add_jelly(GlbWriter& glb);      ///< A jelly that wobbles. Morph targets, cubic splines.
void add_lava_lamp(GlbWriter& glb);  ///< Wax that merges and parts: a mesh a frame.

/// Pictures for the rug and the wall, as PNG files.
std::vector<uint8_t> rug_png();
std::vector<uint8_t> landscape_png();

}  // namespace zoe
