// A scene of Embree's a mesh, and instances that show them.

#include <algorithm>
#include <optional>
#include <span>
#include <stdexcept>
#include <unordered_map>

#include "apps/bench/embree_layout.h"
#include "apps/bench/embree_mesh.h"
#include "apps/bench/stopwatch.h"
#include "engine/frame/frame_state.h"
#include "engine/math/parallel.h"

namespace zoe {
namespace {

/// Instances that a task moves.
constexpr size_t kInstancesATask = 256;

/// Triangles that one node shows, or several do.
struct Bottom {
    size_t shape;  ///< The first that shows it.
    EmbreeScene scene;
    EmbreeMesh mesh;
    bool is_built = false;
    bool is_changed = false;  ///< In this frame.
};

struct Top {
    size_t bottom;
    EmbreeGeometry geometry;
    std::optional<Affine> placed;  ///< None: not since it was shown.
    bool is_shown = true;
};

class EmbreeInstances final : public EmbreeLayout {
public:
    EmbreeInstances(const EmbreeDevice& device, const EmbreeConfig& config, const Scene& scene) {
        const int robust = config.is_robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE;
        // Without DYNAMIC either quality takes up to 1.4 times as long to build.
        top_ = device.new_scene(config.is_top_medium ? RTC_BUILD_QUALITY_MEDIUM : RTC_BUILD_QUALITY_LOW,
                                RTC_SCENE_FLAG_DYNAMIC | robust);
        std::unordered_map<const Blas*, size_t> bottom_of_blas;
        const std::vector<Shape>& shapes = scene.frame->shapes;
        for (size_t k = 0; k < shapes.size(); ++k) {
            const auto [bottom, is_new] = bottom_of_blas.try_emplace(shapes[k].blas, bottoms_.size());
            if (is_new) bottoms_.push_back(new_bottom(device, config, shapes[k].motion.motion, k));
            EmbreeGeometry instance(rtcNewGeometry(device.handle(), RTC_GEOMETRY_TYPE_INSTANCE));
            if (!instance) throw std::runtime_error("Embree: no instance");
            rtcSetGeometryInstancedScene(instance.get(), bottoms_[bottom->second].scene.get());
            rtcAttachGeometryByID(top_.get(), instance.get(), static_cast<unsigned>(k));
            tops_.push_back({.bottom = bottom->second, .geometry = std::move(instance), .placed = {}});
            nodes_.push_back(shapes[k].node);
        }
    }

    EmbreePeer::UpdateTimes update(const Scene& scene, const Tlas& tlas) override {
        copy_changes(scene);
        reach_ = reach_into(tlas);
        EmbreePeer::UpdateTimes times;
        Stopwatch watch;
        commit_bottoms();
        times.update_ms = watch.restart_ms();
        place(scene, tlas);
        rtcCommitScene(top_.get());
        times.build_tlas_ms = watch.restart_ms();
        return times;
    }

private:
    static Bottom new_bottom(const EmbreeDevice& device, const EmbreeConfig& config, Motion motion, size_t shape) {
        const int robust = config.is_robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE;
        if (motion <= Motion::kRigid) {
            const RTCBuildQuality quality = static_quality(config.is_static_high);
            return {shape, device.new_scene(quality, robust), EmbreeMesh(device.handle(), quality)};
        }
        // Embree refits in a scene that is both LOW and DYNAMIC only; elsewhere it builds anew and says nothing.
        const RTCBuildQuality quality =
            motion == Motion::kDeforming ? RTC_BUILD_QUALITY_REFIT : arbitrary_quality(config.is_arbitrary_medium);
        return {shape, device.new_scene(RTC_BUILD_QUALITY_LOW, RTC_SCENE_FLAG_DYNAMIC | robust),
                EmbreeMesh(device.handle(), quality)};
    }

    void copy_changes(const Scene& scene) {
        changed_.clear();
        for (Bottom& bottom : bottoms_) {
            const Shape& shape = scene.frame->shapes[bottom.shape];
            bottom.is_changed = !bottom.is_built || shape.is_changed || shape.is_topology_changed;
            if (bottom.is_changed) changed_.push_back(&bottom);
        }
        parallel_for(0, changed_.size(), 1, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                Bottom& bottom = *changed_[k];
                const Shape& shape = scene.frame->shapes[bottom.shape];
                if (!bottom.is_built || shape.is_topology_changed) {
                    bottom.mesh.resize(shape.shown->corners, shape.positions.size());
                }
                std::copy(shape.positions.begin(), shape.positions.end(), bottom.mesh.vertices().begin());
            }
        });
        for (Bottom* bottom : changed_) {
            if (!bottom->is_built) rtcAttachGeometryByID(bottom->scene.get(), bottom->mesh.geometry(), 0);
            bottom->is_built = true;
        }
    }

    /// Several at once: a small scene's build has no work for two threads.
    void commit_bottoms() {
        parallel_for(0, changed_.size(), 1, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                changed_[k]->mesh.commit();
                rtcCommitScene(changed_[k]->scene.get());
            }
        });
    }

    void place(const Scene& scene, const Tlas& tlas) {
        const std::vector<Shape>& shapes = scene.frame->shapes;
        for (size_t k = 0; k < shapes.size(); ++k) {
            const bool is_shown = tlas.instance_of_node[index(shapes[k].node)] != kNoInstance;
            if (is_shown == tops_[k].is_shown) continue;
            tops_[k].is_shown = is_shown;
            tops_[k].placed.reset();  // What it shows may be committed meanwhile: the instance must be, too.
            is_shown ? rtcEnableGeometry(tops_[k].geometry.get()) : rtcDisableGeometry(tops_[k].geometry.get());
        }
        parallel_for(0, shapes.size(), kInstancesATask, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                if (tops_[k].is_shown) place_one(tlas[shapes[k].node].world_from_local, &tops_[k]);
            }
        });
    }

    void place_one(const Affine& world_from_local, Top* top) {
        const bool is_moved = top->placed != world_from_local;
        if (!is_moved && !bottoms_[top->bottom].is_changed) return;
        if (is_moved) {
            // An Affine is three columns and the translation, without gaps.
            static_assert(sizeof(Affine) == 12 * sizeof(float));
            rtcSetGeometryTransform(top->geometry.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, &world_from_local);
            top->placed = world_from_local;
        }
        rtcCommitGeometry(top->geometry.get());
    }

    std::vector<Bottom> bottoms_;
    std::vector<Top> tops_;         ///< [shape_count]
    std::vector<Bottom*> changed_;  ///< Scratch of `update`.
};

}  // namespace

std::unique_ptr<EmbreeLayout> make_embree_instances(const EmbreeDevice& device, const EmbreeConfig& config,
                                                    const Scene& scene) {
    return std::make_unique<EmbreeInstances>(device, config, scene);
}

}  // namespace zoe
