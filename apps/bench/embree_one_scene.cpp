// Every node's triangles in world space, in one scene of Embree's.

#include <algorithm>
#include <optional>

#include "apps/bench/embree_layout.h"
#include "apps/bench/embree_mesh.h"
#include "apps/bench/stopwatch.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

/// Vertices that a task transforms.
constexpr size_t kVerticesATask = 4096;

struct Placed {
    EmbreeMesh mesh;
    bool is_shown = true;
    std::optional<Affine> world_from_local;  ///< Of its vertices; none: not since it was shown.
};

RTCBuildQuality quality_of(Motion motion, const EmbreeConfig& config) {
    if (motion == Motion::kStatic) return static_quality(config.is_static_high);
    if (motion == Motion::kArbitrary) return arbitrary_quality(config.is_arbitrary_medium);
    return RTC_BUILD_QUALITY_REFIT;
}

class EmbreeOneScene final : public EmbreeLayout {
public:
    EmbreeOneScene(const EmbreeDevice& device, const EmbreeConfig& config, const Scene& scene) {
        const std::vector<Shape>& shapes = scene.frame->shapes;
        const bool is_static = std::all_of(shapes.begin(), shapes.end(),
                                           [](const Shape& shape) { return shape.motion.motion == Motion::kStatic; });
        const int robust = config.is_robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE;
        // LOW and DYNAMIC: a tree a geometry, each built or refitted by its own quality, opened and merged by Embree.
        top_ = is_static ? device.new_scene(static_quality(config.is_static_high), robust)
                         : device.new_scene(RTC_BUILD_QUALITY_LOW, RTC_SCENE_FLAG_DYNAMIC | robust);
        for (const Shape& shape : shapes) {
            EmbreeMesh mesh(device.handle(), quality_of(shape.motion.motion, config));
            rtcAttachGeometryByID(top_.get(), mesh.geometry(), static_cast<unsigned>(placed_.size()));
            placed_.push_back({.mesh = std::move(mesh), .world_from_local = {}});
            nodes_.push_back(shape.node);
        }
    }

    EmbreePeer::UpdateTimes update(const Scene& scene, const Tlas& tlas) override {
        find_changes(scene, tlas);
        parallel_for(0, changed_.size(), 1, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) copy(scene, changed_[k]);
        });
        Stopwatch watch;
        for (const size_t shape : visibility_changed_) {
            const RTCGeometry geometry = placed_[shape].mesh.geometry();
            placed_[shape].is_shown ? rtcEnableGeometry(geometry) : rtcDisableGeometry(geometry);
        }
        parallel_for(0, changed_.size(), 1, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                transform(changed_[k]);
                placed_[changed_[k].shape].mesh.commit();
            }
        });
        rtcCommitScene(top_.get());
        return {.update_ms = watch.restart_ms()};
    }

private:
    struct Change {
        size_t shape;
        const Instance* instance;
        bool is_resized;
    };

    void find_changes(const Scene& scene, const Tlas& tlas) {
        changed_.clear();
        visibility_changed_.clear();
        for (size_t k = 0; k < placed_.size(); ++k) {
            Placed& placed = placed_[k];
            const Shape& shape = scene.frame->shapes[k];
            const bool is_shown = tlas.instance_of_node[index(shape.node)] != kNoInstance;
            if (is_shown != placed.is_shown) {
                placed.is_shown = is_shown;
                placed.world_from_local.reset();  // What it shows may change meanwhile.
                visibility_changed_.push_back(k);
            }
            if (!is_shown) continue;
            const Instance& instance = tlas[shape.node];
            const bool is_resized = !placed.world_from_local || shape.is_topology_changed;
            if (is_resized || shape.is_changed || *placed.world_from_local != instance.world_from_local) {
                changed_.push_back({k, &instance, is_resized});
                placed.world_from_local = instance.world_from_local;
            }
        }
    }

    /// Outside of the times: triangles, and vertices that are in the world as they are.
    void copy(const Scene& scene, const Change& change) {
        const Shape& shape = scene.frame->shapes[change.shape];
        EmbreeMesh& mesh = placed_[change.shape].mesh;
        if (change.is_resized) mesh.resize(shape.shown->corners, shape.positions.size());
        if (change.instance->is_identity) std::copy(shape.positions.begin(), shape.positions.end(), mesh.vertices().begin());
    }

    void transform(const Change& change) {
        if (change.instance->is_identity) return;
        const std::span<const glm::vec3> local = change.instance->positions;
        const std::span<glm::vec3> world = placed_[change.shape].mesh.vertices();
        const Affine world_from_local = change.instance->world_from_local;
        parallel_for(0, local.size(), kVerticesATask, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) world[k] = world_from_local.point(local[k]);
        });
    }

    std::vector<Placed> placed_;              ///< [shape_count]
    std::vector<Change> changed_;             ///< Scratch of `update`, as is the next.
    std::vector<size_t> visibility_changed_;  ///< Shapes.
};

}  // namespace

std::unique_ptr<EmbreeLayout> make_embree_one_scene(const EmbreeDevice& device, const EmbreeConfig& config,
                                                    const Scene& scene) {
    return std::make_unique<EmbreeOneScene>(device, config, scene);
}

}  // namespace zoe
