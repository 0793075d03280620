#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "apps/bench/stopwatch.h"
#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "content/content.h"
#include "content/shapes.h"
#include "engine/frame/refine.h"
#include "engine/math/parallel.h"
#include "tests/support/point_distance.h"

namespace zoe::chart {
namespace {

constexpr const char* kTriangles = "By what is traced";
constexpr const char* kTime = "By what a frame evaluates";
constexpr float kPixels = 1.0f;  // What is asked for.
constexpr float kPictureHeight = 1000.0f, kYfov = 0.8f;

struct Subject {
    const char* series;          ///< Vertices on the limit surface.
    const char* refined_series;  ///< Where the rounds of refinement leave them.
    Mesh (*make)();
};

Mesh make_ball_cage() {
    const Mesh ball = make_sphere(1.0f, 8, 6);
    Cage cage{.scheme = SubdivisionScheme::kLoop, .face_sizes = std::vector<uint32_t>(ball.corners.size(), 3)};
    for (const glm::uvec3& c : ball.corners) cage.vertices.insert(cage.vertices.end(), {c.x, c.y, c.z});
    return make_surface(ball.positions, {.cage = std::move(cage)});
}

constexpr Subject kSubjects[] = {
    {"ring", "ring, not at the limit", [] { return make_content("surface", 12).scene.meshes[0]; }},
    {"figure", "figure, not at the limit", [] { return make_content("dancers", 1).scene.meshes[0]; }},
    {"ball, Loop", "ball, Loop, not at the limit", make_ball_cage},
};

/// From where a sphere around the cage fills the picture from its lower edge to its upper.
Seen see(const std::vector<glm::vec3>& cage_positions) {
    glm::vec3 lo = cage_positions[0], hi = lo;
    for (const glm::vec3& p : cage_positions) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    const float away = 0.5f * glm::length(hi - lo) / std::sin(0.5f * kYfov);
    return {.eye_world = 0.5f * (lo + hi) + away * glm::normalize(glm::vec3(0.3f, 0.2f, 1.0f)),
            .pixels_at_1m = 0.5f * kPictureHeight / std::tan(0.5f * kYfov)};
}

/// A much finer level: points of the limit surface, summed in double.
struct Truth {
    int level;
    Subdivision topology;
    std::vector<glm::dvec3> points;
    std::vector<uint32_t> triangles;  ///< One that each point belongs to.

    Truth(const Mesh& mesh, int fine_level)
        : level(fine_level),
          topology(make_subdivision(mesh.surface->cage, mesh.positions.size(), {.level = fine_level, .normals = false})),
          points(topology.stencils.vertex_count(), glm::dvec3(0.0)),
          triangles(points.size()) {
        const StencilTable& stencils = topology.stencils;
        for (size_t v = 0; v < points.size(); ++v)
            for (uint32_t k = stencils.offsets[v]; k < stencils.offsets[v + 1]; ++k)
                points[v] += double(stencils.weights[k]) * glm::dvec3(mesh.positions[stencils.indices[k]]);
        for (uint32_t k = 0; k < topology.corners.size(); ++k)
            for (int corner = 0; corner < 3; ++corner) triangles[topology.corners[k][corner]] = k;
    }
};

/// A level as it is shown.
struct Shown {
    SubdivisionOptions options;
    Subdivision topology;
    std::vector<glm::vec3> positions, normals;

