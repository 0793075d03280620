#pragma once

#include "engine/scene/scene.h"

namespace zoe {

/// Puts copies of all nodes beside them, in rows along X that go back along -Z. A copy has skins and channels of its own,
/// and the same meshes; each plays its clips later than the one before, by equal shares of them. Keys are sampled for that
/// at equal distances, as many as there were: between them, a copy moves nearly as the original does. Cameras are taken out,
/// lights stay with the original.
/// copy_count with the original; 1 leaves the scene alone.
/// Cost       O(nodes and keys, times copies), and the boxes of nine frames.
void place_copies(int copy_count, Scene* scene);

}  // namespace zoe
