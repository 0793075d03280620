// Samples where they are needed: the noise that was asked for, for less, and no light lost.

#include "engine/render/noise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/math/parallel.h"
#include "tests/render/scenes.h"
#include "tests/support/allocation_count.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

constexpr int kWidth = 40, kHeight = 24;
constexpr float kLeast = 0.1f;

/// A scene that stands still, from one side.
struct Still {
    std::string name;
    Scene scene;
    View view;
    RenderConfig config;

    Take take() {
        return {.scene = scene,
                .advance = [this](double time_s, FrameStats* stats) -> const Tlas& { return advance(scene, time_s, stats); },
                .view = [this] { return view; }};
    }
};

const View kView = look_at({0, 1.5f, 5}, {0, 0, 0}, 45.0f, float(kWidth) / kHeight);

/// Soft light on round things: noisy everywhere but in the sky.
Still in_the_open() {
    Still still{.name = "open", .view = kView};
    add_node(still.scene, make_floor(3.0f, -1.0f, add_diffuse(still.scene, {0.7f, 0.6f, 0.5f})));
    add_node(still.scene, make_sphere(2, add_diffuse(still.scene, {0.2f, 0.8f, 0.4f}), true));
    return still;
}

/// A small lamp over a floor that stands on end: bright, dark, and half shadows.
Still by_a_lamp() {
    Still still{.name = "lamp", .view = kView};
    Material lamp = make_diffuse();
    lamp.base_color = {0, 0, 0, 1};
    lamp.emission = glm::vec3(30.0f);
    lamp.is_double_sided = true;
    add_node(still.scene, make_floor(4.0f, -1.0f, add_diffuse(still.scene, glm::vec3(0.8f))));
    add_node(still.scene, make_floor(0.3f, 2.0f, still.scene.add(lamp)));
    add_node(still.scene, make_box(add_diffuse(still.scene, {0.9f, 0.4f, 0.2f})), {.scale = glm::vec3(0.7f)});
    still.config = dark();
    still.config.is_jittered = true;
    return still;
}

/// A sheet that hides a black floor with so small a chance that most pixels' first samples do not see it at all. Exactly
/// this share of it is white.
Still behind_a_thin_sheet(float opacity) {
    Still still{.name = "sheet", .view = look_at({0, 10, 0}, {0, 0, 0}, 90.0f, float(kWidth) / kHeight)};
    Material white = make_diffuse();
    white.is_unlit = true;
    white.base_color = {1, 1, 1, opacity};
    white.alpha_mode = AlphaMode::kBlend;
    add_node(still.scene, make_floor(100.0f, 0.0f, still.scene.add(white)));
    still.config = dark();
    return still;
}

/// Half of it plain to see, half behind such a sheet.
Still half_plain() {
    Still still = behind_a_thin_sheet(0.3f);
    still.name = "half plain";
    still.scene[NodeId{0}].local.translation.x = 100.0f;
    Material plain = make_diffuse();
    plain.is_unlit = true;
    plain.base_color = {0.5f, 0.5f, 0.5f, 1};
    add_node(still.scene, make_floor(100.0f, 0.0f, still.scene.add(plain)), {.translation = {-100.0f, 0, 0}});
    return still;
}

Film expose(Still& still, const NoiseConfig& noise, int most_samples, int width = kWidth, int height = kHeight) {
    Film film(width, height);
    FrameStats stats;
    NoiseLimit limit;
    const Take take = still.take();
    Exposure exposure(take, {}, still.config, &film, &stats);
    EXPECT_TRUE(limit.expose(noise, most_samples, &exposure, {}, {}));
    return film;
}

