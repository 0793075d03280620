#pragma once

#include "content/content.h"

namespace zoe {

/// The scenes written in code, by name (see `content_list`). size: what the knob is.
Content make_static_scene(int size);
Content make_rigid_scene(int size);
Content make_instances_scene(int size);
Content make_deforming_scene(int size);
Content make_skinned_scene(int size);
Content make_arbitrary_scene(int size);
Content make_topology_scene(int size);
Content make_mixed_scene(int size);

/// What they are made of: each adds nodes to a scene and, where they move, channels to its only clip, 4 s long.
void add_slats(Scene& scene, int triangle_count);
void add_orbits(Scene& scene, int copy_count);
void add_wave(Scene& scene, int quads_a_side, const glm::vec3& place);
/// Returns    what writes the exploding mesh at a time.
std::function<void(Scene&, double)> add_explosion(Scene& scene, int triangle_count, const glm::vec3& place);

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

}  // namespace zoe
