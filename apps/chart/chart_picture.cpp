#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/common/choose_view.h"
#include "apps/common/open_scene.h"
#include "engine/math/rng.h"
#include "engine/render/path.h"

namespace zoe::chart {
namespace {

constexpr const char* kRmse = "RMSE of a frame of the default scene";
constexpr const char* kRelative = "Relative error: mean of squares over squared brightness";
constexpr double kTime = 1.0;
/// Of light that bounces more often next to nothing is left.
constexpr int kReferenceBounces = 16;
/// Samples before this one are the tested pictures': the reference has others.
constexpr int kReferenceBegin = 1 << 20;
constexpr int kRepeats = 4;

struct Method {
    const char* series;
    int bounce_count;
    bool is_spread = true;  ///< Samples one after the other, which the sampler spreads evenly; else any of them.
};
constexpr Method kMethods[] = {{"no bounce", 0}, {"1 bounce", 1},  {"2 bounces", 2},
                               {"4 bounces", 4}, {"8 bounces", 8}, {"4 bounces, random", 4, false}};
/// The random ones have theirs from here on.
constexpr uint32_t kRandomBegin = 1 << 22;

struct Setup {
    Content content = open_scene("default", 24.0);
    const Tlas& tlas = advance(content, kTime, nullptr);
    int width, height;
    View view;

    explicit Setup(const Settings& settings)
        : width(settings.pick(40, 96, 320)),
          height(settings.pick(24, 54, 180)),
          view(ViewChoice{.camera = camera_nodes(content.scene).front()}.view(content.scene, float(width) / float(height))) {
    }

    /// Adds samples to a picture, from its own number of samples on.
    void render(int bounce_count, int sample_count, Film* film) const {
        RenderConfig config;
        config.max_bounces = bounce_count;
        zoe::render(content.scene, tlas, view, config, sample_count, film, nullptr);
    }
};

/// Linear radiance, [height * width].
std::vector<glm::dvec3> mean_of(const Film& film, int sample_count) {
    std::vector<glm::dvec3> pixels(film.sum.size());
    for (size_t k = 0; k < pixels.size(); ++k) pixels[k] = glm::dvec3(film.sum[k]) / double(sample_count);
    return pixels;
}

std::vector<glm::dvec3> render_reference(const Setup& setup, int sample_count) {
    Film film(setup.width, setup.height);
    film.sample_count = kReferenceBegin;
    for (int done = 0; done < sample_count; done += 16) {
        stop_if_interrupted();
        setup.render(kReferenceBounces, 16, &film);
    }
    return mean_of(film, sample_count);
}

struct Error {
    double rmse, relative;
};
Error compare(const std::vector<glm::dvec3>& picture, const std::vector<glm::dvec3>& reference) {
    double squares = 0.0, relative = 0.0;
    for (size_t k = 0; k < picture.size(); ++k) {
        const glm::dvec3 difference = picture[k] - reference[k];
        const double square = glm::dot(difference, difference) / 3.0,
                     brightness = (reference[k].x + reference[k].y + reference[k].z) / 3.0;
        squares += square;
        // The constant keeps black pixels from outweighing all others.
        relative += square / (brightness * brightness + 1e-2);
    }
    const auto count = static_cast<double>(picture.size());
    return {std::sqrt(squares / count), relative / count};
}

/// Of 1, 2, 4, ... samples.
struct Progress {
    std::vector<double> seconds, rmse, relative;
};
Progress render_and_compare(const Setup& setup, const Method& method, int most_samples, int repeat,
                            const std::vector<glm::dvec3>& reference) {
    Film film(setup.width, setup.height);
    film.sample_count = repeat * most_samples;
    Rng rng(static_cast<uint64_t>(repeat));
    Progress progress;
    double time = 0.0;
    for (int done = 0, count = 1; count <= most_samples; count *= 2) {
        stop_if_interrupted();
        const auto begin = std::chrono::steady_clock::now();
        if (method.is_spread) {
            setup.render(method.bounce_count, count - done, &film);
        } else {
            for (int sample = done; sample < count; ++sample) {
                film.sample_count = static_cast<int>(kRandomBegin + rng.below(1u << 30));
                setup.render(method.bounce_count, 1, &film);
            }
        }
        done = count;
        time += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        const Error error = compare(mean_of(film, count), reference);
        progress.seconds.push_back(time);
        progress.rmse.push_back(error.rmse);
        progress.relative.push_back(error.relative);
    }
    return progress;
}

std::vector<Row> measure(const Settings& settings) {
    const Setup setup(settings);
    const int most_samples = settings.pick(16, 64, 1024);
    const std::vector<glm::dvec3> reference = render_reference(setup, settings.pick(1024, 2048, 16'384));
    std::vector<Row> rows;
    for (const Method& method : kMethods) {
        std::vector<Progress> repeats;
        for (int repeat = 0; repeat < kRepeats; ++repeat)
            repeats.push_back(render_and_compare(setup, method, most_samples, repeat, reference));
        for (size_t k = 0; k < repeats[0].seconds.size(); ++k) {
            const auto spread = [&](std::vector<double> Progress::*numbers) {
                std::vector<double> of_all;
                for (const Progress& progress : repeats) of_all.push_back((progress.*numbers)[k]);
                return spread_of(of_all);
            };
            Point point{.x = spread(&Progress::seconds), .y = spread(&Progress::rmse), .label = std::to_string(1 << k)};
            point.is_default = method.is_spread && method.bounce_count == RenderConfig{}.max_bounces;
            rows.push_back({.panel = kRmse, .series = method.series, .point = point});
            point.y = spread(&Progress::relative);
            rows.push_back({.panel = kRelative, .series = method.series, .point = point});
        }
    }
    return rows;
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
    sweep.run({{.name = "bounces", .measure = [=] { return measure(settings); }}}, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
