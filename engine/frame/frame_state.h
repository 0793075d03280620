#pragma once

#include <compare>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/bvh/blas.h"
#include "engine/bvh/build_clusters.h"
#include "engine/bvh/choose_rebuilds.h"
#include "engine/bvh/reach.h"
#include "engine/frame/build_tlas.h"
#include "engine/frame/classify.h"
#include "engine/frame/open_instances.h"
#include "engine/frame/refine.h"
#include "engine/frame/shape.h"

namespace zoe {

/// The surface of a mesh at a level of subdivision.
struct SurfaceLevel {
    MeshId mesh;
    int level;
    auto operator<=>(const SurfaceLevel&) const = default;
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

/// Rays that were traced, frame by frame.
struct RayMean {
    static constexpr double kNewShare = 0.25;

    double mean = 0.0;  ///< An exponential moving average over the frames that were reported.
    bool is_told = false;

    void add(double rays) {
        mean = is_told ? mean + kNewShare * (rays - mean) : rays;
        is_told = true;
    }
};

/// What update_blas hands to the next frame's.
struct BlasWork {
    std::vector<Shape*> changed;            ///< Trees that change in this frame.
    std::vector<Shape*> refitted;           ///< Trees that are refitted where their vertices move.
    std::vector<const TreeWatch*> watches;  ///< Theirs.
    std::vector<uint32_t> worn;             ///< Positions of those that are rebuilt in this frame.
    std::vector<BlasScratch> scratches;     ///< Of as many rebuilds as are made at once.
    uint32_t reserved_triangle_count = 0;   ///< Each has room for a mesh as large.
};

/// A tree over poses of a clip.
struct ClipTree {
    Bvh tree;
    double worst_cost = 0.0;  ///< By SAH, of its poses.
};

/// What `advance` keeps between frames: nothing that a frame's result depends on but its cost.
struct FrameState {
    std::vector<NodeId> parents_first;
    std::vector<NodeMotion> motions;        ///< [node_count]
    std::vector<Trs> locals;                ///< [node_count] this frame's, where the node has no matrix.
    std::vector<DAffine> scene_from_nodes;  ///< [node_count] this frame's, before the scene's origin is taken off.
    std::vector<Affine> local_matrices, world_matrices;  ///< [node_count] this frame's.
    std::vector<std::vector<float>> weights;             ///< [node_count] this frame's; empty where nothing is morphed.
    double time_s = 0.0;                                 ///< Of this frame.
    std::vector<float> sampled;                          ///< Scratch.
    std::vector<Shape> shapes;                           ///< In order of their nodes.
    std::vector<Shape*> own_shapes;                      ///< Those of them that have `own`.
    std::vector<MorphReach> morph_reaches;               ///< [mesh_count] of meshes with targets.
    std::map<SurfaceLevel, std::unique_ptr<Refined>> refined;
    std::map<MeshId, LevelChoice> level_choices;           ///< Of meshes whose surfaces have `pixels`.
    std::vector<Shape*> finest;                            ///< Scratch: of those, the shapes of one level.
    std::vector<Blas> shared_blases;                       ///< [mesh_count] of meshes shown undeformed.
    std::vector<uint8_t> is_shared_blas_built;             ///< [mesh_count]
    std::vector<std::optional<Aabb>> shared_bounds;        ///< [mesh_count] or none: what `bounds_at` found of them.
    BlasBuilder still_builder = BlasBuilder::kReinserted;  ///< What trees that never change are built with.
    std::vector<ClipTree> clip_trees;  ///< [mesh_count] for deforming nodes, until they have theirs; see build_clip_trees.
    BlasWork blas_work;                ///< Scratch of update_blas.
    RayMean traced_rays;
    size_t written_mesh_count = 0;  ///< Meshes that the user had written when nodes were classified.
    TlasScratch tlas_scratch;
    Tlas tlas;
};

struct FrameStats;

/// Classifies the nodes and makes room for everything, once a scene.
void prepare(Scene& scene, FrameState* state);
/// Holds a scene's state and its trees while a frame of it is made. The state is made by the first one, and anew where
/// nodes, meshes or a first write came since. Where `finish` is not reached, nothing is known of what was left behind, and
/// it starts anew, too.
class FrameInMaking {
public:
    /// stats      surfaces that were refined on the way are added.
    /// Throws     SceneError where the scene does not pass `check`; std::logic_error where another thread holds them,
    ///            or rays are on their way through the trees.
    FrameInMaking(Scene& scene, FrameStats* stats);
    ~FrameInMaking();
    FrameInMaking(const FrameInMaking&) = delete;
    FrameInMaking& operator=(const FrameInMaking&) = delete;

    FrameState& state() { return *state_; }
    void finish() { is_finished_ = true; }

private:
    Scene& scene_;
    std::shared_ptr<FrameState> state_;
    bool is_finished_ = false;
};
/// Meshes that were given to `Scene::write_mesh`; when it changes, nodes are classified anew.
size_t count_written_meshes(const Scene& scene);

/// The stages, in order. Each reads what the ones before it wrote.
void animate(const Scene& scene, double time_s, FrameState* state);
void deform(Scene& scene, FrameState* state, FrameStats* stats);
void update_blas(Scene& scene, FrameState* state, FrameStats* stats);
void build_tlas(Scene& scene, FrameState* state, FrameStats* stats);

/// By motion class: what a BLAS is built with, and what moving vertices do to it.
struct TreeMethod {
    bool is_refitted;  ///< Moved vertices refit the tree; else they rebuild it.
    bool is_cached;    ///< The tree is built once, and kept on disk where the scene has a cache.
    BlasBuilder builder;
};
TreeMethod method_for(Motion motion, const FrameState& state);

/// Where a shape whose vertices are in this box is in the world of this frame; empty where it cannot be hit.
Aabb bounds_world(const Shape& shape, const FrameState& state, const Aabb& bounds_local);

}  // namespace zoe
