#pragma once

#include <optional>
#include <string>
#include <vector>

#include "content/content.h"
#include "engine/zoetrope.h"

namespace zoe {

/// Opens what a user calls a scene: NAME or NAME-SIZE of the content list, a .glb, .gltf or .obj file, or a mesh sequence
/// (wave_%04d.glb).
/// fps        Of a sequence's meshes: one a frame.
/// level      Of all its subdivision surfaces, and makes the polygons of an .obj file the cage of one; none: as they say.
/// Returns    the scene with this project's writer where it has one; its written meshes are those of time 0.
/// Throws     SceneError for what cannot be read, or shows no triangles that could be hit; UsageError for a level where
/// there
///            is no surface.
Content open_scene(const std::string& name, double fps, std::optional<int> level = std::nullopt);

/// Makes the frame at a time: the scene's own writer, then `advance`.
const Tlas& advance(Content& content, double time_s, FrameStats* stats);

/// Chooses what plays: a clip by its name or position, or "all".
/// Throws     UsageError that lists the clips.
void choose_clips(Scene& scene, const std::string& choice);

/// "0 'walk', 1 'run'"; "none" for no clips.
std::string list_clips(const Scene& scene);

/// How long it takes until clips and sequences, played together, repeat; 0 where nothing does (written meshes may still
/// move).
double duration_s(const Scene& scene, std::span<const ClipId> clips);

/// Prints the scene's warnings to stderr, each once with its count. Those in `printed` are left out, and added to it.
void print_warnings(const std::string& program, const Scene& scene, std::vector<std::string>* printed);

/// `text` as one line: control characters, which a hostile file may contain, become spaces.
std::string one_line(const std::string& text);

}  // namespace zoe
