#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "apps/bench/peer_options.h"
#include "apps/bench/ray_kind.h"
#include "engine/frame/frame.h"

namespace zoe {

/// How rays are handed to Embree: one by one, or sixteen at a time, with its advice that they are coherent or without.
enum class EmbreeRays : uint8_t { kSingle, kPackets, kCoherentPackets };
inline constexpr std::array kEmbreeRays = {EmbreeRays::kSingle, EmbreeRays::kPackets, EmbreeRays::kCoherentPackets};
/// Those to choose from: diffuse rays go apart, and from any-hit packets with that advice version 3.13.5 does not always
/// come back.
inline std::span<const EmbreeRays> forms_of(RayKind kind) {
    return std::span(kEmbreeRays).first(kind == RayKind::kPrimary ? 3 : 2);
}

/// How Embree holds a scene, and takes its rays. What is best depends on the scene: `embree_configs` lists what to try.
struct EmbreeConfig {
    /// kInstances: each mesh has a scene of its own, shown by instances whose top level is rebuilt each frame.
    /// kOneScene: all triangles in world space in one scene, moving nodes' transformed each frame; merged by Embree.
    enum class Layout : uint8_t { kInstances, kOneScene };
    Layout layout = Layout::kInstances;
    bool is_top_medium = false;        ///< The instances' top level is built at MEDIUM, not LOW.
    bool is_arbitrary_medium = false;  ///< Arbitrary nodes are built at MEDIUM, not LOW.
    bool is_static_high = false;  ///< Static nodes, and rigid ones' meshes, are built at HIGH (spatial splits), not MEDIUM.
    bool is_robust = false;       ///< RTC_SCENE_FLAG_ROBUST on every scene.
    std::array<EmbreeRays, kRayKindCount> rays{};  ///< By kind.

    /// "one scene, rigid and deforming REFIT, arbitrary LOW, static MEDIUM, fast; coherent packets of 16 for primary, single
    /// diffuse, single shadow rays".
    std::string describe() const;
};

/// The configurations worth trying for a scene: layouts, and qualities for the classes that it has. Rays are left at single
/// ones. HIGH only where Embree builds it: in one scene with others that move it would be MEDIUM, and nothing said.
std::vector<EmbreeConfig> embree_configs(const Scene& scene, const Tlas& tlas, const PeerOptions& options);

/// Whether this program was built with Embree.
bool is_embree_available();

/// The same frames, held and traced by Embree: vertices and matrices are those that the engine's frame shows.
class EmbreePeer {
public:
    /// threads    as many as `thread_count()`: builds go by this number, rays by that one.
    /// Throws     UsageError where the program was built without Embree, naming the package; std::runtime_error where
    ///            Embree reports an error.
    EmbreePeer(const EmbreeConfig& config, int threads);
    ~EmbreePeer();
    EmbreePeer(const EmbreePeer&) = delete;
    EmbreePeer& operator=(const EmbreePeer&) = delete;

    /// "Embree 3.13.5, native packets of 4, 8, 16": the widths tell which instruction set it runs with.
    /// Throws     as the constructor.
    static std::string version();

    struct UpdateTimes {
        double update_ms = 0.0;      ///< Meshes: refits, rebuilds; all of the commit where there is one scene.
        double build_tlas_ms = 0.0;  ///< Matrices and the top level's commit; 0 where there is one scene.
    };
    /// Takes this frame's vertices and matrices. Vertices are copied into Embree's padded buffers outside of the times: a
    /// program made for Embree would have deformed into those.
    /// scene, tlas  as the last `advance` left them; they stay with the caller.
    /// Requires   a call after every `advance`: what changed is told from one frame to the next.
    /// Throws     std::runtime_error where Embree reports an error, or a vertex is beyond its range.
    UpdateTimes update(const Scene& scene, const Tlas& tlas);

    /// Traces in tasks of kRaysATask, as many threads as told. Rays and hits are put into and out of Embree's form outside
    /// of the time.
    ///
    /// rays       finite; directions other than 0.
    /// hits       [ray_count]
    /// Returns    ms.
    /// Throws     std::logic_error before the first `update`; std::runtime_error where a ray is beyond Embree's range;
    ///            Interrupted.
    double closest_hits(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits);
    /// is_hit     [ray_count] 1 or 0.
    double any_hits(std::span<const Ray> rays, RayKind kind, std::span<uint8_t> is_hit);

    /// From the next call on.
    /// rays       one of `forms_of(kind)`.
    void set_rays(RayKind kind, EmbreeRays rays);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace zoe
