#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/noise.h"

namespace zoe::chart {
namespace {

constexpr const char* kRmse = "RMSE of a frame of the default scene";
constexpr const char* kRelative = "Relative error: mean of squares over squared brightness";
/// Of light that bounces more often next to nothing is left.
constexpr int kReferenceBounces = 16;

struct Method {
    const char* series;
    int bounce_count;
    bool is_spread = true;  ///< Samples one after the other, which the sampler spreads evenly; else any of them.
};
constexpr Method kMethods[] = {{"no bounce", 0}, {"1 bounce", 1},  {"2 bounces", 2},
                               {"4 bounces", 4}, {"8 bounces", 8}, {"4 bounces, random", 4, false}};

struct Setup {
    DefaultPicture picture;
    std::vector<glm::dvec3> reference;

    explicit Setup(const Settings& settings)
        : picture(settings.pick(40, 96, 160), settings.pick(24, 54, 90)),
          reference(render_reference(rendering({.series = "", .bounce_count = kReferenceBounces}), picture.width,
                                     picture.height, settings.pick(1024, 2048, 4096))) {}

    Rendering rendering(const Method& method) const {
        RenderConfig config;
        const bool is_default = method.is_spread && method.bounce_count == config.max_bounces;
        config.max_bounces = method.bounce_count;
        return {method.series, picture.with(config), method.is_spread, is_default};
    }
};

std::vector<Row> measure(const Method& method, const Setup& setup, const Settings& settings) {
    return measure_noise({setup.rendering(method)}, setup.picture.width, setup.picture.height, settings.pick(16, 64, 256),
                         setup.reference, kRmse, kRelative);
}

std::string caption(const Chart& chart) {
    const auto series = [&](const char* name) -> const Series& { return *chart.panel(kRmse).find(name); };
    const auto left = [&](const char* name) { return short_number(series(name).points.back().y.median); };
    const Series &ours = series("4 bounces"), &random = series("4 bounces, random");
    return fmt::format(
        "Points: 1, 2, 4, ... {} samples a pixel, against a picture of many others with {} bounces. The noise of the "
        "default "
        "goes with the power {:.2f} of the samples, of random samples with {:.2f}: after {} it is {} of theirs. Light that "
        "is "
        "not followed stays missing: the error after the most samples is {} without a bounce, {} with one, {} with two, {} "
        "with "
        "four (default) and {} with eight.",
        ours.points.back().label, kReferenceBounces, power_of_doubling(ours.points), power_of_doubling(random.points),
        ours.points.back().label, short_number(ours.points.back().y.median / random.points.back().y.median),
        left("no bounce"), left("1 bounce"), left("2 bounces"), left("4 bounces"), left("8 bounces"));
}

}  // namespace

Chart picture(Sweep& sweep) {
    Chart chart{.name = "picture", .question = find_chart("picture").question, .columns = 2};
    const Axis time{.name = "time", .unit = "s", .is_log = true};
    chart.panels = {{.name = kRmse, .x = time, .y = {.name = "RMSE", .unit = "radiance", .is_log = true}, .is_trade = true},
                    {.name = kRelative, .x = time, .y = {.name = "relMSE", .unit = "", .is_log = true}, .is_trade = true}};
    const Settings settings = sweep.settings();
    const Shared<Setup> setup(settings);
    std::vector<Step> steps;
    for (const Method& method : kMethods) {
        steps.push_back({.name = method.series,
                         .share = steps.empty() ? 6.0 : 1.0,  // The first makes the reference.
                         .measure = [=] { return measure(method, setup(), settings); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
