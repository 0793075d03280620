#pragma once

#include <span>
#include <vector>

#include "engine/math/affine.h"
#include "engine/scene/mesh.h"

namespace zoe {

/// Shapes for scenes made in code. All are closed (but for `make_grid`), wind counter-clockwise seen from outside, and
/// carry smooth normals with creases where the surface has them.

/// An axis-aligned box, 12 triangles, flat.
Mesh make_box(const glm::vec3& lo, const glm::vec3& hi);

/// A sphere around the origin; every vertex is shared by its triangles.
/// segments   around the Y axis, at least 3. rings: from pole to pole, at least 2.
Mesh make_sphere(float radius, int segments, int rings);

/// A torus around the Y axis; every vertex is shared. 2 * segments * sides triangles.
Mesh make_torus(float major_radius, float minor_radius, int segments, int sides);

/// A surface of revolution around the Y axis.
/// profile    (radius, y), from the bottom up along the outside (and down again along an inside); radius 0 closes it.
Mesh make_lathe(std::span<const glm::vec2> profile, int segments);

/// A cylinder around the Y axis, from y0 to y1.
Mesh make_cylinder(float radius, float y0, float y1, int segments);

/// A prism with a hole: upright walls over two outlines, and rings between them.
/// outer, inner   same count, (x, z), in order of rising angle from +X to +Z; inner lies inside.
Mesh make_ring(std::span<const glm::vec2> outer, std::span<const glm::vec2> inner, float y0, float y1);

/// A part of a tube's wall around the Y axis: a curved box.
Mesh make_arc(float inner_radius, float outer_radius, float angle0, float angle1, float y0, float y1, int segments);

/// A tube along a path, with round ends.
/// path, radii   same count, at least 2; neighbours differ.
Mesh make_tube(std::span<const glm::vec3> path, std::span<const float> radii, int sides);

/// A flat grid in the XZ plane around the origin, facing +Y; columns * rows * 2 triangles, open.
Mesh make_grid(int columns, int rows, float size_x, float size_z);

/// A circle's outline for `make_ring`.
std::vector<glm::vec2> circle(float radius, int count);

/// Adds a part to a mesh, moved into place (mirrors are turned the right way out). Its triangles join the mesh's last
/// material range where the material is the same. Colours are kept: white where only one side has some.
void append(Mesh& mesh, const Mesh& part, const Affine& placed = {}, MaterialId material = kNone<MaterialId>);

/// Makes every normal the mean of its triangles' normals, weighted by their areas. Zero where a vertex has none.
void smooth_normals(Mesh& mesh);

/// Gives every vertex one colour (linear).
void paint(Mesh& mesh, const glm::vec3& color);

/// Linear colour of an sRGB one, 0xRRGGBB.
glm::vec3 srgb(uint32_t hex);

/// Placement in short.
Affine at(const glm::vec3& translation);
Affine at(const glm::vec3& translation, float degrees, const glm::vec3& axis, const glm::vec3& scale = glm::vec3(1.0f));

}  // namespace zoe
