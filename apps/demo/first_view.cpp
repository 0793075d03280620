#include "apps/demo/first_view.h"

namespace zoe {

ViewChoice first_view(Content& content, const Options& options) {
    ViewChoice choice;
    const std::vector<NodeId> cameras = camera_nodes(content.scene);
    if (options.camera) {
        choice.camera = find_camera(content.scene, *options.camera);
    } else if (options.eye) {
        choice.look_at = ViewChoice::LookAt{*options.eye, *options.target, options.fov_degrees.value_or(45.0f)};
    } else if (!cameras.empty()) {
        choice.camera = cameras.front();
    } else {
        constexpr double kOtherwiseS = 4.0;
        choice.bounds = bounds_over(content, times_over_clip(content.scene, kOtherwiseS));
    }
    return choice;
}

}  // namespace zoe
