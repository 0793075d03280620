#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/played.h"
#include "apps/common/screen_error.h"
#include "engine/render/denoise.h"
#include "engine/render/path.h"
#include "engine/render/upsample.h"

namespace zoe::chart {
namespace {

constexpr const char* kPanel = "RMSE on a screen, frames of the default scene in motion";
constexpr const char* kStretched = "stretched";
constexpr double kFrameS = 1.0 / 24.0;  // as films have it

/// A picture as it is shown.
struct Shown {
    int width, height;
    std::vector<uint8_t> rgba;
};

/// As a window stretches its texture.
Shown stretch(const Shown& from, int width, int height) {
    Shown to{width, height, std::vector<uint8_t>(size_t{4} * width * height)};
    const auto place = [](int i, int count, int from_count) {
        const double at = std::clamp((i + 0.5) * from_count / count - 0.5, 0.0, from_count - 1.0);
        const int first = static_cast<int>(at);
        return std::pair(first, at - first);
    };
    for (int y = 0; y < height; ++y) {
        const auto [top, down] = place(y, height, from.height);
        for (int x = 0; x < width; ++x) {
            const auto [left, right] = place(x, width, from.width);
            for (int c = 0; c < 4; ++c) {
                const auto at = [&](int i, int j) {
                    const int column = std::min(i, from.width - 1), row = std::min(j, from.height - 1);
                    return double(from.rgba[4 * (size_t{1} * row * from.width + column) + c]);
                };
                const double above = std::lerp(at(left, top), at(left + 1, top), right),
                             below = std::lerp(at(left, top + 1), at(left + 1, top + 1), right);
                to.rgba[4 * (size_t{1} * y * width + x) + c] =
                    static_cast<uint8_t>(std::lround(std::lerp(above, below, down)));
            }
        }
    }
    return to;
}

/// Lights are those of the frame's pixels, smoothed.
struct Lights {
    std::vector<Film> films;
    double seconds;  ///< A frame.
};
Lights smooth(const Played& played) {
    Lights lights{played.films, 0.0};
    Denoiser denoiser;
    const auto start = std::chrono::steady_clock::now();
    for (size_t i = 0; i < played.films.size(); ++i) denoiser.filter(played.guides[i], {}, &lights.films[i]);
    lights.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / Played::kFrames + played.seconds;
    return lights;
}

/// Surfaces that light is put on.
struct Surfaces {
    const char* series;
    int divisor;  ///< Of their sides.
};
constexpr Surfaces kSurfaces[] = {{"on full surfaces", 1}, {"on surfaces of half", 2}, {"on surfaces of a third", 3}};

/// As the window chooses (apps/demo/pace.h): the finest surfaces that take half of the time at most, then the finest light.
struct Choosing {
    size_t row;
    int surfaces, light;
    double surface_s, light_s;

