#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "engine/bvh/blas.h"
#include "engine/bvh/build_clusters.h"
#include "engine/bvh/reach.h"
#include "engine/frame/build_tlas.h"
#include "engine/frame/classify.h"
#include "engine/frame/open_instances.h"

namespace zoe {

inline constexpr uint32_t kNoPathNode = 0xffffffffu;

/// Joint matrices of a skin in the space of an animated node that all its joints hang from: products of the local
/// matrices between them, which no clip changes.
struct SkinPath {
    std::vector<NodeId> nodes;            ///< Parents first; nodes[0] is the frame node, its matrix taken as the identity.
    std::vector<uint32_t> parents;        ///< [nodes] position of each one's parent in `nodes`.
    std::vector<uint32_t> joints;         ///< [joint_count] position in `nodes`; kNoPathNode for joints that move no vertex.
    std::vector<Affine> frame_from_node;  ///< [nodes] scratch.
};

/// What a node that shows a mesh keeps from frame to frame.
struct Shape {
    NodeId node = kNone<NodeId>;
    NodeMotion motion;
    bool has_skin = false;
    SkinPath skin_path;  ///< Used where motion.frame is a node.

    MeshId mesh = kNone<MeshId>;  ///< Shown in this frame.
    std::vector<float> weights;   ///< This frame's morph weights.
    std::vector<Affine> joints;   ///< This frame's joint matrices, skin space from mesh.

    std::vector<glm::vec3> deformed_positions, deformed_normals;
    std::span<const glm::vec3> positions, normals;  ///< This frame's: the mesh's own, or the deformed.

    bool is_changed = true;           ///< Its vertices are other than in the last frame.
    bool is_topology_changed = true;  ///< So may be its triangles.
    uint64_t mesh_version = 0;
    bool has_blas = false;  ///< `blas` holds the last frame's triangles.
    Blas own_blas;
    BlasScratch blas_scratch;  ///< Kept where the tree is rebuilt when vertices move; else released after the build.
    Blas* blas = nullptr;      ///< own_blas, or one shared by all nodes that show the mesh undeformed.
};

/// Memory that one frame's top level hands to the next.
struct TlasScratch {
    /// Of shapes that are placed apart from the others.
    struct Part {
        bool is_shown_other;  ///< A shape that was shown can't be hit any more, or the other way round.
        bool is_moved;        ///< What the tree is built of is other than in the last frame.
        size_t deepest;       ///< Entries that a ray may have to keep in one of the BLASes.
        Aabb bounds_world;    ///< Around all of them.
        bool has_identity;    ///< Some of them stand in the world's space.
    };
    bool is_valid = false;  ///< The top level is whole: the last frame did not throw while it worked on it.
    std::vector<Part> parts;
    std::vector<uint8_t> is_shown;                ///< [shapes]
    std::vector<std::unique_ptr<Reach>> reaches;  ///< [meshes] of trees whose boxes are tight where they are turned.
    bool is_reach_measured = false;               ///< All that are not null are.
    bool has_reaches = false;                     ///< Some are not null.
    std::vector<uint32_t> identities;             ///< Instances that stand in the world's space.
    OpeningScratch opening;
    PlocScratch clusters;
    CollapseScratch collapse;
};

/// What `advance` keeps between frames: nothing that a frame's result depends on but its cost.
struct FrameState {
    std::atomic<bool> is_in_use{false};  ///< Some thread is making a frame.
    std::vector<NodeId> parents_first;
    std::vector<NodeMotion> motions;        ///< [node_count]
    std::vector<Trs> locals;                ///< [node_count] this frame's, where the node has no matrix.
    std::vector<DAffine> scene_from_nodes;  ///< [node_count] this frame's, before the scene's origin is taken off.
    std::vector<Affine> local_matrices, world_matrices;    ///< [node_count] this frame's.
    std::vector<std::vector<float>> weights;               ///< [node_count] this frame's; empty where nothing is morphed.
    double time_s = 0.0;                                   ///< Of this frame.
    std::vector<float> sampled;                            ///< Scratch.
    std::vector<Shape> shapes;                             ///< In order of their nodes.
    std::vector<Blas> shared_blases;                       ///< [mesh_count] of meshes shown undeformed.
    std::vector<uint8_t> is_shared_blas_built;             ///< [mesh_count]
    BlasBuilder still_builder = BlasBuilder::kReinserted;  ///< What trees that never change are built with.
    std::vector<Shape*> blas_work;                         ///< Scratch of update_blas: trees that change in this frame.
    size_t written_mesh_count = 0;                         ///< Meshes that the user had written when nodes were classified.
    TlasScratch tlas_scratch;
    Tlas tlas;
};

/// Classifies the nodes and makes room for everything, once a scene.
void prepare(Scene& scene, FrameState* state);
/// Meshes that were given to `Scene::write_mesh`; when it changes, nodes are classified anew.
size_t count_written_meshes(const Scene& scene);

/// The stages, in order. Each reads what the ones before it wrote.
void animate(const Scene& scene, double time_s, FrameState* state);
void deform(const Scene& scene, FrameState* state);
struct FrameStats;
void update_blas(Scene& scene, FrameState* state, FrameStats* stats);
void build_tlas(Scene& scene, FrameState* state, FrameStats* stats);

}  // namespace zoe
