#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/bvh/blas.h"
#include "engine/bvh/choose_rebuilds.h"
#include "engine/frame/classify.h"
#include "engine/frame/node_report.h"
#include "engine/frame/refine.h"

namespace zoe {

inline constexpr uint32_t kNoPathNode = 0xffffffffu;

/// Joint matrices of a skin in the space of an animated node that all its joints hang from: products of the local
/// matrices between them, which no clip changes. Empty where there is no such node.
struct SkinPath {
    std::vector<NodeId> nodes;            ///< Parents first; nodes[0] is the frame node, its matrix taken as the identity.
    std::vector<uint32_t> parents;        ///< [nodes] position of each one's parent in `nodes`.
    std::vector<uint32_t> joints;         ///< [joint_count] position in `nodes`; kNoPathNode for joints that move no vertex.
    std::vector<Affine> frame_from_node;  ///< [nodes] scratch.
};

/// What a shape keeps that does not show its mesh just as it is.
struct OwnShape {
    bool has_skin = false;
    SkinPath skin_path;
    std::vector<uint8_t> used_joints;      ///< [joint_count] of a skin.
    std::vector<glm::vec3> joint_centres;  ///< [joint_count] of a dual quaternion skin.
    std::vector<float> weights;            ///< This frame's morph weights.
    std::vector<Affine> joints;            ///< This frame's joint matrices, skin space from mesh.
    PackedJoints packed_joints;            ///< The same, as they are read.
    bool is_deformed = false;              ///< Its vertices were worked out in this frame.

    std::vector<glm::vec3> morphed_positions, morphed_normals;  ///< Of what is both morphed and skinned.
    std::vector<glm::vec3> deformed_positions, deformed_normals;

    int level = 0;           ///< Of subdivision; 0: the mesh has no surface.
    int wanted_level = 0;    ///< By its pixels, before all surfaces' triangles were counted.
    Seen seen;               ///< From where, when the level was chosen by its pixels.
    bool is_capped = false;  ///< It would have had to be finer.
    const Refined* refined = nullptr;
    int refined_level = 0;  ///< Of `refined`.
    std::vector<glm::vec3> refined_positions, refined_normals;
    uint64_t cage_version = 0;

    Blas blas;
    BlasScratch blas_scratch;  ///< Kept where the tree is rebuilt whenever vertices move; else released after the build.
    TreeWatch watch;           ///< Of a tree that is refitted.
};

/// What a node that shows a mesh keeps from frame to frame. All of them are read in every frame, so it is small.
struct Shape {
    NodeId node = kNone<NodeId>;
    NodeMotion motion;
    MeshId mesh = kNone<MeshId>;            ///< Shown in this frame.
    bool is_changed = true;                 ///< Its vertices are other than in the last frame.
    bool is_topology_changed = true;        ///< So may be its triangles.
    TreeAction action = TreeAction::kKept;  ///< Of this frame.
    bool has_blas = false;                  ///< `blas` holds the last frame's triangles.
    uint32_t warned_not_finite_count = 0;   ///< Triangles that a warning told of.
    uint64_t mesh_version = 0;
    std::span<const glm::vec3> positions, normals;  ///< This frame's: the mesh's own, the deformed, or the surface's.
    const Mesh* shown = nullptr;                    ///< Whose triangles are shown: the mesh, or its surface at a level.
    Blas* blas = nullptr;                           ///< Its own, or one shared by all nodes that show the mesh undeformed.
    std::unique_ptr<OwnShape> own;                  ///< Null: it shows its mesh as it is, by the mesh's BLAS.

    bool is_shared() const { return !own || blas != &own->blas; }
};

}  // namespace zoe
