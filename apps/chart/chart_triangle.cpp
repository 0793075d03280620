#include <algorithm>
#include <atomic>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "apps/bench/peer_tree.h"
#include "apps/bench/stopwatch.h"
#include "apps/bench/timed_parallel.h"
#include "apps/chart/charts.h"
#include "apps/chart/closed_ball.h"
#include "apps/chart/measure.h"
#include "apps/chart/triangle_tests.h"
#include "apps/common/lone_blas.h"
#include "engine/math/parallel.h"
#include "engine/math/rng.h"

namespace zoe::chart {
namespace {

constexpr const char* kMissed = "One test: missed at edges";
constexpr const char* kError = "One test: error of t (99 of 100 below)";
constexpr const char* kThroughTrees = "Rays through trees: missed at edges";
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A method as `bool(ray, its frame, triangle, &hit)`.
using Test = bool (*)(const Ray&, const RayFrame&, const Triangle&, TriangleHit*);

struct Method {
    const char* series;
    Test test;
};
constexpr Method kMethods[] = {
    {"Moeller-Trumbore", [](const Ray& ray, const RayFrame&, const Triangle& t,
                            TriangleHit* hit) { return intersect_moeller_trumbore(ray, t, hit); }},
    {"Woop, in float",
     [](const Ray&, const RayFrame& frame, const Triangle& t, TriangleHit* hit) { return intersect_woop(frame, t, hit); }},
    {"ours", [](const Ray&, const RayFrame& frame, const Triangle& t, TriangleHit* hit) {
         return intersect(frame, t, 0.0f, 0.0f, kInfinity, hit);
     }}};

struct Missed {
    uint64_t missed = 0, shot = 0;
};

/// Where nothing is missed, the rate that one may still bet on, 19 to 1: 3 of so many.
Point missed_point(const Spread& x, const Missed& counted) {
    const auto [missed, shot] = counted;
    const double per_billion = 1e9 * static_cast<double>(missed > 0 ? missed : 3) / static_cast<double>(shot);
    // Counts scatter by their root.
    const double scatter = missed > 0 ? 1.0 / std::sqrt(static_cast<double>(missed)) : 0.0;
    return {.x = x,
            .y = {per_billion, missed > 0 ? per_billion * std::max(0.1, 1.0 - scatter) : per_billion,
                  missed > 0 ? per_billion * (1.0 + scatter) : per_billion},
            .label = missed > 0 ? "" : fmt::format("none of {}", short_number(static_cast<double>(shot)))};
}

uint64_t count_missed(const ClosedBall& ball, const Method& method, size_t first, size_t last) {
    std::atomic<uint64_t> missed = 0;
    parallel_for(first, last, 4096, [&](size_t begin, size_t end) {
        uint64_t missed_here = 0;
        for (size_t k = begin; k < end; ++k) {
            const EdgeRay shot = edge_ray(ball, 1, k);
            const RayFrame frame(shot.ray);
            bool is_hit = false;
            for (const uint32_t vertex : {shot.a, shot.b}) {
                for (const uint32_t triangle : ball.around[vertex]) {
                    TriangleHit hit;
                    is_hit |= method.test(shot.ray, frame, ball.triangle(triangle), &hit);
                }
            }
            missed_here += !is_hit;
        }
        missed += missed_here;
    });
    return missed;
}

/// Until so many are missed that the rate is known to a hundredth: rays are for those who miss few.
Missed count_missed(const ClosedBall& ball, const Method& method, size_t ray_count) {
    constexpr size_t kAtOnce = 1'000'000;
    constexpr uint64_t kEnough = 10'000;
    Missed sum;
    while (sum.shot < ray_count && sum.missed < kEnough) {
        stop_if_interrupted();
        const size_t end = std::min(ray_count, sum.shot + kAtOnce);
        sum.missed += count_missed(ball, method, sum.shot, end);
        sum.shot = end;
    }
    return sum;
}

/// Each ray against the triangles around what it is aimed at.
double test_ns(const ClosedBall& ball, const Method& method, const std::vector<EdgeRay>& shots) {
    size_t tests = 0, hits = 0;
    std::vector<RayFrame> frames;
    for (const EdgeRay& shot : shots) frames.emplace_back(shot.ray);
    Stopwatch watch;
    for (int repeat = 0; repeat < 20; ++repeat) {
        for (size_t k = 0; k < shots.size(); ++k) {
            for (const uint32_t triangle : ball.around[shots[k].a]) {
                TriangleHit hit;
                hits += method.test(shots[k].ray, frames[k], ball.triangle(triangle), &hit);
                ++tests;
            }
        }
    }
    const double ms = watch.restart_ms();
    if (hits == 0) throw std::logic_error("rays aimed at a ball hit nothing");
    return 1e6 * ms / static_cast<double>(tests);
}

struct Shot {
    Ray ray;
    Triangle triangle;
};

/// At triangles of many sizes and places, up to 1,000 times as long as wide, seen edge on down to one part in 1,000.
Shot random_shot(Rng& rng) {
    const auto log_uniform = [&](float lo, float hi) { return lo * std::pow(hi / lo, rng.uniform()); };
    const float size = log_uniform(1e-2f, 1e2f), width = log_uniform(1e-3f, 1.0f);
    const glm::vec3 place = random_direction(rng) * size * log_uniform(0.1f, 100.0f);
    const glm::vec3 along = random_direction(rng), across = glm::normalize(glm::cross(along, random_direction(rng)));
    const auto point = [&](float x, float y) { return place + size * (x * along + y * width * across); };
    Shot shot;
    shot.triangle = {point(0, 0), point(1, 0), point(rng.uniform(), 1), 0};
    const float u = rng.uniform(), v = rng.uniform() * (1.0f - u);
    const glm::vec3 target = (1 - u - v) * shot.triangle.a + u * shot.triangle.b + v * shot.triangle.c;
    const glm::vec3 towards =
        along * rng.uniform(-1, 1) + across * rng.uniform(-1, 1) + glm::cross(along, across) * log_uniform(1e-3f, 1.0f);
    shot.ray.origin = target - glm::normalize(towards) * size * log_uniform(0.1f, 100.0f);
    shot.ray.direction = glm::normalize(target - shot.ray.origin);
    return shot;
}

/// Where the ray, as it is, meets the triangle's plane.
double exact_t(const Ray& ray, const Triangle& triangle) {
    using Vec3 = glm::vec<3, long double>;
    const Vec3 a(triangle.a), b(triangle.b), c(triangle.c), o(ray.origin), d(ray.direction);
    const Vec3 normal = glm::cross(b - a, c - a);
    return static_cast<double>(glm::dot(normal, a - o) / glm::dot(normal, d));
}

/// In units of the last place of t as a float: median, the one that 99 of 100 stay below, worst.
Spread error_ulps(const Method& method, size_t shot_count) {
    Rng rng(2);
    std::vector<double> errors;
    for (size_t k = 0; k < shot_count; ++k) {
        const Shot shot = random_shot(rng);
        const RayFrame frame(shot.ray);
        TriangleHit hit;
        const double t = exact_t(shot.ray, shot.triangle);
        if (!(t > 0.0) || !method.test(shot.ray, frame, shot.triangle, &hit)) continue;
        const auto near = static_cast<float>(t);
        errors.push_back(std::abs(hit.t - t) / (double(std::nextafter(near, kInfinity)) - near));
    }
    std::ranges::sort(errors);
    return {errors[errors.size() * 99 / 100], errors[errors.size() / 2], errors.back()};
}

std::vector<Row> measure_tests(const Settings& settings) {
    const ClosedBall ball(64);
    const size_t ray_count = settings.pick<size_t>(50'000, 3'000'000, 50'000'000),
                 shot_count = settings.pick<size_t>(20'000, 200'000, 2'000'000);
    std::vector<EdgeRay> shots;
    for (size_t k = 0; k < 2000; ++k) shots.push_back(edge_ray(ball, 3, k));
    std::vector<std::function<double()>> works;
    for (const Method& method : kMethods) works.emplace_back([&] { return test_ns(ball, method, shots); });
    const std::vector<std::vector<double>> ns = measure_in_turn(works, settings.pick(3, 9, 15));
    std::vector<Row> rows;
    for (size_t k = 0; k < std::size(kMethods); ++k) {
        const Spread x = spread_of(ns[k]);
        Point missed = missed_point(x, count_missed(ball, kMethods[k], ray_count));
        Point error{.x = x, .y = error_ulps(kMethods[k], shot_count)};
        missed.is_default = error.is_default = std::string_view(kMethods[k].series) == "ours";
        rows.push_back({.panel = kMissed, .series = kMethods[k].series, .point = missed});
        rows.push_back({.panel = kError, .series = kMethods[k].series, .point = error});
    }
    return rows;
}

Missed count_missed(const std::vector<EdgeRay>& shots, const std::vector<Hit>& hits) {
    Missed sum{.shot = shots.size()};
    // A ray that slips through hits the far side.
    for (size_t k = 0; k < shots.size(); ++k) sum.missed += !(hits[k].t <= shots[k].t * 1.001f);
    return sum;
}

/// The kernels that rays go through, single rays.
std::vector<Row> measure_trees(const Settings& settings) {
    const ClosedBall ball(64);
    const size_t ray_count = settings.pick<size_t>(50'000, 1'000'000, 2'000'000);
    std::vector<EdgeRay> shots(ray_count);
    std::vector<Ray> rays(ray_count);
    for (size_t k = 0; k < ray_count; ++k) rays[k] = (shots[k] = edge_ray(ball, 4, k)).ray;
    Blas blas;
    build_blas(ball.mesh.positions, ball.mesh.corners, BlasBuilder::kSweep, &blas);
    const LoneBlas frame(blas);
    std::vector<std::string> series = {"ours"};
    std::vector<std::vector<Hit>> hits(1, std::vector<Hit>(ray_count));
    std::vector<std::function<double()>> works = {[&] {
        return timed_parallel(ray_count, kRaysATask, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) {
                RawHit hit;
                closest_hits(frame.levels(), {&rays[k], 1}, &hit, nullptr);
                hits[0][k].t = hit.t;
            }
        });
    }};
    std::vector<PeerTree> peers;
    if (settings.has_peer) {
        for (const bool is_robust : {false, true}) {
            peers.emplace_back(PeerTree::Quality::kMedium, is_robust, ball.mesh.positions, ball.mesh.corners,
                               thread_count());
            series.push_back(is_robust ? "Embree robust" : "Embree fast");
            hits.emplace_back(ray_count);
        }
        for (size_t k = 0; k < peers.size(); ++k)
            works.emplace_back([&, k] { return peers[k].closest_hits(rays, EmbreeRays::kSingle, hits[k + 1]); });
    }
    const std::vector<std::vector<double>> ms = measure_in_turn(works, settings.pick(3, 5, 9));
    std::vector<Row> rows;
    for (size_t k = 0; k < works.size(); ++k) {
        std::vector<double> ray_ns = ms[k];
        for (double& time : ray_ns) time *= 1e6 / static_cast<double>(ray_count);
        Point point = missed_point(spread_of(ray_ns), count_missed(shots, hits[k]));
        point.is_default = series[k] == "ours";
        rows.push_back({.panel = kThroughTrees, .series = series[k], .point = point});
    }
    return rows;
}

std::string missed_text(const Point& point) {
    return point.label.empty() ? short_number(point.y.median / 1e7) + " %" : point.label;
}

std::string caption(const Chart& chart) {
    const auto only = [&](const char* panel, const char* series) -> const Point& {
        return chart.panel(panel).find(series)->points.front();
    };
    const Point &ours = only(kMissed, "ours"), &simple = only(kMissed, "Moeller-Trumbore"),
                &woop = only(kMissed, "Woop, in float");
    const Point &our_error = only(kError, "ours"), &simple_error = only(kError, "Moeller-Trumbore");
    std::string text = fmt::format(
        "Rays at the edges and vertices of a closed ball. The default, with edges and t in double, misses {}; "
        "Moeller-Trumbore {}; Woop et al. in float {}. A test takes {} ns, {} times Moeller-Trumbore's time (one at a "
        "time; the kernels test four at once). 99 of 100 of its t are within {} units in the last place, "
        "Moeller-Trumbore's within {} (bars: median and worst).",
        missed_text(ours), missed_text(simple), missed_text(woop), short_number(ours.x.median),
        short_number(ours.x.median / simple.x.median), short_number(our_error.y.median),
        short_number(simple_error.y.median));
    if (chart.panel(kThroughTrees).find("Embree fast")) {
        text += fmt::format(" Through trees, a ray each time: ours misses {}, Embree {} (fast) and {} (robust).",
                            missed_text(only(kThroughTrees, "ours")), missed_text(only(kThroughTrees, "Embree fast")),
                            missed_text(only(kThroughTrees, "Embree robust")));
    }
    return text;
}

}  // namespace

Chart triangle(Sweep& sweep) {
    const Axis test{.name = "a test", .unit = "ns"};
    const Axis missed{.name = "missed of a billion rays", .unit = "", .is_log = true};
    Chart chart{.name = "triangle", .question = find_chart("triangle").question, .columns = 3};
    chart.panels = {
        {.name = kMissed, .x = test, .y = missed, .is_trade = true, .has_labels = true},
        {.name = kError,
         .x = test,
         .y = {.name = "error", .unit = "units in the last place", .is_log = true},
         .is_trade = true},
        {.name = kThroughTrees, .x = {.name = "a ray", .unit = "ns"}, .y = missed, .is_trade = true, .has_labels = true}};
    const Settings settings = sweep.settings();
    sweep.run({{.name = "tests", .measure = [=] { return measure_tests(settings); }},
               {.name = "trees", .measure = [=] { return measure_trees(settings); }}},
              &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
