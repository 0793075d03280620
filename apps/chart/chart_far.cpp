#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "apps/bench/peer_embree.h"
#include "apps/chart/charts.h"
#include "apps/chart/closed_ball.h"
#include "apps/chart/measure.h"
#include "engine/math/parallel.h"
#include "engine/zoetrope.h"
#include "tests/support/brute_force.h"

namespace zoe::chart {
namespace {

constexpr const char* kWrong = "Rays that hit another triangle, or none, or one too many";
constexpr const char* kError = "Error of where those with the right triangle hit it";
constexpr int kBatches = 5;
/// Less is nothing, on an axis of powers of ten.
constexpr double kLeastError = 1e-9;

/// A ball at a distance: as local vertices and a matrix, or with vertices in the world. All numbers that are given are
/// floats; the truth is what they mean.
struct Placed {
    const char* series;
    const char* peer_series;
    bool is_turned, is_baked;
    bool is_rebased;  ///< The world begins where the ball is: Scene::origin.
    EmbreeConfig::Layout peer_layout;
};
constexpr Placed kPlaced[] = {
    {"instanced", nullptr, false, false, false, EmbreeConfig::Layout::kInstances},
    {"instanced, turned", "Embree, instances", true, false, false, EmbreeConfig::Layout::kInstances},
    {"re-based, turned", nullptr, true, false, true, EmbreeConfig::Layout::kInstances},
    {"baked", "Embree, one scene", true, true, false, EmbreeConfig::Layout::kOneScene},
};

ClosedBall make_ball() {
    return ClosedBall(48);
}

glm::vec3 place_at(double distance) {
    return static_cast<float>(distance) * glm::normalize(glm::vec3(0.62f, 0.35f, -0.7f));
}

Trs trs_of(const Placed& placed, double distance) {
    Trs trs;
    trs.translation = place_at(distance);
    if (placed.is_turned) trs.rotation = glm::angleAxis(1.1f, glm::normalize(glm::vec3(1, 2, 3)));
    return trs;
}

glm::dvec3 in_double(const DAffine& a, const glm::vec3& p) {
    return a.linear * glm::dvec3(p) + a.translation;
}

glm::dvec3 origin_of(const Placed& placed, const Trs& trs) {
    return placed.is_rebased ? glm::dvec3(trs.translation) : glm::dvec3(0.0);
}

Scene make_scene(const ClosedBall& ball, const Placed& placed, const Trs& trs) {
    Scene scene;
    Mesh mesh = ball.mesh;
    Node node;
    if (placed.is_baked) {
        for (glm::vec3& p : mesh.positions) p = glm::vec3(in_double(to_daffine(trs), p));
    } else {
        node.local = trs;
    }
    node.mesh = scene.add(std::move(mesh));
    scene.add(std::move(node));
    scene.origin = origin_of(placed, trs);
    return scene;
}

test::BruteForce make_truth(const ClosedBall& ball, const Trs& trs, const glm::dvec3& origin) {
    DAffine world_from_local = to_daffine(trs);
    world_from_local.translation -= origin;
    std::vector<test::WorldTriangle> triangles;
    for (uint32_t k = 0; k < ball.mesh.corners.size(); ++k) {
        const Triangle t = ball.triangle(k);
        triangles.push_back({.a = in_double(world_from_local, t.a),
                             .b = in_double(world_from_local, t.b),
                             .c = in_double(world_from_local, t.c),
                             .node = 0,
                             .primitive = k});
    }
    return test::BruteForce(std::move(triangles));
}

/// From around the ball at points in and beside it, as floats far from the origin can say it.
std::vector<Ray> make_rays(const glm::vec3& place, size_t count) {
    Rng rng(5);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.origin = place + 3.0f * random_direction(rng);
        const glm::vec3 target = place + 1.1f * std::cbrt(rng.uniform()) * random_direction(rng);
        ray.direction = target - ray.origin;
    }
    return rays;
}

using RightHits = std::vector<std::optional<test::OracleHit>>;
RightHits hits_of(const test::BruteForce& truth, const std::vector<Ray>& rays) {
    RightHits hits(rays.size());
    parallel_for(0, rays.size(), 64, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k)
            hits[k] = truth.closest_hit({.origin = glm::dvec3(rays[k].origin), .direction = glm::dvec3(rays[k].direction)});
    });
    return hits;
}

struct Compared {
    Spread wrong_share, error;
};

