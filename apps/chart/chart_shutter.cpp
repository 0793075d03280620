#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/filmed.h"
#include "apps/chart/measure.h"

namespace zoe::chart {
namespace {

constexpr const char* kByTime = "Time of a frame";
constexpr const char* kBySamples = "Samples a pixel";
/// What turns fastest crosses several pixels.
constexpr double kOpens = 1.0, kOpen = 0.1;
constexpr uint32_t kSlices[] = {1, 4, 16, 64};
/// Samples of this many slices are a picture that counts as exact.
constexpr uint32_t kReferenceSlices = 512;

/// Linear radiance, [height * width].
std::vector<glm::dvec3> expose(const Filmed& filmed, uint32_t slices, uint64_t seed, int sample_count) {
    stop_if_interrupted();
    Film film(filmed.width, filmed.height);
    FrameStats stats;
    // Light itself, but none that bounces: noise that has nothing to do with time would hide what this is about.
    RenderConfig config;
    config.max_bounces = 0;
    const Shutter shutter{.opens_s = kOpens, .open_s = kOpen, .slices = slices, .seed = seed};
    Exposure exposure(filmed.take, shutter, config, &film, &stats);
    exposure.add(sample_count);
    std::vector<glm::dvec3> pixels;
    for (const glm::vec4& sum : film.sum) pixels.push_back(glm::dvec3(sum) / double(film.sample_count));
    return pixels;
}

double rmse(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
    double squares = 0.0;
    for (size_t k = 0; k < a.size(); ++k) squares += glm::dot(a[k] - b[k], a[k] - b[k]) / 3.0;
    return std::sqrt(squares / static_cast<double>(a.size()));
}

std::string name_of(uint32_t slices) {
    return slices == 1 ? "1 slice" : fmt::format("{} slices", slices);
}

struct Setup {
    Filmed filmed;
    std::vector<glm::dvec3> reference;

    explicit Setup(const Settings& settings)
        : filmed(settings.pick(40, 96, 192), settings.pick(24, 54, 108)),
          reference(expose(filmed, kReferenceSlices, 1'000'000, settings.pick(512, 2048, 4096))) {}
};

std::vector<Row> measure(uint32_t slices, const Setup& setup, const Settings& settings) {
    const int most_samples = settings.pick(32, 64, 256);
    std::vector<Row> rows;
    for (int count = 1; count <= most_samples; count *= 2) {
        // Pictures of many samples are dear, and scatter little.
        const int repeats = count <= 16 ? settings.pick(6, 7, 9) : settings.pick(6, 7, 3);
        std::vector<double> seconds, errors;
        for (int repeat = 0; repeat < repeats; ++repeat) {
            const auto begin = std::chrono::steady_clock::now();
            const std::vector<glm::dvec3> picture = expose(setup.filmed, slices, uint64_t(repeat), count);
            seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
            errors.push_back(rmse(picture, setup.reference));
        }
        Point point{.x = spread_of(seconds), .y = spread_of(errors), .label = std::to_string(count)};
        point.is_default = slices == Shutter{}.slices;
        rows.push_back({.panel = kByTime, .series = name_of(slices), .point = point});
        point.x = Spread::exactly(count);
        rows.push_back({.panel = kBySamples, .series = name_of(slices), .point = point});
    }
    return rows;
}

std::string caption(const Chart& chart) {
    const auto last = [&](uint32_t slices) { return chart.panel(kBySamples).find(name_of(slices))->points.back(); };
    const auto left = [&](uint32_t slices) { return short_number(last(slices).y.median); };
    const uint32_t ours = Shutter{}.slices;
    return fmt::format(
        "Tori on circles, over {} s, against {} slices of many samples; light that bounces is left out. After {} samples a "
        "pixel, "
        "1 slice is {} off, 4 are {}, {} (default) {}, and 64 {}: fewer slices show what moves several times, more cost "
        "trees.",
        kOpen, kReferenceSlices, last(ours).label, left(1), left(4), ours, left(ours), left(64));
}

}  // namespace

Chart shutter(Sweep& sweep) {
    Chart chart{.name = "shutter", .question = find_chart("shutter").question, .columns = 2};
    const Axis error{.name = "RMSE", .unit = "radiance", .is_log = true};
    chart.panels = {{.name = kByTime, .x = {.name = "time", .unit = "s", .is_log = true}, .y = error, .is_trade = true},
                    {.name = kBySamples, .x = {.name = "samples a pixel", .unit = "", .is_log = true}, .y = error}};
    const Settings settings = sweep.settings();
    const Shared<Setup> setup(settings);
    std::vector<Step> steps;
    for (const uint32_t slices : kSlices) {
        steps.push_back({.name = name_of(slices),
                         .share = steps.empty() ? 3.0 : 1.0,  // The first makes the reference.
                         .measure = [=] { return measure(slices, setup(), settings); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
