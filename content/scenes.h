#pragma once

#include "content/content.h"

namespace zoe {

/// The scenes written in code, by name (see `content_list`). size: what the knob is.
Content make_static_scene(int size);
Content make_rigid_scene(int size);
Content make_instances_scene(int size);
Content make_deforming_scene(int size);
Content make_skinned_scene(int size);
Content make_character_scene(int size);
Content make_dancers_scene(int size);
Content make_surface_scene(int size);
Content make_arbitrary_scene(int size);
Content make_topology_scene(int size);
Content make_mixed_scene(int size);

/// What they are made of: each adds nodes to a scene and, where they move, channels to its only clip, 4 s long.

/// A room 8 m wide and deep and 4 m high around the Y axis, open to +Z, lit through the gaps of its ceiling.
void add_room(Scene& scene, int triangle_count);
/// A swarm of tori of 1,000 triangles each.
/// placed     how the swarm stands in the world; its size there is `orbit_lattice(copy_count).extent()`.
void add_orbits(Scene& scene, int copy_count, const Trs& placed);
/// A cloth 4 m wide.
void add_wave(Scene& scene, int quads_a_side, const glm::vec3& place);
/// A ball of radius 0.8 m that bursts; its triangles fly up to 2.4 m from its middle.
/// Returns    what writes the exploding mesh at a time.
std::function<void(Scene&, double)> add_explosion(Scene& scene, int triangle_count, const Trs& placed);

inline constexpr double kLoop_s = 4.0;

/// The scene's clip, made and set to play where there is none yet.
Clip& loop_of(Scene& scene);
/// Adds a sampler to the scene's clip; returns its index there.
uint32_t add_sampler(Scene& scene, Sampler sampler);
void add_channel(Scene& scene, NodeId node, ChannelPath path, uint32_t sampler);
/// A rotation by whole turns about an axis over the loop, `degrees` at its start.
Sampler spin(const glm::vec3& axis, int turns, float degrees);
/// A material of one colour, both sides of which are shown.
MaterialId add_color(Scene& scene, const char* name, uint32_t srgb_hex);
/// Gives all of a mesh one material.
void set_material(Mesh& mesh, MaterialId material);
/// Adds the camera node `view`: +Y up, a vertical field of view in degrees, the picture's aspect. Added last, so that the
/// ids of what is shown do not depend on it.
void add_view(Scene& scene, const glm::vec3& eye, const glm::vec3& target, float fov_degrees);

/// The points of a lattice around the origin, about as many along each axis; rows along X fill up first.
struct Lattice {
    glm::ivec3 count{1};
    float pitch = 1.0f;  ///< Metres from point to point.

    glm::vec3 extent() const { return pitch * glm::vec3(count); }
    glm::vec3 place(int i) const;
};
/// The smallest such lattice that holds `point_count` points.
Lattice make_lattice(int point_count, float pitch);
/// Where the copies of `add_orbits` fly.
Lattice orbit_lattice(int copy_count);
/// `add_view` from just before a lattice's front, so near that it fills the picture.
void add_view(Scene& scene, const Lattice& lattice);

}  // namespace zoe
