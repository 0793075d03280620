#include "apps/demo/first_view.h"

#include <array>

namespace zoe {

namespace {

Aabb whole(Content& content) {
    constexpr double kOtherwiseS = 4.0;
    return bounds_over(content, times_over_clip(content.scene, kOtherwiseS));
}

// Moves the world's beginning to where it was asked for, and a place to look from with it.
void set_origin(Content& content, const Options& options, ViewChoice* choice) {
    Scene& scene = content.scene;
    if (options.origin) scene.origin = *options.origin;
    if (options.begins_at_eye) {
        bounds_over(content, std::array{0.0});  // Where nodes are at the start.
        scene.origin = choice->camera    ? place_in_scene(scene, *choice->camera)
                       : choice->look_at ? *options.eye
                                         : glm::dvec3(choice->bounds.centre());
    }
    if (choice->look_at) {
        choice->look_at->eye = glm::vec3(*options.eye - scene.origin);
        choice->look_at->target = glm::vec3(*options.target - scene.origin);
    }
}

}  // namespace

ViewChoice first_view(Content& content, const Options& options) {
    ViewChoice choice;
    const std::vector<NodeId> cameras = camera_nodes(content.scene);
    if (options.camera) {
        choice.camera = find_camera(content.scene, *options.camera);
    } else if (options.eye) {
        choice.look_at =
            ViewChoice::LookAt{glm::vec3(*options.eye), glm::vec3(*options.target), options.fov_degrees.value_or(45.0f)};
    } else if (!cameras.empty()) {
        choice.camera = cameras.front();
    } else {
        choice.bounds = whole(content);
    }
    if (options.origin || options.begins_at_eye) {
        set_origin(content, options, &choice);
        if (!choice.camera && !choice.look_at) choice.bounds = whole(content);
    }
    return choice;
}

}  // namespace zoe