    Shown(const Mesh& mesh, const SubdivisionOptions& with)
        : options(with),
          topology(make_subdivision(mesh.surface->cage, mesh.positions.size(), with)),
          positions(topology.stencils.vertex_count()),
          normals(positions.size()) {}
    void evaluate_pose(const Mesh& mesh) { evaluate(topology.stencils, mesh.positions, positions, normals); }
};

/// The largest distance of a point of the limit surface from the triangles. Faces are refined in order, so that a fine
/// triangle's number tells the one that it is a part of; the nearest is that or one of those around its vertices.
double measure_error(const Shown& shown, const Truth& truth, const Seen& seen) {
    const std::vector<glm::uvec3>& corners = shown.topology.corners;
    std::vector<std::vector<uint32_t>> around(shown.positions.size());
    for (uint32_t k = 0; k < corners.size(); ++k)
        for (int corner = 0; corner < 3; ++corner) around[corners[k][corner]].push_back(k);
    const int shift = 2 * (truth.level - shown.options.level);
    std::vector<double> pixels(truth.points.size());
    parallel_for(0, pixels.size(), 256, [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            const uint32_t own = truth.triangles[v] >> shift;
            if (shown.topology.cage_faces[own] != truth.topology.cage_faces[truth.triangles[v]])
                throw std::logic_error("triangles of two levels are not in the same order");
            double nearest = INFINITY;
            for (int corner = 0; corner < 3; ++corner) {
                for (const uint32_t k : around[corners[own][corner]]) {
                    const auto at = [&](int c) { return glm::dvec3(shown.positions[corners[k][c]]); };
                    nearest = std::min(nearest, test::distance(truth.points[v], at(0), at(1), at(2)));
                }
            }
            pixels[v] = nearest * seen.pixels_at_1m / glm::length(truth.points[v] - glm::dvec3(seen.eye_world));
        }
    });
    return *std::ranges::max_element(pixels);
}

std::vector<Row> measure(const Subject& subject, const Settings& settings) {
    const Mesh mesh = subject.make();
    const Seen seen = see(mesh.positions);
    bool is_capped = false;
    const int picked = choose_level(make_level_choice(mesh), mesh.positions, seen, kPixels, 0.0f, 0, &is_capped);
    std::vector<Shown> levels;
    for (int level = 1; level <= settings.pick(4, 5, 5); ++level) {
        for (const bool is_limit : {true, false})
            levels.emplace_back(mesh, SubdivisionOptions{.level = level, .limit_positions = is_limit});
    }
    std::vector<std::function<double()>> works;
    for (Shown& shown : levels) {
        works.emplace_back([&] {
            const size_t repeats = 1 + 100'000 / shown.positions.size();
            Stopwatch watch;
            for (size_t k = 0; k < repeats; ++k) shown.evaluate_pose(mesh);
            return watch.restart_ms() / static_cast<double>(repeats);
        });
    }
    const std::vector<std::vector<double>> ms = measure_in_turn(works, settings.pick(3, 9, 15));
    const Truth truth(mesh, settings.pick(5, 6, 6));
    std::vector<Row> rows;
    for (size_t k = 0; k < levels.size(); ++k) {
        stop_if_interrupted();
        const SubdivisionOptions& options = levels[k].options;
        Point point{.x = Spread::exactly(static_cast<double>(levels[k].topology.corners.size())),
                    .y = Spread::exactly(measure_error(levels[k], truth, seen)),
                    .is_default = options.limit_positions && options.level == picked && !is_capped};
        const char* const series = options.limit_positions ? subject.series : subject.refined_series;
        rows.push_back({.panel = kTriangles, .series = series, .point = point});
        point.x = spread_of(ms[k]);
        rows.push_back({.panel = kTime, .series = series, .point = point});
    }
    return rows;
}

std::string caption(const Chart& chart) {
    std::string falls, picks;
    double least = INFINITY, most = 0.0;
    for (const Subject& subject : kSubjects) {
        const std::vector<Point>& limit = chart.panel(kTriangles).find(subject.series)->points;
        const std::vector<Point>& refined = chart.panel(kTriangles).find(subject.refined_series)->points;
        const char* const between = &subject == kSubjects ? "" : ", ";
        const double fall = std::pow(limit[1].y.median / limit.back().y.median, 1.0 / static_cast<double>(limit.size() - 2));
        falls += fmt::format("{}{} ({})", between, short_number(fall), subject.series);
        for (size_t k = 0; k < limit.size(); ++k) {
            least = std::min(least, refined[k].y.median / limit[k].y.median);
            most = std::max(most, refined[k].y.median / limit[k].y.median);
        }
        const auto pick = std::ranges::find_if(limit, &Point::is_default);
        if (pick == limit.end())
            picks += fmt::format("{}none ({})", between, subject.series);
        else
            picks += fmt::format("{}{} at {} pixels ({})", between, pick - limit.begin() + 1, short_number(pick->y.median),
                                 subject.series);
    }
    return fmt::format(
        "Cages that fill a picture {} pixels high, refined 1 to {} times; the largest distance of the limit surface from "
        "the "
        "triangles, between vertices too. From level 2 on a level has 4 times the triangles and divides the distance by {}. "
        "Vertices that stay where the rounds leave them are {} to {} times as far off as with those at the limit, which "
        "are what the engine makes. Ringed: the level that `pixels: {}` picks: {}.",
        short_number(kPictureHeight), chart.panel(kTriangles).find(kSubjects[0].series)->points.size(), falls,
        short_number(least), short_number(most), kPixels, picks);
}

}  // namespace

Chart subdivision(Sweep& sweep) {
    Chart chart{.name = "subdivision", .question = find_chart("subdivision").question, .columns = 2};
    const Axis distance{.name = "distance to the limit surface", .unit = "pixels", .is_log = true};
    chart.panels = {
        {.name = kTriangles, .x = {.name = "triangles", .unit = "", .is_log = true}, .y = distance},
        {.name = kTime, .x = {.name = "positions and normals", .unit = "ms a frame", .is_log = true}, .y = distance}};
    std::vector<Step> steps;
    for (const Subject& subject : kSubjects)
        steps.push_back({.name = subject.series, .measure = [&] { return measure(subject, sweep.settings()); }});
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
