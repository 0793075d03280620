#include "apps/demo/opened.h"

#include <utility>

#include "apps/demo/choose_sky.h"

namespace zoe {

std::unique_ptr<Opened> open(Options options) {
    auto opened = std::make_unique<Opened>();
    opened->content = open_scene(options.scene, options.fps, options.level);
    Scene& scene = opened->content.scene;
    scene.playback.is_looping = options.is_looping;
    scene.tree_build.budget_s = options.build_budget_s;
    if (!options.cache.empty()) scene.tree_cache = std::make_shared<TreeCache>(options.cache);
    if (options.clip) choose_clips(scene, *options.clip);
    options.environment = choose_sky(options, scene);
    opened->options = std::move(options);
    return opened;
}

Options options_for(const Options& options, const std::string& scene) {
    Options other = options;
    other.scene = scene;
    other.clip.reset();
    other.camera.reset();
    other.eye = other.target = other.origin = std::nullopt;
    other.fov_degrees.reset();
    other.begins_at_eye = false;
    other.level.reset();
    return other;
}

}  // namespace zoe
