#include "apps/chart/noise.h"

#include <chrono>
#include <cmath>

#include <glm/geometric.hpp>

#include "apps/chart/measure.h"
#include "apps/common/choose_view.h"
#include "engine/math/rng.h"

namespace zoe::chart {
namespace {

constexpr int kRepeats = 4;
/// Random samples are those from here on.
constexpr uint32_t kRandomBegin = 1 << 22;

std::vector<glm::dvec3> mean_of(const Film& film, int sample_count) {
    std::vector<glm::dvec3> pixels(film.sum.size());
    for (size_t k = 0; k < pixels.size(); ++k) pixels[k] = glm::dvec3(film.sum[k]) / double(sample_count);
    return pixels;
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
Progress render_and_compare(const Rendering& rendering, int width, int height, int most_samples, int repeat,
                            const std::vector<glm::dvec3>& reference) {
    Film film(width, height);
    film.sample_count = repeat * most_samples;
    Rng rng(static_cast<uint64_t>(repeat));
    Progress progress;
    double time = 0.0;
    for (int done = 0, count = 1; count <= most_samples; count *= 2) {
        stop_if_interrupted();
        const auto begin = std::chrono::steady_clock::now();
        if (rendering.is_spread) {
            rendering.render(count - done, &film);
        } else {
            for (int sample = done; sample < count; ++sample) {
                film.sample_count = static_cast<int>(kRandomBegin + rng.below(1u << 30));
                rendering.render(1, &film);
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

}  // namespace

DefaultPicture::DefaultPicture(int width, int height)
    : width(width),
      height(height),
      view(ViewChoice{.camera = camera_nodes(content.scene).front()}.view(content.scene, float(width) / float(height))) {}

std::function<void(int, Film*)> DefaultPicture::with(const RenderConfig& config) const {
    return [this, config](int sample_count, Film* film) {
        render(content.scene, tlas, view, config, sample_count, film, nullptr);
    };
}

std::vector<glm::dvec3> render_reference(const Rendering& rendering, int width, int height, int sample_count) {
    Film film(width, height);
    film.sample_count = kReferenceBegin;
    for (int done = 0; done < sample_count; done += 16) {
        stop_if_interrupted();
        rendering.render(16, &film);
    }
    return mean_of(film, sample_count);
}

std::vector<Row> measure_noise(const std::vector<Rendering>& renderings, int width, int height, int most_samples,
                               const std::vector<glm::dvec3>& reference, const std::string& rmse_panel,
                               const std::string& relative_panel) {
    std::vector<Row> rows;
    for (const Rendering& rendering : renderings) {
        std::vector<Progress> repeats;
        for (int repeat = 0; repeat < kRepeats; ++repeat)
            repeats.push_back(render_and_compare(rendering, width, height, most_samples, repeat, reference));
        for (size_t k = 0; k < repeats[0].seconds.size(); ++k) {
            const auto spread = [&](std::vector<double> Progress::*numbers) {
                std::vector<double> of_all;
                for (const Progress& progress : repeats) of_all.push_back((progress.*numbers)[k]);
                return spread_of(of_all);
            };
            Point point{.x = spread(&Progress::seconds), .y = spread(&Progress::rmse), .label = std::to_string(1 << k)};
            point.is_default = rendering.is_default;
            rows.push_back({.panel = rmse_panel, .series = rendering.series, .point = point});
            if (relative_panel.empty()) continue;
            point.y = spread(&Progress::relative);
            rows.push_back({.panel = relative_panel, .series = rendering.series, .point = point});
        }
    }
    return rows;
}

}  // namespace zoe::chart