    bool is_in_time() const { return surface_s <= 0.5 * kFrameS && surface_s + light_s <= kFrameS; }
    bool is_before(const Choosing& other) const {
        return std::pair(surfaces, light) < std::pair(other.surfaces, other.light);
    }
};

std::vector<Row> measure(const Settings& settings) {
    const int width = settings.pick(160, 640, 640), height = settings.pick(90, 360, 360);
    const int reference_count = settings.pick(1, 1, 2), begin = Played::kFrames - reference_count;
    const std::vector<Film> references = Played({.width = width,
                                                 .height = height,
                                                 .sample_count = settings.pick(64, 32, 128),
                                                 .bounce_count = RenderConfig{}.max_bounces,
                                                 .is_jittered = true,
                                                 .first_number = Played::kReferenceBegin,
                                                 .begin = begin})
                                             .films;
    std::vector<Row> rows;
    std::optional<Choosing> chosen;
    const auto add = [&](const char* series, int divisor, double seconds, const std::vector<Film>& films) {
        double error = 0.0;
        for (size_t i = 0; i < references.size(); ++i) {
            const Film& film = films[films.size() - references.size() + i];
            const Shown shown = stretch({film.width, film.height, to_rgba8(film)}, width, height);
            error += screen_error(shown.rgba, to_rgba8(references[i])) / double(references.size());
        }
        rows.push_back(
            {.panel = kPanel,
             .series = series,
             .point = {.x = Spread::exactly(seconds), .y = Spread::exactly(error), .label = std::to_string(divisor)}});
    };
    std::vector<Played> surfaces;  // The first of them find no memory ready: two go ahead.
    for (const Surfaces& some : kSurfaces) {
        surfaces.emplace_back(Played::Way{
            .width = width / some.divisor, .height = height / some.divisor, .is_lit = false, .begin = begin - 2});
    }
    for (const int divisor : {2, 3, 4, 5, 6, 8, 10, 12}) {
        const Played played({.width = width / divisor, .height = height / divisor});
        const Lights lights = smooth(played);
        add(kStretched, divisor, lights.seconds, lights.films);
        for (size_t s = 0; s < surfaces.size(); ++s) {
            if (kSurfaces[s].divisor >= divisor) continue;
            std::vector<Film> films(surfaces[s].films.end() - reference_count, surfaces[s].films.end());
            const std::vector<Guides> guides(surfaces[s].guides.end() - reference_count, surfaces[s].guides.end());
            Upsampler upsampler;
            const auto start = std::chrono::steady_clock::now();
            for (size_t i = 0; i < films.size(); ++i)
                upsampler.light(played.guides[begin + i], lights.films[begin + i], guides[i], &films[i]);
            const double upsample_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const Choosing choosing{.row = rows.size(),
                                    .surfaces = kSurfaces[s].divisor,
                                    .light = divisor,
                                    .surface_s = surfaces[s].seconds + upsample_s / double(films.size()),
                                    .light_s = lights.seconds};
            add(kSurfaces[s].series, divisor, choosing.surface_s + choosing.light_s, films);
            if (choosing.is_in_time() && (!chosen || choosing.is_before(*chosen))) chosen = choosing;
        }
    }
    if (chosen) rows[chosen->row].point.is_default = true;
    return rows;
}

/// A point, and what it is of.
struct Choice {
    const char* series;
    const Point* point;
};
/// Of what a film's frame has time for, that of the least error; else the fastest.
Choice best_in_time(const Panel& panel, const std::vector<const char*>& series) {
    Choice best{};
    for (const char* const name : series) {
        for (const Point& point : panel.find(name)->points) {
            const auto price = [&](const Point& p) {
                return p.x.median <= kFrameS ? std::pair(0.0, p.y.median) : std::pair(p.x.median, 0.0);
            };
            if (best.point == nullptr || price(point) < price(*best.point)) best = {name, &point};
        }
    }
    return best;
}

/// What a series has in so much time, between two of its points; none beyond them.
std::optional<double> error_in_time(const std::vector<Point>& points, double seconds) {
    for (size_t k = 1; k < points.size(); ++k) {
        const Point &a = points[k - 1], &b = points[k];
        const double share = std::log(seconds / a.x.median) / std::log(b.x.median / a.x.median);
        if (share >= 0.0 && share <= 1.0) return std::exp(std::lerp(std::log(a.y.median), std::log(b.y.median), share));
    }
    return {};
}

std::string caption(const Chart& chart) {
    const Panel& panel = chart.panel(kPanel);
    const Choice stretched = best_in_time(panel, {kStretched});
    std::vector<const char*> names;
    for (const Surfaces& some : kSurfaces) names.push_back(some.series);
    const Choice guided = best_in_time(panel, names);
    const auto& all = panel.find(kStretched)->points;
    const auto as_coarse = std::ranges::find(all, guided.point->label, &Point::label);
    // The coarsest, and so the fastest, comes last.
    const auto equal =
        std::ranges::find_if(all.rbegin(), all.rend(), [&](const Point& p) { return p.y.median <= guided.point->y.median; });
    const auto share_of = [&](double error) { return short_number(guided.point->y.median / error); };
    const std::optional<double> in_time = error_in_time(all, guided.point->x.median);
    return fmt::format(
        "Points: light of half, a third, ... of the picture's sides, one sample for each of its pixels, smoothed; against "
        "pictures with very many, as a window shows them. Ring: as the window chooses. Of what a film's frame has time for, "
        "the least error of light that is stretched is {} (sides divided by {}); {} it is {} (light by {}): {} of that of "
        "light as coarse{}. {}.",
        short_number(stretched.point->y.median), stretched.point->label, guided.series, short_number(guided.point->y.median),
        guided.point->label, share_of(as_coarse->y.median),
        in_time ? fmt::format(", {} of that of as much time", share_of(*in_time)) : "",
        equal == all.rend() ? "No light that is stretched has so little here"
                            : fmt::format("Stretched, it is as little in {} times the time",
                                          short_number(equal->x.median / guided.point->x.median)));
}

}  // namespace

Chart upsample(Sweep& sweep) {
    Chart chart{.name = "upsample", .question = find_chart("upsample").question};
    const Axis time{.name = "time a frame", .unit = "s", .is_log = true};
    const Axis error{.name = "RMSE", .unit = "of white, sRGB", .is_log = true};
    chart.panels = {{.name = kPanel, .x = time, .y = error, .is_trade = true, .has_labels = true}};
    const Settings settings = sweep.settings();
    sweep.run({{.name = "frames", .measure = [=] { return measure(settings); }}}, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
