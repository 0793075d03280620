#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <glm/vec2.hpp>

#include "apps/common/numbered_path.h"
#include "apps/common/parse.h"
#include "engine/bvh/cache.h"
#include "engine/render/environment.h"
#include "engine/render/path.h"
#include "engine/render/physical_sky.h"
#include "engine/render/shutter.h"

namespace zoe {

/// What it calls itself in messages.
constexpr const char* kProgram = "zoetrope-demo";

/// What lights a scene from all around. kByLights: see choose_sky.
enum class Sky : uint8_t { kByLights, kPhysical, kPlain, kColor, kFile };

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
    std::optional<double> shutter;  ///< Share of a frame's time that it is open; none: as the camera says.
    uint32_t slices = Shutter{}.slices;
    std::optional<double> noise;         ///< NoiseConfig::target; then `spp` is the most that a pixel gets.
    std::optional<double> time_limit_s;  ///< Of a frame's samples.
    Shade shade = Shade::kPath;
    bool is_denoised = false;
    Grade grade;
    Sky sky = Sky::kByLights;
    std::string sky_file;
    glm::dvec3 sky_color{0.0};
    glm::dvec2 sun{kSunElevation, kSunAzimuth};      ///< Of the physical sky: above the horizon, round from -Z; degrees.
    std::shared_ptr<const Environment> environment;  ///< What lights the scene, once it was opened.

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
