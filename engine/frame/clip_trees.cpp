#include "engine/frame/clip_trees.h"

#include <algorithm>

#include "engine/bvh/build_poses.h"
#include "engine/frame/frame.h"
#include "engine/frame/frame_state.h"
#include "engine/scene/scene.h"

namespace zoe {

namespace {

// Poses squared times triangles, what `build_poses` costs: a second or so.
constexpr double kMostWork = 3.2e6;

// Half as many, and again, until they are not too many to build over.
uint32_t pose_count(uint32_t most, size_t triangle_count) {
    uint32_t count = most;
    while (count > 1 && double(count) * count * static_cast<double>(triangle_count) > kMostWork) count /= 2;
    return count;
}

double longest_s(const Scene& scene) {
    double longest = 0.0;
    for (const ClipId id : scene.playback.clips) {
        if (index(id) < scene.clips.size()) longest = std::max(longest, scene.clips[index(id)].duration_s);
    }
    return longest;
}

// Of each mesh that deforming nodes show, the first that does.
std::vector<const Shape*> choose_shapes(const Scene& scene, const FrameState& state) {
    std::vector<const Shape*> chosen;
    std::vector<uint8_t> is_chosen(scene.meshes.size());
    for (const Shape& shape : state.shapes) {
        const MeshId mesh = scene[shape.node].mesh;
        if (shape.motion.motion != Motion::kDeforming || mesh == kNone<MeshId> || is_chosen[index(mesh)]) continue;
        is_chosen[index(mesh)] = 1;
        chosen.push_back(&shape);
    }
    return chosen;
}

}  // namespace

void add_boxes(const Shape& shape, std::vector<Aabb>* boxes) {
    for (const glm::uvec3& t : shape.shown->corners) {
        const Triangle triangle{shape.positions[t.x], shape.positions[t.y], shape.positions[t.z], 0};
        const bool is_finite = zoe::is_finite(triangle.a) && zoe::is_finite(triangle.b) && zoe::is_finite(triangle.c);
        boxes->push_back(is_finite ? bounds(triangle) : Aabb{});
    }
}

double fit(std::span<const Aabb> boxes, Bvh* tree) {
    for (size_t k = tree->nodes.size(); k-- > 0;) {
        BvhNode& node = tree->nodes[k];
        Aabb box;
        if (node.is_leaf()) {
            for (uint32_t n = 0; n < node.count; ++n) box.extend(boxes[tree->primitives[node.first + n]]);
        } else {
            box = tree->nodes[node.first].bounds();
            box.extend(tree->nodes[node.first + 1].bounds());
        }
        node.lo = box.lo;
        node.hi = box.hi;
    }
    return sah_cost(*tree);
}

void build_clip_trees(Scene& scene, FrameState* state, FrameStats* stats) {
    const double duration_s = longest_s(scene);
    const std::vector<const Shape*> shapes = choose_shapes(scene, *state);
    const bool is_level_chosen =
        std::ranges::any_of(scene.meshes, [](const Mesh& mesh) { return mesh.surface && mesh.surface->pixels > 0.0f; });
    if (!(duration_s > 0.0) || shapes.empty() || scene.clip_poses < 2 || is_level_chosen) return;
    std::vector<std::vector<Aabb>> boxes(shapes.size());
    FrameStats of_poses;
    uint32_t count = scene.clip_poses;
    for (uint32_t pose = 0; pose < count; ++pose) {
        animate(scene, duration_s * pose / count, state);
        deform(scene, state, &of_poses);
        if (pose == 0) {
            stats->subdivided += of_poses.subdivided;
            size_t triangle_count = 0;
            for (const Shape* shape : shapes) triangle_count += shape->shown->corners.size();
            count = pose_count(count, triangle_count);
            if (count < 2) return;
        }
        for (size_t k = 0; k < shapes.size(); ++k) add_boxes(*shapes[k], &boxes[k]);
    }
    state->clip_trees.resize(scene.meshes.size());
    for (size_t k = 0; k < shapes.size(); ++k) {
        ClipTree& made = state->clip_trees[index(shapes[k]->mesh)];
        made.tree = build_poses(boxes[k], count, {.max_leaf_size = 8});
        const size_t size = boxes[k].size() / count;
        for (size_t pose = 0; pose < count; ++pose)
            made.worst_cost = std::max(made.worst_cost, fit(std::span(boxes[k]).subspan(pose * size, size), &made.tree));
    }
}

}  // namespace zoe
