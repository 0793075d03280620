#pragma once

#include <cstdint>

#include "engine/frame/build_tlas.h"
#include "engine/frame/trace.h"

namespace zoe {

/// What one frame did. Times in ms. `advance` adds to the first four times and the counts of trees; `trace` belongs to
/// whoever traces.
struct FrameStats {
    double animate_ms = 0, deform_ms = 0, update_blas_ms = 0, build_tlas_ms = 0, trace_ms = 0;
    uint32_t deformed = 0;  ///< Nodes whose vertices were worked out: their joints or weights changed.
    uint32_t kept = 0, refitted = 0, rebuilt = 0;  ///< Nodes, by what was done to their BLAS.
    uint32_t subdivided = 0;                       ///< Surfaces that were refined to a level that they had not been at.
    uint32_t refined = 0;                          ///< Nodes whose subdivision surface was evaluated.
    uint32_t loaded = 0, stored = 0;               ///< Trees of rebuilt nodes, read from the scene's cache or added to it.
    uint32_t tlas_builds = 0;                      ///< Frames that built the top level; others kept it.
    uint64_t rays = 0, hits = 0, hits_hash = 0;

    struct Kind {
        uint64_t rays = 0;
        double ms = 0;  ///< Summed over threads, divided by their number.
    };
    Kind primary, diffuse, shadow;

    double frame_ms() const { return animate_ms + deform_ms + update_blas_ms + build_tlas_ms + trace_ms; }
};

/// Makes the frame at a time: animate, deform, update_blas, build_tlas. The result depends on the scene and the time only,
/// never on the frames before.
///
/// Threads    any number may trace the tree, and read the scene, while none makes its next frame or edits it; scenes that
///            share nothing but a TreeCache may be played in threads of their own. Batches of rays and renderings are
///            watched: while there are any, `advance` and the scene's edits are refused and change nothing; batches are
///            refused while a frame is made. Single rays are not, that would cost each of them, nor are edits of the
///            scene's arrays by hand: there, whoever calls waits first. A second thread that makes a frame of the same
///            scene is refused where it comes in while the first one is at it; but the first call, and the first after an
///            edit that starts the scene's state anew, must be one thread's alone.
///
/// Where it throws, the next call begins anew, as after `touch`.
/// Returns    the tree to trace, owned by the scene; valid until the next call, or the next edit of the scene.
/// Cost       first call: classifies and builds everything. Later: what moved; no allocation once sizes have settled (but
///            for warnings).
/// Throws     SceneError where the scene does not pass `check`; std::invalid_argument for a time that is not finite;
///            std::logic_error where another thread is making a frame of the scene, or batches of rays are on their way
///            through its last one: they go on undisturbed, and the scene is as it was.
const Tlas& advance(Scene& scene, double time_s, FrameStats* stats = nullptr);

/// Tells how many rays were traced through the last frame: what trees of deforming nodes that have worn out cost. Never what
/// is hit. Where it is not told, `RebuildConfig` has a number.
/// Throws     std::logic_error before the first `advance`.
void report_rays(Scene& scene, uint64_t ray_count);

/// World matrix of a node at the last `advance`: cameras and lights. The world begins at `Scene::origin`.
/// Throws     std::logic_error before the first one.
const Affine& world_from_node(const Scene& scene, NodeId node);

/// Where a node is in the scene's own space, whatever `Scene::origin`, at the last `advance`.
/// Throws     std::logic_error before the first one.
glm::dvec3 place_in_scene(const Scene& scene, NodeId node);

/// The motion class of a node as worked out at the last `advance`.
/// Throws     std::logic_error before the first one, and after `set_motion` or `touch` until the next.
Motion motion(const Scene& scene, NodeId node);

}  // namespace zoe
