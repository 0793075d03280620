#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/common/choose_view.h"
#include "apps/common/open_scene.h"
#include "apps/common/screen_error.h"
#include "engine/render/denoise.h"
#include "engine/render/past_frame.h"
#include "engine/render/path.h"

namespace zoe::chart {
namespace {

constexpr const char* kPanel = "RMSE on a screen, frames of the default scene in motion";
constexpr const char* kSettings = "RMSE on a screen by settings of the filter";
constexpr double kFps = 24.0;
constexpr int kFirstFrame = 30, kFrames = 10;
/// Samples of the converged pictures are others than those of the frames.
constexpr uint32_t kReferenceBegin = 1 << 20;

/// Frames as the window plays them, and what they would converge to.
class Frames {
public:
    explicit Frames(const Settings& settings) : width_(settings.pick(64, 128, 256)), height_(settings.pick(36, 72, 144)) {}

    struct Render {
        std::vector<Film> films;
        std::vector<Guides> guides;
        double seconds = 0.0;  ///< A frame.
    };
    /// Plays the frames with so many samples a pixel.
    Render play(int sample_count, int bounce_count, uint32_t first_number, int begin = 0) const {
        Content content = open_scene("default", kFps);
        Render result;
        PastFrame past;
        for (int i = begin; i < kFrames; ++i) {
            stop_if_interrupted();
            const Tlas& tlas = advance(content, (kFirstFrame + i) / kFps, nullptr);
            const View view =
                ViewChoice{.camera = camera_nodes(content.scene).back()}.view(content.scene, float(width_) / float(height_));
            RenderConfig config;
            config.max_bounces = bounce_count;
            config.is_jittered = false;
            config.first_number = first_number + static_cast<uint32_t>(i * sample_count);
            Film& film = result.films.emplace_back(width_, height_);
            Guides& guides = result.guides.emplace_back();
            config.guides = &guides;
            guides.past = &past;
            const auto start = std::chrono::steady_clock::now();
            render(content.scene, tlas, view, config, sample_count, &film, nullptr);
            result.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            guides.past = nullptr;  // What it holds is in the guides now.
            past.keep(tlas, view);
        }
        result.seconds /= kFrames - begin;
        return result;
    }

private:
    int width_, height_;
};

struct Result {
    double seconds, error;  ///< A frame.
};
/// config     none: as rendered. Frames before the last ones are only history.
Result judge(const Frames::Render& render, const std::optional<DenoiseConfig>& config, const std::vector<Film>& references) {
    Denoiser denoiser;
    Result result{render.seconds, 0.0};
    double filter_seconds = 0.0;
    for (size_t i = 0; i < render.films.size(); ++i) {
        Film film = render.films[i];
        const auto start = std::chrono::steady_clock::now();
        if (config) denoiser.filter(render.guides[i], *config, &film);
        filter_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const size_t from_end = render.films.size() - i;
        if (from_end <= references.size()) result.error += screen_error(film, references[references.size() - from_end]);
    }
    result.seconds += filter_seconds / static_cast<double>(render.films.size());
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
    const Frames frames(settings);
    const int reference_count = settings.pick(1, 2, 4);
    const std::vector<Film> references =
        frames.play(settings.pick(64, 128, 512), RenderConfig{}.max_bounces, kReferenceBegin, kFrames - reference_count)
            .films;
    std::vector<Row> rows;
    for (const int bounces : {1, 2, 4}) {
        const char* const series = bounces == 1   ? "1 bounce, smoothed"
                                   : bounces == 2 ? "2 bounces, smoothed"
                                                  : "4 bounces, smoothed";
        for (const int samples : {1, 2, 4}) {
            const Frames::Render render = frames.play(samples, bounces, 0);
            const Result smooth = judge(render, DenoiseConfig{}, references);
            rows.push_back(
                row_of(kPanel, series, smooth.seconds, smooth, bounces == 2 && samples == 1, std::to_string(samples)));
            if (bounces == 4) {
                const Result raw = judge(render, {}, references);
                rows.push_back(row_of(kPanel, "4 bounces", raw.seconds, raw, false, std::to_string(samples)));
            }
            if (bounces != 2 || samples != 1) continue;
            for (const Knob& knob : knobs()) {
                for (const double value : knob.values) {
                    DenoiseConfig config;
                    knob.set(value, &config);
                    rows.push_back(row_of(kSettings, knob.series, value, judge(render, config, references),
                                          value == knob.standard, ""));
                }
            }
        }
    }
    for (const int samples : {16, 64}) {
        const Frames::Render render = frames.play(samples, RenderConfig{}.max_bounces, 0, kFrames - reference_count);
        const Result raw = judge(render, {}, references);
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
