#include <array>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/noise.h"

namespace zoe::chart {
namespace {

constexpr const char* kRmse = "RMSE of a frame of the default scene";

struct Method {
    const char* series;
    LightSearch search;
};
constexpr std::array kMethods = {Method{"both ways", LightSearch::kBoth},
                                 Method{"rays towards lights", LightSearch::kLights},
                                 Method{"bounces alone", LightSearch::kBounces}};

struct Setup {
    DefaultPicture picture;
    std::vector<glm::dvec3> reference;

    explicit Setup(const Settings& settings)
        : picture(settings.pick(40, 96, 160), settings.pick(24, 54, 90)),
          reference(render_reference({.series = "", .render = picture.with({})}, picture.width, picture.height,
                                     settings.pick(1024, 1024, 4096))) {}
};

std::vector<Row> measure(const Method& method, const Setup& setup, const Settings& settings) {
    RenderConfig config;
    const bool is_default = config.search == method.search;
    config.search = method.search;
    const DefaultPicture& picture = setup.picture;
    return measure_noise({{.series = method.series, .render = picture.with(config), .is_default = is_default}},
                         picture.width, picture.height, settings.pick(16, 64, 256), setup.reference, kRmse, "");
}

std::string caption(const Chart& chart) {
    const auto last = [&](const char* name) { return chart.panel(kRmse).find(name)->points.back(); };
    const Point both = last("both ways"), lights = last("rays towards lights"), bounces = last("bounces alone");
    return fmt::format(
        "Points: 1, 2, 4, ... {} samples a pixel, against a picture of many others. Lamps, suns and environments are found "
        "by "
        "rays towards them and by bounces that meet them, each weighed by its density (default). After the most samples "
        "that "
        "has {} of the error of rays towards lights alone in {} of their time, and {} of the error of bounces alone in {} "
        "of "
        "theirs. Punctual lights are found by rays towards them in all three.",
        both.label, short_number(both.y.median / lights.y.median), short_number(both.x.median / lights.x.median),
        short_number(both.y.median / bounces.y.median), short_number(both.x.median / bounces.x.median));
}

}  // namespace

Chart lights(Sweep& sweep) {
    Chart chart{.name = "lights", .question = find_chart("lights").question};
    chart.panels = {{.name = kRmse,
                     .x = {.name = "time", .unit = "s", .is_log = true},
                     .y = {.name = "RMSE", .unit = "radiance", .is_log = true},
                     .is_trade = true}};
    const Settings settings = sweep.settings();
    const Shared<Setup> setup(settings);
    std::vector<Step> steps;
    for (const Method& method : kMethods) {
        steps.push_back({.name = method.series,
                         .share = steps.empty() ? 5.0 : 1.0,  // The first makes the reference.
                         .measure = [=] { return measure(method, setup(), settings); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
