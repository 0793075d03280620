// Every real model of ../shared/assets: it loads and can be traced, or it is refused with a reason. The output is a table.

#include <array>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/frame/classify.h"
#include "engine/zoetrope.h"
#include "tests/support/assets.h"
#include "tests/support/compare.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/rays.h"

namespace zoe::test {
namespace {

/// What became of one file.
struct Outcome {
    bool is_loaded = false;
    std::string text;     ///< A line of the table.
    std::string problem;  ///< Empty: as it must be.
};

/// Rays around a frame's box, aimed at two triangles that span it.
std::vector<OracleRay> rays_around_box(const Aabb& box, size_t count) {
    const glm::dvec3 lo(box.lo), hi(box.hi);
    const WorldTriangle diagonals[2] = {{lo, hi, {lo.x, hi.y, lo.z}, 0, 0}, {lo, hi, {hi.x, lo.y, hi.z}, 0, 1}};
    return rays_around(diagonals, count, 11);
}

/// Traces some rays.
/// Returns    what is wrong with a hit, empty if nothing.
std::string trace_some(const Tlas& tlas, size_t node_count) {
    if (!tlas.bounds().is_finite()) return "";
    for (const OracleRay& oracle_ray : rays_around_box(tlas.bounds(), 24)) {
        const Ray ray = engine_ray(oracle_ray);
        const Hit hit = closest_hit(tlas, ray);
        if (static_cast<bool>(hit) != any_hit(tlas, ray)) return "closest and any hit disagree";
        if (!hit) continue;
        if (!(hit.t >= ray.t_min && hit.t <= ray.t_max)) return fmt::format("t {} outside the ray", hit.t);
        if (!(hit.u >= 0.0f && hit.v >= 0.0f && hit.u + hit.v <= 1.00001f)) return fmt::format("u {} v {}", hit.u, hit.v);
        if (index(hit.node) >= node_count) return "a hit of no node";
        if (hit.primitive >= tlas[hit.node].mesh->corners.size()) return "a hit of no triangle";
    }
    return "";
}

/// Compares a few hits, and the number of triangles shown, with the oracle's.
/// Returns    what is wrong, empty if nothing.
std::string compare_with_oracle(const std::filesystem::path& file, Scene* scene, double time_s) {
    const BruteForce truth(world_triangles(read_document(file), time_s));
    const Tlas& tlas = advance(*scene, time_s);
    size_t triangle_count = 0;
    for (const Instance& instance : tlas.instances) triangle_count += instance.mesh->corners.size();
    if (triangle_count != truth.triangles().size()) {
        return fmt::format("{} triangles, the oracle has {}", triangle_count, truth.triangles().size());
    }
    if (triangle_count == 0) return "";
    Agreement agreement;
    for (const OracleRay& ray : rays_around(truth.triangles(), 48, 3)) {
        compare_closest(truth, ray, closest_hit(tlas, engine_ray(ray)), &agreement);
    }
    const testing::AssertionResult verdict = agreement.verdict(0.2);
    return verdict ? "" : verdict.message();
}

Outcome play(const std::filesystem::path& file, bool is_valid, Scene scene) {
    Outcome outcome{.is_loaded = true, .text = "", .problem = ""};
    const double duration_s = scene.clips.empty() ? 1.0 : scene.clips.front().duration_s;
    const Tlas* tlas = nullptr;
    for (const double time_s : {0.0, 0.37 * duration_s, duration_s, 1.71 * duration_s}) {
        tlas = &advance(scene, time_s);
        if (const std::string wrong = trace_some(*tlas, scene.nodes.size()); !wrong.empty()) {
            outcome.problem = fmt::format("at {} s: {}", time_s, wrong);
        }
    }
    if (is_valid && outcome.problem.empty()) outcome.problem = compare_with_oracle(file, &scene, 0.37 * duration_s);

    std::array<size_t, kMotionCount> counts{};
    size_t triangle_count = 0, warning_count = 0;
    for (const Instance& instance : tlas->instances) {
        triangle_count += instance.mesh->corners.size();
        ++counts[static_cast<size_t>(instance.motion)];
    }
    for (const auto& [text, count] : scene.warnings()) warning_count += count;
    outcome.text =
        fmt::format("loaded: {} nodes, {} shown ({} static, {} rigid, {} deforming, {} arbitrary), {} triangles, {} clips",
                    scene.nodes.size(), tlas->instances.size(), counts[0], counts[1], counts[2], counts[3], triangle_count,
                    scene.clips.size());
    if (warning_count > 0) outcome.text += fmt::format(", {} warnings", warning_count);
    return outcome;
}

Outcome load_and_play(const std::filesystem::path& folder, const std::string& file, bool is_valid) {
    Outcome outcome;
    try {
        Scene scene = load_gltf(folder / file);
        outcome.is_loaded = true;  // From here on nothing may refuse it.
        return play(folder / file, is_valid, std::move(scene));
    } catch (const SceneError& error) {
        const std::string reason = error.what(), name = std::filesystem::path(file).filename().string();
        const size_t at = reason.find(name);
        const bool is_complete = at != std::string::npos && reason.size() > at + name.size() + 2;
        outcome.text = "refused" + (is_complete ? reason.substr(at + name.size()) : ": " + reason);
        if (!is_complete) outcome.problem = "the reason does not name the file, or says nothing: " + reason;
        if (reason.find('\n') != std::string::npos) outcome.problem = "the reason has more than one line: " + reason;
        if (outcome.is_loaded) outcome.problem = "loaded, then refused: " + reason;
    } catch (const std::exception& error) {
        outcome.text = outcome.problem = std::string("another exception: ") + error.what();
    }
    return outcome;
}

/// Why a file must be refused although its folder holds valid ones; empty: it must load.
std::string expected_refusal(const std::string& file) {
    if (file == "edge/Box-Draco/Box.gltf") return "KHR_draco_mesh_compression";
    if (file == "edge/BoxMeshopt.glb") return "EXT_meshopt_compression";
    if (file == "asset-generator/Compatibility/Compatibility_04.gltf") return "/asset/minVersion";
    return "";
}

/// Invalid on purpose: both outcomes are right, as long as there is one.
bool is_invalid(const std::string& file) {
    return file.starts_with("invalid/") || file.starts_with("asset-generator/Mesh_NoPosition/") ||
           file.starts_with("asset-generator/Mesh_PrimitiveRestart/");
}

/// Prints the table of the files that the choice takes, and checks each line.
template <typename Choice>
void check_files(const Choice& choice) {
    const auto folder = assets_folder(ZOETROPE_SOURCE_DIR);
    if (!folder) GTEST_SKIP() << kNoAssets;
    size_t loaded_count = 0, refused_count = 0;
    for (const std::string& file : gltf_files(*folder)) {
        if (!choice(file)) continue;
        const Outcome outcome = load_and_play(*folder, file, !is_invalid(file));
        fmt::print("{} | {}\n", file, outcome.text);
        ++(outcome.is_loaded ? loaded_count : refused_count);
        EXPECT_EQ(outcome.problem, "") << file;
        if (is_invalid(file)) continue;
        const std::string refusal = expected_refusal(file);
        EXPECT_EQ(outcome.is_loaded, refusal.empty()) << file << ": " << outcome.text;
        EXPECT_NE(outcome.text.find(refusal), std::string::npos) << file << ": " << outcome.text;
    }
    fmt::print("{} loaded, {} refused\n", loaded_count, refused_count);
    EXPECT_GT(loaded_count + refused_count, 0u) << "no files below " << folder->string();
}

TEST(Assets, ValidFilesLoadAndTrace) {
    check_files([](const std::string& file) { return !is_invalid(file); });
}

TEST(Assets, InvalidFilesLoadAndTraceOrAreRefusedWithAReason) {
    check_files([](const std::string& file) { return is_invalid(file); });
}

}  // namespace
}  // namespace zoe::test
