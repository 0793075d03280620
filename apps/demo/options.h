#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/common/numbered_path.h"
#include "apps/common/parse.h"
#include "engine/bvh/cache.h"
#include "engine/render/environment.h"
#include "engine/render/path.h"

namespace zoe {

/// What the command line asks for, checked as far as it can be without the scene.
struct Options {
    std::string scene = "default";
    bool is_headless = false;
    std::optional<int> level;  ///< Of subdivision surfaces.

    FrameRange frames{0, 47};
    Shard shard;  ///< Of the frames.
    double fps = 24.0;
    std::optional<std::string> clip;
    bool is_looping = true;

    std::optional<std::string> camera;
    std::optional<glm::dvec3> eye, target;
    std::optional<float> fov_degrees;
    std::optional<glm::dvec3> origin;  ///< Scene::origin ...
    bool begins_at_eye = false;        ///< ... or wherever the camera is in frame 0.

    std::optional<PictureSize> size;
    std::optional<int> spp;
    Shade shade = Shade::kPath;
    bool is_denoised = false;
    Grade grade;
    std::optional<std::string> sky;                  ///< A file that lights the scene ...
    std::shared_ptr<const Environment> environment;  ///< ... and what it holds, once it was read.

    NumberedPath out{"out/frame_%04d.png"};
    std::optional<std::string> stats, trace;  ///< Files to write.
    bool is_resumed = false;
    int threads = 0;
    double build_budget_s = AutoConfig{}.budget_s;
    std::filesystem::path cache = default_cache_folder();  ///< Of trees; empty: none.

    std::optional<std::string> screenshot;  ///< Of the window, then it closes.
    double screenshot_after_s = 2.0;
};

/// Reads the command line; `--help` prints and returns nothing.
/// Throws     UsageError.
std::optional<Options> parse_options(int argc, char** argv);

}  // namespace zoe
