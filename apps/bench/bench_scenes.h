#pragma once

#include <span>
#include <string>

#include "apps/common/parse.h"
#include "content/content.h"

namespace zoe {

/// Frames a second of every benchmark scene.
inline constexpr double kBenchFps = 24.0;

/// A scene that the benchmark plays unless told otherwise.
struct BenchScene {
    std::string name;   ///< What tables and JSON call it.
    std::string scene;  ///< What `open_scene` is asked for.
    int frame_count = 8;
    PictureSize size{512, 512};
    std::string description;
    int repeats = 3;  ///< Times that it is played.
    int copies = 1;   ///< See `place_copies`.
};

std::span<const BenchScene> bench_scenes();

/// The benchmark's scene of that name, else any scene by that name or path, at the default frames and size; NAME*COUNT: so
/// many copies. Opens nothing.
/// Throws     UsageError for a name that is none, with the names that there are, for a file that is not there, and for a
///            count that is none.
BenchScene find_bench_scene(const std::string& name);

/// Opens it, as many times as there are copies.
/// Throws     SceneError as `open_scene` does.
Content open_bench_scene(const BenchScene& scene);

/// For `--list`: every scene with its size and what it is.
std::string list_bench_scenes();

}  // namespace zoe
