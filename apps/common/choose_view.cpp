#include "apps/common/choose_view.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/common/parse.h"
#include "apps/common/usage_error.h"
#include "engine/frame/bounds_at.h"

namespace zoe {

View ViewChoice::view(const Scene& scene, float aspect) const {
    if (camera) return view_from_camera(scene, *camera, aspect);
    if (look_at) return zoe::look_at(look_at->eye, look_at->target, look_at->fov_degrees, aspect);
    return frame_whole(bounds, aspect);
}

bool has_pixel_surfaces(const Scene& scene) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                       [](const Mesh& mesh) { return mesh.surface && mesh.surface->pixels > 0.0f; });
}

void set_viewpoint(const ViewChoice& choice, PictureSize size, float hysteresis, Scene* scene) {
    scene->viewpoint.reset();
    if (!has_pixel_surfaces(*scene)) return;
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    Viewpoint viewpoint{.height_pixels = size.height, .hysteresis = hysteresis};
    float half = 0.0f;
    if (choice.camera) {
        const Camera& camera = scene->cameras.at(index((*scene)[*choice.camera].camera));
        if (!camera.is_perspective) {
            scene->warn("surfaces that are to be as fine as their pixels show have their level: the camera is orthographic");
            return;
        }
        viewpoint.node = *choice.camera;
        half = half_height(camera, aspect);
    } else {
        const View view = choice.view(*scene, aspect);
        viewpoint.eye_world = view.origin;
        half = view.half_height;
    }
    viewpoint.yfov = 2.0f * std::atan(half);
    scene->viewpoint = viewpoint;
}

std::vector<NodeId> camera_nodes(const Scene& scene) {
    std::vector<NodeId> nodes;
    for (uint32_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].is_shown && scene.nodes[i].camera != kNone<CameraId>) nodes.push_back(NodeId{i});
    }
    return nodes;
}

std::string camera_name(const Scene& scene, NodeId node) {
    const std::string& own = scene[node].name;
    return own.empty() ? scene.cameras.at(index(scene[node].camera)).name : own;
}

NodeId find_camera(const Scene& scene, const std::string& choice) {
    const std::vector<NodeId> nodes = camera_nodes(scene);
    for (const NodeId node : nodes) {
        if (scene[node].name == choice || scene.cameras.at(index(scene[node].camera)).name == choice) return node;
    }
    if (const auto position = parse_count(choice, 1 << 30); position && size_t(*position) < nodes.size())
        return nodes[*position];

    std::string list;
    for (size_t i = 0; i < nodes.size(); ++i) {
        list += fmt::format("{}{} '{}'", i ? ", " : "", i, one_line(camera_name(scene, nodes[i])));
    }
    throw UsageError(fmt::format("--camera {}: there is no such camera; the scene's cameras are: {}", choice,
                                 list.empty() ? "none" : list));
}

Aabb bounds_over(Content& content, std::span<const double> times) {
    Aabb bounds;
    for (const double time_s : times) {
        if (content.write) content.write(content.scene, time_s);
        bounds.extend(bounds_at(content.scene, time_s));
    }
    return bounds.is_empty() || !bounds.is_finite() ? Aabb{glm::vec3(-1.0f), glm::vec3(1.0f)} : bounds;
}

std::vector<double> times_over_clip(const Scene& scene, double otherwise_s) {
    constexpr int kSteps = 8;
    const double repeats_s = duration_s(scene, scene.playback.clips);
    const double span_s = repeats_s > 0.0 ? repeats_s : otherwise_s;
    std::vector<double> times;
    for (int i = 0; i <= kSteps; ++i) times.push_back(span_s * i / kSteps);
    return times;
}

}  // namespace zoe