double luminance(const glm::dvec3& c) {
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

std::vector<double> luminances(const Film& film) {
    std::vector<double> pixels;
    for (size_t k = 0; k < film.sum.size(); ++k) pixels.push_back(luminance(glm::dvec3(film.sum[k])) / film.samples_of(k));
    return pixels;
}

/// Of samples that no tested picture has.
std::vector<double> reference(Still& still, int sample_count) {
    Film film(kWidth, kHeight);
    film.sample_count = 1 << 20;
    RenderConfig config = still.config;
    render(still.scene, advance(still.scene, 0.0), still.view, config, sample_count, &film, nullptr);
    std::vector<double> pixels;
    for (const glm::vec4& sum : film.sum) pixels.push_back(luminance(glm::dvec3(sum)) / sample_count);
    return pixels;
}

/// Relative, in the root mean square over the pixels that `counts`.
template <typename Counts>
double error_of(const Film& film, const std::vector<double>& truth, Counts&& counts) {
    const std::vector<double> pixels = luminances(film);
    double squares = 0.0;
    int count = 0;
    for (size_t k = 0; k < pixels.size(); ++k) {
        if (!counts(k)) continue;
        const double error = (pixels[k] - truth[k]) / std::max(truth[k], double(kLeast));
        squares += error * error;
        ++count;
    }
    return std::sqrt(squares / std::max(count, 1));
}

double error_of(const Film& film, const std::vector<double>& truth) {
    return error_of(film, truth, [](size_t) { return true; });
}

TEST(Noise, IsWhatWasAskedForWherePixelsHaveEnough) {
    constexpr int kMost = 1024;
    Still stills[] = {in_the_open(), by_a_lamp(), half_plain()};
    for (Still& still : stills) {
        const std::vector<double> truth = reference(still, 4096);
        for (const float target : {0.1f, 0.04f}) {
            SCOPED_TRACE(still.name + ", " + std::to_string(target));
            const Film film = expose(still, {.target = target}, kMost);
            const auto had_enough = [&](size_t k) { return film.samples_of(k) < kMost; };
            const auto was_hard = [&](size_t k) { return film.samples_of(k) > 16 && had_enough(k); };
            const double error = error_of(film, truth, had_enough), hard_error = error_of(film, truth, was_hard);
            std::printf("%-10s %.2f: %.4f, of hard ones %.4f, by %.1f samples\n", still.name.c_str(), target, error,
                        hard_error, mean_samples(film));
            EXPECT_LT(error, 1.25 * target);
            EXPECT_LT(hard_error, 1.25 * target);
            if (mean_samples(film) < 17.0) continue;  // The least that there is was enough nearly everywhere.
            EXPECT_GT(hard_error, 0.3 * target) << "more samples than were needed";
        }
    }
}

TEST(Noise, CostsFewerSamplesThanTheSameErrorDoesWhereAllPixelsGetTheSame) {
    Still still = half_plain();
    const std::vector<double> truth = reference(still, 4096);
    const Film film = expose(still, {.target = 0.05f}, 4096);
    const double error = error_of(film, truth), mean = mean_samples(film);
    const Film uniform = expose(still, {.target = 0.0f}, static_cast<int>(mean));
    EXPECT_LT(error, 0.85 * error_of(uniform, truth)) << "of " << mean << " samples";
}

/// Where most of a pixel's light comes with few of its samples, those that stop when they seem done have too little of it.
TEST(Noise, NoLightIsLostByWhoStops) {
    for (const float opacity : {0.02f, 0.3f}) {
        Still still = behind_a_thin_sheet(opacity);
        for (const float target : {0.5f, 0.2f}) {
            const NoiseConfig noise{.target = target, .least_samples = 4, .least_luminance = 0.01f};
            const Film film = expose(still, noise, 4096, 320, 240);
            double sum = 0.0, variance = 0.0;
            std::vector<double> pixels = luminances(film);
            for (size_t k = 0; k < pixels.size(); ++k) {
                sum += pixels[k];
                variance += (pixels[k] - opacity) * (pixels[k] - opacity);
            }
            const double count = static_cast<double>(pixels.size()), mean = sum / count,
                         deviation = std::sqrt(variance) / count;
            std::printf("opacity %.2f, %.2f: mean %.5f +- %.5f, of %.1f samples\n", opacity, target, mean, deviation,
                        mean_samples(film));
            EXPECT_NEAR(mean, opacity, 4.0 * deviation);
            EXPECT_LT(deviation, 0.02 * opacity);
        }
    }
}

TEST(Noise, WithoutALimitAllPixelsGetAllSamplesBitForBit) {
    Still still = in_the_open();
    const Film film = expose(still, {.target = 0.0f}, 13);
    Film plain(kWidth, kHeight);
    render(still.scene, advance(still.scene, 0.0), still.view, still.config, 13, &plain, nullptr);
    EXPECT_TRUE(has_same_bits(film.sum, plain.sum));
    EXPECT_TRUE(film.enough.empty());
    EXPECT_EQ(mean_samples(film), 13.0);
}

TEST(Noise, EachPixelHasAtLeastTheLeastAndAtMostTheMost) {
    Still still = in_the_open();
    for (const int most : {1, 3, 16, 50, 100}) {
        const Film film = expose(still, {.target = 0.02f}, most);
        for (size_t k = 0; k < film.sum.size(); ++k) {
            EXPECT_LE(film.samples_of(k), static_cast<uint32_t>(most));
            EXPECT_GE(film.samples_of(k), static_cast<uint32_t>(std::min(most, 16)));
        }
    }
    // Whatever it is, it is clean: no more than the least.
    Still plain = behind_a_thin_sheet(1.0f);
    EXPECT_EQ(mean_samples(expose(plain, {.target = 0.001f}, 1000)), 16.0);
}

TEST(Noise, SamplesAndPicturesAreTheSameOnAnyNumberOfThreads) {
    Still still = by_a_lamp();
    set_thread_count(1);
    const Film one = expose(still, {.target = 0.05f}, 256);
    set_thread_count(3);
    const Film three = expose(still, {.target = 0.05f}, 256);
    set_thread_count(0);
    EXPECT_TRUE(has_same_bits(one.sum, three.sum));
    EXPECT_EQ(one.enough, three.enough);
    EXPECT_EQ(one.sample_count, three.sample_count);
}

/// The samples that a pixel gets are those that it would get where all had as many.
TEST(Noise, PixelsHaveTheirFirstSamples) {
    Still still = in_the_open();
    const Film film = expose(still, {.target = 0.05f}, 64);
    const Tlas& tlas = advance(still.scene, 0.0);
    Film plain(kWidth, kHeight);
    for (int count = 1; count <= 64; ++count) {
        render(still.scene, tlas, still.view, still.config, 1, &plain, nullptr);
        for (size_t k = 0; k < film.sum.size(); ++k) {
            if (film.samples_of(k) != static_cast<uint32_t>(count)) continue;
            ASSERT_EQ(film.sum[k], plain.sum[k]);
        }
    }
}

TEST(Noise, TimeEndsItAndNoPixelIsLeftBehind) {
    Still still = in_the_open();
    Film film(kWidth, kHeight);
    FrameStats stats;
    NoiseLimit limit;
    const Take take = still.take();
    for (const double open_s : {0.0, 0.1}) {
        Exposure exposure(take, {.open_s = open_s, .slices = 8}, still.config, &film, &stats);
        int passes = 0;
        EXPECT_TRUE(limit.expose({.target = 0.0f}, 1000, &exposure, [&] { return ++passes < 3; }, {}));
        EXPECT_EQ(film.sample_count, 12);
        EXPECT_TRUE(film.enough.empty());
    }
    std::atomic<bool> cancel = true;
    still.config.cancel = &cancel;
    Exposure exposure(take, {}, still.config, &film, &stats);
    EXPECT_FALSE(limit.expose({}, 100, &exposure, {}, {}));
}

TEST(Noise, AFrameLikeTheLastAllocatesNothing) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    Still still = by_a_lamp();
    Film film(kWidth, kHeight);
    NoiseLimit limit;
    const Take take = still.take();
    size_t count = 0;
    for (int round = 0; round < 3; ++round) {
        FrameStats stats;
        const size_t before = allocation_count();
        Exposure exposure(take, {}, still.config, &film, &stats);
        ASSERT_TRUE(limit.expose({.target = 0.1f}, 64, &exposure, {}, {}));
        count = allocation_count() - before;
    }
    EXPECT_EQ(count, 0u);
    set_thread_count(0);
}

TEST(Noise, PicturesOfOnePixelAndOneRowEnd) {
    Still still = in_the_open();
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 20), std::pair(17, 1)}) {
        Film film(width, height);
        FrameStats stats;
        NoiseLimit limit;
        const Take take = still.take();
        Exposure exposure(take, {}, still.config, &film, &stats);
        EXPECT_TRUE(limit.expose({.target = 0.3f}, 128, &exposure, {}, {}));
        EXPECT_GE(mean_samples(film), 16.0);
    }
}

}  // namespace
}  // namespace zoe::test
