#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/filmed.h"
#include "apps/chart/measure.h"
#include "engine/render/noise.h"

namespace zoe::chart {
namespace {

constexpr const char* kError = "Error of the frame";
constexpr const char* kWorst = "Error that one block in twenty exceeds";
constexpr const char* kAsked = "Error: asked for, and there";
constexpr const char* kUniform = "all the same";
constexpr double kTime = 1.0;
constexpr int kLeast[] = {4, 16, 64};
/// Samples before this one are the tested pictures': the reference has others.
constexpr int kReferenceBegin = 1 << 20;

struct Setup {
    Filmed filmed;
    std::vector<double> reference;  // luminance, [height * width]

    explicit Setup(const Settings& settings) : filmed(settings.pick(40, 96, 160), settings.pick(24, 54, 90)) {
        reference = luminances(expose({.target = 0.0f}, settings.pick(1024, 4096, 8192), kReferenceBegin));
    }

    Film expose(const NoiseConfig& noise, int most_samples, int first_sample = 0) {
        stop_if_interrupted();
        Film film(filmed.width, filmed.height);
        FrameStats stats;
        NoiseLimit limit;
        Exposure exposure(filmed.take, {.opens_s = kTime}, {}, &film, &stats);
        if (first_sample == 0) {
            limit.expose(noise, most_samples, &exposure, {}, {});
        } else {
            film.sample_count = first_sample;
            exposure.add(most_samples);
            film.sample_count = most_samples;
        }
        return film;
    }

    static std::vector<double> luminances(const Film& film) {
        std::vector<double> pixels;
        for (size_t k = 0; k < film.sum.size(); ++k) {
            pixels.push_back((0.2126 * film.sum[k].x + 0.7152 * film.sum[k].y + 0.0722 * film.sum[k].z) /
                             film.samples_of(k));
        }
        return pixels;
    }

    /// As NoiseConfig counts it: over the picture, and of the block that one in twenty exceeds.
    struct Error {
        double whole, worst;
    };
    Error error_of(const Film& film) const {
        constexpr int kBlockSide = 8;
        const std::vector<double> pixels = luminances(film);
        const int width = filmed.width, height = filmed.height;
        const int across = (width + kBlockSide - 1) / kBlockSide, down = (height + kBlockSide - 1) / kBlockSide;
        std::vector<double> squares(size_t(across * down)), counts(squares.size());
        double sum = 0.0;
        for (size_t k = 0; k < pixels.size(); ++k) {
            const double error = (pixels[k] - reference[k]) / std::max(reference[k], double(NoiseConfig{}.least_luminance));
            const int x = static_cast<int>(k) % width, y = static_cast<int>(k) / width;
            const auto block = size_t(y / kBlockSide * across + x / kBlockSide);
            squares[block] += error * error;
            ++counts[block];
            sum += error * error;
        }
        for (size_t block = 0; block < squares.size(); ++block) squares[block] /= counts[block];
        std::ranges::sort(squares);
        return {std::sqrt(sum / static_cast<double>(pixels.size())), std::sqrt(squares[squares.size() * 19 / 20])};
    }
};

std::string name_of(int least_samples) {
    return fmt::format("{} samples at least", least_samples);
}

void add_rows(const std::string& series, Point point, double worst, std::vector<Row>* rows) {
    rows->push_back({.panel = kError, .series = series, .point = point});
    point.y = Spread::exactly(worst);
    rows->push_back({.panel = kWorst, .series = series, .point = point});
}

/// Ends where it is better than what is asked for of some.
std::vector<Row> measure_uniform(Setup& setup, const Settings& settings) {
    std::vector<Row> rows;
    for (int count = 4; count <= settings.pick(256, 512, 1024); count *= 2) {
        const Setup::Error error = setup.error_of(setup.expose({.target = 0.0f}, count));
        add_rows(kUniform, {.x = Spread::exactly(count), .y = Spread::exactly(error.whole), .label = std::to_string(count)},
                 error.worst, &rows);
    }
    return rows;
}

std::vector<Row> measure(int least_samples, Setup& setup, const Settings& settings) {
    std::vector<Row> rows;
    for (double target = 0.32; target > settings.pick(0.07, 0.03, 0.015); target /= std::sqrt(2.0)) {
        const NoiseConfig noise{.target = static_cast<float>(target), .least_samples = least_samples};
        const Film film = setup.expose(noise, settings.pick(256, 512, 4096));
        const Setup::Error error = setup.error_of(film);
        Point point{.x = Spread::exactly(mean_samples(film)),
                    .y = Spread::exactly(error.whole),
                    .label = short_number(target),
                    .is_default = least_samples == NoiseConfig{}.least_samples};
        add_rows(name_of(least_samples), point, error.worst, &rows);
        point.x = Spread::exactly(target);
        point.y = Spread::exactly(error.worst);
        rows.push_back({.panel = kAsked, .series = name_of(least_samples), .point = point});
    }
    return rows;
}

/// What the same error costs where all pixels get the same, between two points that were measured, in words.
std::string uniform_samples(const Panel& panel, double error) {
    const std::vector<Point>& points = panel.find(kUniform)->points;
    for (size_t k = 1; k < points.size(); ++k) {
        if (points[k].y.median > error) continue;
        const double above = std::log(points[k - 1].y.median), below = std::log(points[k].y.median);
        const double share = above > below ? std::clamp((above - std::log(error)) / (above - below), 0.0, 1.0) : 0.0;
        return short_number(points[k - 1].x.median * std::exp2(share));
    }
    return "more than " + short_number(points.back().x.median);
}

std::string caption(const Chart& chart) {
    const std::string ours = name_of(NoiseConfig{}.least_samples);
    const auto finest = [&](const char* panel) { return chart.panel(panel).find(ours)->points.back(); };
    const auto uniform = [&](const char* panel) { return uniform_samples(chart.panel(panel), finest(panel).y.median); };
    return fmt::format(
        "Relative error of luminance against a picture of many other samples, in the root mean square over the frame, and "
        "over blocks of 8 x 8. Asked for {}, pixels got {} samples in the mean; one block in twenty is more than {} off, "
        "for which all pixels would need {}. Over the whole frame the error is {}, for which {} would do: who asks for the "
        "same noise "
        "everywhere pays in the noisiest places. Pixels are judged after {} samples (default) and then each time that they "
        "have twice as many.",
        finest(kError).label, short_number(finest(kError).x.median), short_number(finest(kWorst).y.median), uniform(kWorst),
        short_number(finest(kError).y.median), uniform(kError), NoiseConfig{}.least_samples);
}

}  // namespace

Chart noise(Sweep& sweep) {
    Chart chart{.name = "noise", .question = find_chart("noise").question, .columns = 3};
    const Axis error{.name = "error", .unit = "", .is_log = true};
    chart.panels = {{.name = kError,
                     .x = {.name = "samples a pixel, in the mean", .unit = "", .is_log = true},
                     .y = error,
                     .is_trade = true},
                    {.name = kWorst,
                     .x = {.name = "samples a pixel, in the mean", .unit = "", .is_log = true},
                     .y = error,
                     .is_trade = true},
                    {.name = kAsked, .x = {.name = "asked for", .unit = "", .is_log = true}, .y = error}};
    const Settings settings = sweep.settings();
    const Shared<Setup> setup(settings);
    // The first makes the reference.
    std::vector<Step> steps = {
        {.name = kUniform, .share = 8.0, .measure = [=] { return measure_uniform(setup(), settings); }}};
    for (const int least_samples : kLeast) {
        steps.push_back(
            {.name = name_of(least_samples), .measure = [=] { return measure(least_samples, setup(), settings); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
