#include "apps/bench/bench_scenes.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "apps/common/open_scene.h"
#include "apps/common/place_copies.h"
#include "apps/common/usage_error.h"
#include "content/content.h"
#include "engine/scene/error.h"
#include "engine/scene/sequence.h"

namespace zoe {
namespace {

constexpr int kMostCopies = 10'000;

bool is_there(const std::filesystem::path& path) {
    std::error_code ignored;  // a name too long, say, is no file
    return std::filesystem::exists(path, ignored);
}

}  // namespace

std::span<const BenchScene> bench_scenes() {
    static const std::array scenes = {
        BenchScene{"default", "default", 8, {512, 512}, "the demo's zoetrope: all classes in a furnished room"},
        BenchScene{
            "static", "static-1000000", 8, {512, 512}, "a room of a million triangles, 100,000 of them long and thin"},
        BenchScene{"rigid", "rigid-1000", 8, {512, 512}, "1,000 moving copies of 1,000 triangles"},
        BenchScene{"deforming", "deforming-500", 8, {512, 512}, "a waving cloth of 500 x 500 quads"},
        BenchScene{"skinned", "skinned-100", 8, {512, 512}, "100 walking figures"},
        BenchScene{"character", "character-200", 8, {512, 512}, "one walking figure of 200,000 triangles"},
        BenchScene{
            "surface", "surface-100", 8, {512, 512}, "a subdivision surface: a morphing cage of 10,000 quads at level 2"},
        BenchScene{"arbitrary", "arbitrary-20000", 8, {512, 512}, "20,000 triangles that explode"},
        BenchScene{"topology", "topology-98", 8, {512, 512}, "drops that merge and part: other triangles every frame"},
        BenchScene{"mixed", "mixed-20", 60, {1024, 1024}, "a static room, 100 rigid objects, a cloth, an explosion", 2},
        BenchScene{"instances-1000", "instances-1000", 8, {512, 512}, "1,000 copies that all move every frame"},
        BenchScene{"instances-10000", "instances-10000", 8, {512, 512}, "10,000 of them"},
        BenchScene{"instances-100000", "instances-100000", 8, {512, 512}, "100,000 of them"},
    };
    return scenes;
}

BenchScene find_bench_scene(const std::string& name) {
    const std::span<const BenchScene> scenes = bench_scenes();
    if (const auto found = std::ranges::find(scenes, name, &BenchScene::name); found != scenes.end()) return *found;
    if (const size_t star = name.rfind('*'); star != name.npos && !is_there(name)) {
        const std::optional<int> copies = parse_count(name.substr(star + 1), kMostCopies);
        if (!copies || *copies == 0) {
            throw UsageError(fmt::format("{}: after the * stands how many copies, from 1 to {}", name, kMostCopies));
        }
        BenchScene scene = find_bench_scene(name.substr(0, star));
        if (scene.copies != 1) throw UsageError(fmt::format("{}: copies of copies", name));
        scene.name = name;
        scene.copies = *copies;
        return scene;
    }
    const std::filesystem::path path = name;
    if (is_there(path) || is_sequence_pattern(name)) {
        // A file, whose contents are looked at when its turn comes.
    } else if (path.has_parent_path() || path.extension() == ".glb" || path.extension() == ".gltf") {
        throw UsageError(fmt::format("{}: no such file", name));
    } else {
        try {
            parse_content_name(name);
        } catch (const SceneError& error) {
            std::string names;
            for (const BenchScene& scene : scenes) names += fmt::format("{}{}", names.empty() ? "" : ", ", scene.name);
            throw UsageError(fmt::format("{}; the benchmark's own are {}", error.what(), names));
        }
    }
    return {.name = name, .scene = name, .description = ""};
}

std::string list_bench_scenes() {
    std::string text =
        "Played unless told otherwise (repeats, frames, primary rays; a diffuse ray from each of their hits, a\n"
        "shadow ray from both):\n";
    for (const BenchScene& scene : bench_scenes()) {
        text += fmt::format("  {:<17}{} x {:>2} x {:<11}{}\n", scene.name, scene.repeats, scene.frame_count,
                            fmt::format("{}x{}", scene.size.width, scene.size.height), scene.description);
    }
    text += "\nAlso any of these as NAME or NAME-SIZE, and any .glb or .gltf file or mesh sequence by its path:\n";
    for (const ContentInfo& info : content_list()) text += fmt::format("  {:<17}{}\n", info.name, info.description);
    text += "\nAnd so many of one, side by side, each a little later in its clip: 'fox.glb*200'.\n";
    return text;
}

Content open_bench_scene(const BenchScene& scene) {
    Content content = open_scene(scene.scene, kBenchFps);
    place_copies(scene.copies, &content.scene);
    return content;
}

}  // namespace zoe
