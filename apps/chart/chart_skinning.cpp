#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "apps/bench/stopwatch.h"
#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/rod.h"
#include "engine/math/parallel.h"
#include "engine/scene/scene.h"

namespace zoe::chart {
namespace {

constexpr const char* kTwist = "Volume lost by a twist";
constexpr const char* kBend = "Volume lost by a bend";
constexpr const char* kTime = "Time a vertex, one thread";
constexpr double kFarthestBend = 120.0;  // A bend beyond goes through itself.

struct Method {
    const char* series;
    Skinning skinning;
};
constexpr std::array kMethods = {Method{"linear blend", Skinning::kLinearBlend},
                                 Method{"dual quaternion", Skinning::kDualQuaternion}};

/// Spreads of what is counted are one number.
std::vector<Row> measure_volume(double degrees) {
    const Rod rod(96, 32);
    std::vector<Row> rows;
    for (const Method& method : kMethods) {
        const auto add = [&](const char* panel, const glm::vec3& axis) {
            const double lost = 1.0 - rod.volume_turned(axis, degrees, method.skinning) / rod.volume();
            rows.push_back({.panel = panel,
                            .series = method.series,
                            .point = {.x = Spread::exactly(degrees),
                                      .y = Spread::exactly(100.0 * lost),
                                      .is_default = method.skinning == Skin{}.skinning}});
        };
        add(kTwist, {0, 1, 0});
        if (degrees <= kFarthestBend) add(kBend, {0, 0, 1});
    }
    return rows;
}

/// Beside a copy that reads and writes as many bytes.
std::vector<Row> measure_time(int rings, const Settings& settings) {
    const Rod rod(rings, 32);
    const size_t count = rod.mesh.positions.size();
    const std::vector<Affine> joints = Rod::pose({0, 1, 0}, 60.0);
    std::vector<glm::vec3> positions(count), normals(count);
    const size_t copied = count * (2 * sizeof(glm::vec3) + rod.mesh.binding.influence_count * 3);
    std::vector<char> from(copied, 1), to(copied);
    const auto ns = [&](auto&& work) {
        Stopwatch watch;
        const size_t repeats = 1 + 200'000 / count;
        for (size_t k = 0; k < repeats; ++k) work();
        return 1e6 * watch.restart_ms() / static_cast<double>(repeats * count);
    };
    std::vector<std::function<double()>> works;
    for (const Method& method : kMethods) {
        works.emplace_back([&, method] {
            return ns([&] {
                skin(rod.mesh.binding, Rod::packed(joints, method.skinning), rod.mesh.positions, rod.mesh.normals, positions,
                     normals);
            });
        });
    }
    works.emplace_back([&] { return ns([&] { std::memcpy(to.data(), from.data(), copied); }); });
    const int threads = thread_count();
    set_thread_count(1);
    const std::vector<std::vector<double>> measured = measure_in_turn(works, settings.pick(3, 9, 21));
    set_thread_count(threads);
    if (to != from) throw std::logic_error("a copy differs");
    std::vector<Row> rows;
    for (size_t k = 0; k < works.size(); ++k) {
        const bool is_method = k < kMethods.size();
        rows.push_back({.panel = kTime,
                        .series = is_method ? kMethods[k].series : "memcpy",
                        .point = {.x = Spread::exactly(static_cast<double>(count)),
                                  .y = spread_of(measured[k]),
                                  .is_default = is_method && kMethods[k].skinning == Skin{}.skinning}});
    }
    return rows;
}

std::string caption(const Chart& chart) {
    const auto lost = [&](const char* panel, const char* series) {
        return short_number(chart.panel(panel).find(series)->points.back().y.median);
    };
    const auto last = [&](const char* series) { return chart.panel(kTime).find(series)->points.back().y.median; };
    const double copy = last("memcpy"), vertices = chart.panel(kTime).find("memcpy")->points.back().x.median;
    const bool does_bulge = chart.panel(kBend).find("dual quaternion")->points.back().y.median < 0.0;
    return fmt::format(
        "A rod with round ends, the middle half of which blends from one joint to another. Twisted by {} degrees it loses "
        "{} "
        "% of its volume with linear blending and {} % with dual quaternions; bent by {}, {} % and {} %{}. Positions and "
        "normals of {} vertices take {} and {} times as long as a copy that moves as many bytes. "
        "The default is linear blending, which is what a glTF file means unless its skin asks for the other.",
        short_number(chart.panel(kTwist).find("linear blend")->points.back().x.median), lost(kTwist, "linear blend"),
        lost(kTwist, "dual quaternion"), short_number(chart.panel(kBend).find("linear blend")->points.back().x.median),
        lost(kBend, "linear blend"), lost(kBend, "dual quaternion"), does_bulge ? " (less than nothing: it bulges)" : "",
        short_number(vertices), short_number(last("linear blend") / copy), short_number(last("dual quaternion") / copy));
}

}  // namespace

Chart skinning(Sweep& sweep) {
    const Settings settings = sweep.settings();
    Chart chart{.name = "skinning", .question = find_chart("skinning").question, .columns = 3};
    const Axis angle{.name = "angle", .unit = "degrees"}, lost{.name = "volume lost", .unit = "%"};
    chart.panels = {{.name = kTwist, .x = angle, .y = lost},
                    {.name = kBend, .x = angle, .y = lost},
                    {.name = kTime,
                     .x = {.name = "vertices", .unit = "", .is_log = true},
                     .y = {.name = "time", .unit = "ns a vertex"}}};
    std::vector<Step> steps;
    for (int degrees = 0; degrees <= 180; degrees += settings.pick(60, 15, 5)) {
        steps.push_back({.name = fmt::format("{} degrees", degrees), .measure = [=] { return measure_volume(degrees); }});
    }
    const int most_rings = settings.pick(100, 10'000, 40'000);
    for (int rings = 32; rings <= most_rings; rings *= 4) {
        steps.push_back({.name = fmt::format("{} rings", rings), .measure = [=] { return measure_time(rings, settings); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
