#pragma once

#include "engine/scene/gltf_file.h"

namespace zoe {

/// Reads the skins. Missing inverse bind matrices are identities.
/// Throws     SceneError.
std::vector<Skin> read_skins(GltfFile& file, Scene& scene);

/// Makes a mesh's weights sum to 1 a vertex; a vertex without any follows joint 0.
void normalize_weights(Mesh& mesh, Scene& scene);

/// Checks that the joints which the meshes name exist in the skins of the nodes that show them; drops skins that move
/// nothing.
/// Throws     SceneError.
void check_skin_use(const GltfFile& file, Scene& scene);

}  // namespace zoe
