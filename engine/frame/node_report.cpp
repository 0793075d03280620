#include "engine/frame/node_report.h"

#include <algorithm>
#include <stdexcept>

#include "engine/frame/frame_state.h"

namespace zoe {

const char* name(TreeAction action) {
    constexpr const char* kNames[] = {"kept", "refitted", "rebuilt"};
    return kNames[static_cast<size_t>(action)];
}

namespace {

const char* describe(const TreeMethod& method) {
    if (method.is_refitted) return "refitted, rebuilt when worn";
    switch (method.builder) {
        case BlasBuilder::kSbvh:
            return "built once: SBVH, reinserted";
        case BlasBuilder::kReinserted:
            return "built once: sweep, reinserted";
        case BlasBuilder::kSweep:
            return "built once: sweep";
        case BlasBuilder::kMedian:  // of no class
        case BlasBuilder::kBinned:
            break;
    }
    return method.is_cached ? "built once: binned" : "rebuilt: binned";
}

}  // namespace

NodeReport report_node(const Scene& scene, NodeId node) {
    if (!scene.frame) throw std::logic_error("report_node: no frame was made yet");
    const FrameState& state = *scene.frame;
    const auto shape = std::ranges::lower_bound(state.shapes, node, {}, &Shape::node);
    NodeReport report;
    report.content = state.motions.at(index(node)).content;
    report.motion = state.motions.at(index(node)).motion;
    if (shape == state.shapes.end() || shape->node != node || !shape->has_blas) return report;
    report.has_tree = true;
    report.method = describe(method_for(report.motion, state));
    report.action = shape->action;
    report.is_shared = shape->is_shared();
    report.triangle_count = static_cast<uint32_t>(shape->shown->corners.size());
    report.vertex_count = static_cast<uint32_t>(shape->positions.size());
    report.tree_cost = shape->blas->tree.summed_cost();
    if (shape->own) report.ray_loss = shape->own->watch.ray_loss;
    return report;
}

}  // namespace zoe