/// Batch by batch.
Compared compare(const std::vector<Ray>& rays, const std::vector<Hit>& hits, const RightHits& right_hits) {
    std::vector<int8_t> is_wrong(rays.size());
    std::vector<double> errors(rays.size(), -1.0);
    for (size_t k = 0; k < rays.size(); ++k) {
        const std::optional<test::OracleHit>& right = right_hits[k];
        is_wrong[k] = bool(right) != bool(hits[k]) || (right && right->triangle != hits[k].primitive);
        if (right && !is_wrong[k]) errors[k] = std::abs(hits[k].t - right->t) * glm::length(glm::dvec3(rays[k].direction));
    }
    std::vector<double> shares, all_errors;
    const size_t size = rays.size() / kBatches;
    for (size_t batch = 0; batch < kBatches; ++batch) {
        const auto begin = is_wrong.begin() + static_cast<std::ptrdiff_t>(batch * size);
        const auto wrong = std::count(begin, begin + static_cast<std::ptrdiff_t>(size), 1);
        shares.push_back(static_cast<double>(wrong) / static_cast<double>(size));
    }
    std::ranges::copy_if(errors, std::back_inserter(all_errors), [](double error) { return error >= 0.0; });
    for (double& error : all_errors) error = std::max(error, kLeastError);
    return {spread_of(shares), spread_of(all_errors.empty() ? std::vector<double>{kLeastError} : all_errors)};
}

void add_rows(const char* series, bool is_default, double distance, const Compared& compared, std::vector<Row>* rows) {
    const auto percent = [](double share) { return 100.0 * share; };
    const Spread& wrong = compared.wrong_share;
    const Spread x = Spread::exactly(distance);
    rows->push_back(
        {.panel = kWrong,
         .series = series,
         .point = {
             .x = x, .y = {percent(wrong.median), percent(wrong.low), percent(wrong.high)}, .is_default = is_default}});
    rows->push_back({.panel = kError, .series = series, .point = {.x = x, .y = compared.error, .is_default = is_default}});
}

std::vector<Row> measure(double distance, const Settings& settings) {
    const ClosedBall ball = make_ball();
    std::vector<Row> rows;
    for (const Placed& placed : kPlaced) {
        stop_if_interrupted();
        const Trs trs = trs_of(placed, distance);
        const glm::vec3 place(glm::dvec3(trs.translation) - origin_of(placed, trs));
        const std::vector<Ray> rays = make_rays(place, settings.pick<size_t>(500, 5'000, 40'000));
        const RightHits right = hits_of(make_truth(ball, trs, origin_of(placed, trs)), rays);
        Scene scene = make_scene(ball, placed, trs);
        const Tlas& tlas = advance(scene, 0.0);
        std::vector<Hit> hits(rays.size());
        closest_hits(tlas, rays, hits);
        // What the engine does with a node that has a matrix.
        add_rows(placed.series, !placed.is_baked && !placed.is_rebased, distance, compare(rays, hits, right), &rows);
        if (!settings.has_peer || !placed.peer_series) continue;
        EmbreePeer peer({.layout = placed.peer_layout}, thread_count());
        peer.update(scene, tlas);
        peer.closest_hits(rays, RayKind::kDiffuse, hits);
        add_rows(placed.peer_series, false, distance, compare(rays, hits, right), &rows);
    }
    return rows;
}

/// How far out a method's rays are wrong no more often than that; 0 where they always are.
double reach(const Chart& chart, const char* series, double percent) {
    double distance = 0.0;
    for (const Point& point : chart.panel(kWrong).find(series)->points) {
        if (point.y.median > percent) break;
        distance = point.x.median;
    }
    return distance;
}

std::string caption(const Chart& chart) {
    constexpr double kFew = 1.0;
    const double farthest = chart.panel(kError).find("baked")->points.back().x.median;
    const auto error = [&](const char* series) { return short_number(chart.point(kError, series, farthest).y.median); };
    std::string text = fmt::format("A ball of {} triangles. At most {} % of rays are wrong out to",
                                   short_number(make_ball().mesh.corners.size()), kFew);
    for (const Placed& placed : kPlaced)
        text += fmt::format("{} {} ({})", &placed == kPlaced ? "" : ",", short_number(reach(chart, placed.series, kFew)),
                            placed.series);
    text += fmt::format(
        " times its radius from the origin. The default keeps vertices local and moves the ray. At a distance of {} radii "
        "its "
        "hits are off by {} radii where the matrix only moves the ball and by {} where it turns it, too; those on vertices "
        "that were placed in double and rounded to float by {}; those where the world begins at the ball (--origin) by {}.",
        short_number(farthest), error("instanced"), error("instanced, turned"), error("baked"), error("re-based, turned"));
    return text;
}

}  // namespace

Chart far(Sweep& sweep) {
    Chart chart{.name = "far", .question = find_chart("far").question, .columns = 2};
    const Axis distance{.name = "distance from the origin / radius", .unit = "", .is_log = true};
    chart.panels = {{.name = kWrong, .x = distance, .y = {.name = "wrong rays", .unit = "%"}},
                    {.name = kError, .x = distance, .y = {.name = "distance / radius", .unit = "", .is_log = true}}};
    std::vector<Step> steps;
    for (int exponent = 0; exponent <= 14; exponent += sweep.settings().pick(4, 2, 1)) {
        const double value = std::pow(10.0, 0.5 * exponent);
        steps.push_back({.name = short_number(value), .measure = [=, &sweep] { return measure(value, sweep.settings()); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
