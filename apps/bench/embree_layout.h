#pragma once

#include <memory>
#include <span>
#include <vector>

#include "apps/bench/embree_device.h"
#include "apps/bench/embree_range.h"
#include "apps/bench/peer_embree.h"

namespace zoe {

/// What rays are traced through.
struct EmbreeTarget {
    RTCScene scene;
    std::span<const NodeId> nodes;  ///< Of an instance's id, or of a geometry's where the hit is not in an instance.
    EmbreeReach reach = {};
};

/// A scene as Embree holds it, by one of the layouts. Made for one frame state of the scene.
class EmbreeLayout {
public:
    virtual ~EmbreeLayout() = default;

    /// As EmbreePeer's. Every frame that `advance` made must be shown to it, in order.
    virtual EmbreePeer::UpdateTimes update(const Scene& scene, const Tlas& tlas) = 0;

    EmbreeTarget target() const { return {top_.get(), nodes_, reach_}; }

protected:
    EmbreeScene top_;
    std::vector<NodeId> nodes_;  ///< [shape_count] ids are positions of shapes.
    EmbreeReach reach_;          ///< Into this frame's instances.
};

/// Requires   an `advance` of the scene before.
std::unique_ptr<EmbreeLayout> make_embree_instances(const EmbreeDevice& device, const EmbreeConfig& config,
                                                    const Scene& scene);
std::unique_ptr<EmbreeLayout> make_embree_one_scene(const EmbreeDevice& device, const EmbreeConfig& config,
                                                    const Scene& scene);

}  // namespace zoe
