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

std::vector<Row> measure(const Settings& settings) {
    const DefaultPicture picture(settings.pick(40, 96, 320), settings.pick(24, 54, 180));
    std::vector<Rendering> renderings;
    for (const Method& method : kMethods) {
        RenderConfig config;
        const bool is_default = config.search == method.search;
        config.search = method.search;
        renderings.push_back({.series = method.series, .render = picture.with(config), .is_default = is_default});
    }
    const std::vector<glm::dvec3> reference = render_reference({.series = "", .render = picture.with({})}, picture.width,
                                                               picture.height, settings.pick(1024, 1024, 16'384));
    return measure_noise(renderings, picture.width, picture.height, settings.pick(16, 64, 1024), reference, kRmse, "");
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
    sweep.run({{.name = "search", .measure = [=] { return measure(settings); }}}, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
