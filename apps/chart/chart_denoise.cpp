#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/played.h"
#include "apps/common/screen_error.h"
#include "engine/render/denoise.h"
#include "engine/render/path.h"

namespace zoe::chart {
namespace {

constexpr const char* kPanel = "RMSE on a screen, frames of the default scene in motion";
constexpr const char* kSettings = "RMSE on a screen by settings of the filter";
struct Result {
    double seconds, error;  ///< A frame.
};
/// config     none: as rendered. Frames before the last ones are only history.
Result judge(const Played& played, const std::optional<DenoiseConfig>& config, const std::vector<Film>& references) {
    Denoiser denoiser;
    Result result{played.seconds, 0.0};
    double filter_seconds = 0.0;
    for (size_t i = 0; i < played.films.size(); ++i) {
        Film film = played.films[i];
        const auto start = std::chrono::steady_clock::now();
        if (config) denoiser.filter(played.guides[i], *config, &film);
        filter_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const size_t from_end = played.films.size() - i;
        if (from_end <= references.size()) result.error += screen_error(film, references[references.size() - from_end]);
    }
    result.seconds += filter_seconds / static_cast<double>(played.films.size());
    result.error /= static_cast<double>(references.size());
    return result;
}

/// A setting of the filter, and what it is tried at.
struct Knob {
    const char* series;
    std::vector<double> values;
    double standard;
    void (*set)(double value, DenoiseConfig* config);
};

std::vector<Knob> knobs() {
    const DenoiseConfig standard;
    return {{"frames that a mean looks back on",
             {2, 4, 6, 8, 16, 32},
             double(standard.most_frames),
             [](double value, DenoiseConfig* config) { config->most_frames = int(value); }},
            {"rounds of the filter",
             {1, 2, 3, 4, 5, 6},
             double(standard.rounds),
             [](double value, DenoiseConfig* config) { config->rounds = int(value); }},
            {"strength of the filter", {1, 2, 3, 4, 8}, double(standard.strength), [](double value, DenoiseConfig* config) {
                 config->strength = float(value);
             }}};
}

Row row_of(const char* panel, const char* series, double x, const Result& result, bool is_default,
           const std::string& label) {
    Point point{.x = Spread::exactly(x), .y = Spread::exactly(result.error), .label = label};
    point.is_default = is_default;
    return {.panel = panel, .series = series, .point = point};
}

std::vector<Row> measure(const Settings& settings) {
    const int width = settings.pick(64, 128, 256), height = settings.pick(36, 72, 144);
    const int reference_count = settings.pick(1, 2, 4), begin = Played::kFrames - reference_count;
    const std::vector<Film> references = Played({.width = width,
                                                 .height = height,
                                                 .sample_count = settings.pick(64, 128, 512),
                                                 .bounce_count = RenderConfig{}.max_bounces,
                                                 .first_number = Played::kReferenceBegin,
                                                 .begin = begin})
                                             .films;
    std::vector<Row> rows;
    for (const int bounces : {1, 2, 4}) {
        const char* const series = bounces == 1   ? "1 bounce, smoothed"
                                   : bounces == 2 ? "2 bounces, smoothed"
                                                  : "4 bounces, smoothed";
        for (const int samples : {1, 2, 4}) {
            const Played played({.width = width, .height = height, .sample_count = samples, .bounce_count = bounces});
            const Result smooth = judge(played, DenoiseConfig{}, references);
            rows.push_back(
                row_of(kPanel, series, smooth.seconds, smooth, bounces == 2 && samples == 1, std::to_string(samples)));
            if (bounces == 4) {
                const Result raw = judge(played, {}, references);
                rows.push_back(row_of(kPanel, "4 bounces", raw.seconds, raw, false, std::to_string(samples)));
            }
            if (bounces != 2 || samples != 1) continue;
            for (const Knob& knob : knobs()) {
                for (const double value : knob.values) {
                    DenoiseConfig config;
                    knob.set(value, &config);
                    rows.push_back(row_of(kSettings, knob.series, value, judge(played, config, references),
                                          value == knob.standard, ""));
                }
            }
        }
    }
    for (const int samples : {16, 64}) {
        const Played played({.width = width,
                             .height = height,
                             .sample_count = samples,
                             .bounce_count = RenderConfig{}.max_bounces,
                             .begin = begin});
        const Result raw = judge(played, {}, references);
        rows.push_back(row_of(kPanel, "4 bounces", raw.seconds, raw, false, std::to_string(samples)));
    }
    return rows;
}

std::string caption(const Chart& chart) {
    const auto points = [&](const char* series) -> const std::vector<Point>& {
        return chart.panel(kPanel).find(series)->points;
    };
    const Point &smooth = points("2 bounces, smoothed").front(), &raw = points("4 bounces").front();
    const auto equal =
        std::ranges::find_if(points("4 bounces"), [&](const Point& p) { return p.y.median <= smooth.y.median; });
    return fmt::format(
        "Points: 1, 2, 4, ... samples a pixel, against pictures with very many, as a screen shows them. Smoothed by its "
        "neighbours and the frames before, a sample of two bounces has an error of {} where one of four that is shown as it "
        "is "
        "has {}: {} times as much; {}.",
        short_number(smooth.y.median), short_number(raw.y.median), short_number(raw.y.median / smooth.y.median),
        equal == points("4 bounces").end() ? "as many as the chart has do not make up for it"
                                           : fmt::format("{} of them make up for it, in {} times the time", equal->label,
                                                         short_number(equal->x.median / smooth.x.median)));
}

}  // namespace

Chart denoise(Sweep& sweep) {
    Chart chart{.name = "denoise", .question = find_chart("denoise").question, .columns = 2};
    const Axis time{.name = "time a frame", .unit = "s", .is_log = true};
    const Axis error{.name = "RMSE", .unit = "of white, sRGB", .is_log = true};
    chart.panels = {{.name = kPanel, .x = time, .y = error, .is_trade = true, .has_labels = true},
                    {.name = kSettings, .x = {.name = "setting", .unit = "", .is_log = true}, .y = error}};
    const Settings settings = sweep.settings();
    sweep.run({{.name = "frames", .measure = [=] { return measure(settings); }}}, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
