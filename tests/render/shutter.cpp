// Pictures of what moves while the shutter is open, against means of sharp ones.

#include "engine/render/shutter.h"

#include <cmath>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/math/parallel.h"
#include "tests/render/scenes.h"
#include "tests/support/allocation_count.h"
#include "tests/support/same_bits.h"

namespace zoe::test {
namespace {

constexpr int kWidth = 36, kHeight = 24;
constexpr double kOpens = 0.4, kOpen = 0.2;
constexpr int kSharpFrames = 64;

/// A scene, how it is made at a time, and where it is then seen from.
struct Moving {
    std::string name;
    Content content;
    std::function<View(const Scene&, double time_s)> view;
    RenderConfig config;

    Take take() {
        return {.scene = content.scene,
                .advance = [this](double time_s, FrameStats* stats) -> const Tlas& {
                    time = time_s;
                    if (content.write) content.write(content.scene, time_s);
                    return advance(content.scene, time_s, stats);
                },
                .view = [this] { return view(content.scene, time); }};
    }
    double time = 0.0;
};

View own_camera(const Scene& scene, double) {
    for (uint32_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].name == "view") return view_from_camera(scene, NodeId{i}, float(kWidth) / kHeight);
    }
    throw std::logic_error("no camera");
}

Moving from_list(const char* name) {
    Moving moving{.name = name, .content = make_content(name), .view = own_camera};
    moving.config.shade = Shade::kNormal;
    return moving;
}

/// One of each: what turns, deforms, changes its topology, a camera that moves, and a lamp that does.
std::vector<Moving> all_motions() {
    std::vector<Moving> all;
    for (const char* const name : {"rigid-10", "deforming-20", "skinned-4", "topology-10"}) all.push_back(from_list(name));
    Moving camera{.name = "camera"};
    add_node(camera.content.scene, make_box(add_diffuse(camera.content.scene, {0.2f, 0.5f, 0.9f})));
    camera.view = [](const Scene&, double time_s) {
        return look_at({5 * std::sin(4 * time_s), 3, 5 * std::cos(4 * time_s)}, {0, 0, 0}, 40.0f, float(kWidth) / kHeight);
    };
    camera.config.shade = Shade::kNormal;
    all.push_back(std::move(camera));

    Moving lamp{.name = "lamp"};
    add_node(lamp.content.scene, make_floor(3.0f, 0.0f, add_diffuse(lamp.content.scene, glm::vec3(0.8f))));
    const NodeId light = add_light(lamp.content.scene, {.intensity = 5.0f}, {});
    lamp.content.write = [light](Scene& scene, double time_s) {
        scene[light].local.translation = {6.0 * (time_s - kOpens) - 1.0, 0.5, 0.0};
    };
    lamp.view = [](const Scene&, double) { return look_at({0, 4, 3}, {0, 0, 0}, 40.0f, float(kWidth) / kHeight); };
    lamp.config = dark();
    lamp.config.is_jittered = true;
    lamp.config.max_bounces = 0;
    all.push_back(std::move(lamp));
    return all;
}

Film expose(Moving& moving, const Shutter& shutter, int sample_count) {
    Film film(kWidth, kHeight);
    FrameStats stats;
    const Take take = moving.take();
    Exposure exposure(take, shutter, moving.config, &film, &stats);
    EXPECT_TRUE(exposure.add(sample_count));
    return film;
}

std::vector<glm::dvec3> mean_of(const Film& film) {
    std::vector<glm::dvec3> pixels;
    for (const glm::vec4& sum : film.sum) pixels.push_back(glm::dvec3(sum) / double(film.sample_count));
    return pixels;
}

/// Sharp pictures, at evenly spaced times.
std::vector<glm::dvec3> mean_of_sharp_frames(Moving& moving) {
    std::vector<glm::dvec3> mean(size_t{kWidth} * kHeight, glm::dvec3(0.0));
    for (int frame = 0; frame < kSharpFrames; ++frame) {
        const Shutter shutter{.opens_s = kOpens + kOpen * (frame + 0.5) / kSharpFrames};
        const std::vector<glm::dvec3> sharp = mean_of(expose(moving, shutter, 16));
        for (size_t k = 0; k < mean.size(); ++k) mean[k] += sharp[k] / double(kSharpFrames);
    }
    return mean;
}

double rmse(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
    double squares = 0.0;
    for (size_t k = 0; k < a.size(); ++k) squares += glm::dot(a[k] - b[k], a[k] - b[k]) / 3.0;
    return std::sqrt(squares / static_cast<double>(a.size()));
}

TEST(Shutter, PicturesNearTheMeanOfSharpOnesAsSlicesAndSamplesGrow) {
    for (Moving& moving : all_motions()) {
        SCOPED_TRACE(moving.name);
        const std::vector<glm::dvec3> reference = mean_of_sharp_frames(moving);
        const auto error = [&](uint32_t slices, int sample_count) {
            const Shutter shutter{.opens_s = kOpens, .open_s = kOpen, .slices = slices, .seed = 3};
            return rmse(mean_of(expose(moving, shutter, sample_count)), reference);
        };
        const double sharp = rmse(mean_of(expose(moving, {.opens_s = kOpens}, 128)), reference);
        const double few = error(2, 128), some = error(8, 128), many = error(64, 128);
        EXPECT_LT(many, 0.25 * sharp) << "of " << sharp;
        EXPECT_LT(some, few);
        EXPECT_LT(many, some);
        EXPECT_LT(error(64, 16), 0.7 * error(64, 2));
        std::printf("%-14s sharp %.4f, 2 slices %.4f, 8 %.4f, 64 %.4f\n", moving.name.c_str(), sharp, few, some, many);
    }
}

/// Fewer samples than slices are dealt over all of them: no pixel's are of one time, and none of the times is left out.
TEST(Shutter, FewSamplesAreNoiseAndNoGhosts) {
    Moving moving = from_list("rigid-10");
    const std::vector<glm::dvec3> reference = mean_of_sharp_frames(moving);
    const auto mean_error = [&](uint32_t slices) {
        glm::dvec3 most(0.0);
        std::vector<glm::dvec3> mean(reference.size(), glm::dvec3(0.0));
        constexpr int kSeeds = 32;
        Film film(kWidth, kHeight);
        for (int seed = 0; seed < kSeeds; ++seed) {
            // Other times, and by their first sample's number others of the pixels' orders.
            const Shutter shutter{.opens_s = kOpens, .open_s = kOpen, .slices = slices, .seed = uint64_t(seed)};
            FrameStats stats;
            const Take take = moving.take();
            Exposure exposure(take, shutter, moving.config, &film, &stats);
            film.sample_count = seed * 64;
            EXPECT_TRUE(exposure.add(2));
            for (size_t k = 0; k < mean.size(); ++k) mean[k] += glm::dvec3(film.sum[k]) / (2.0 * kSeeds);
        }
        return rmse(mean, reference);
    };
    Film one = expose(moving, {.opens_s = kOpens, .open_s = kOpen, .slices = 64}, 2);
    EXPECT_LT(mean_error(64), 0.5 * rmse(mean_of(one), reference));
}

TEST(Shutter, OpenForAMomentItIsTheSharpPictureBitForBit) {
    for (Moving& moving : all_motions()) {
        SCOPED_TRACE(moving.name);
        const Film film = expose(moving, {.opens_s = kOpens, .slices = 8}, 6);
        const Take take = moving.take();
        const Tlas& tlas = take.advance(kOpens, nullptr);
        Film sharp(kWidth, kHeight);
        render(moving.content.scene, tlas, take.view(), moving.config, 6, &sharp, nullptr);
        EXPECT_EQ(film.sample_count, 6);
        EXPECT_TRUE(film.sum == sharp.sum);
        EXPECT_TRUE(film.depth == sharp.depth);
        EXPECT_TRUE(film.node == sharp.node);
    }
}

TEST(Shutter, LayersAreOfWhenItOpens) {
    for (Moving& moving : all_motions()) {
        SCOPED_TRACE(moving.name);
        const Film blurred = expose(moving, {.opens_s = kOpens, .open_s = kOpen, .slices = 4}, 4);
        const Film sharp = expose(moving, {.opens_s = kOpens}, 1);
        EXPECT_TRUE(blurred.depth == sharp.depth);
        EXPECT_TRUE(blurred.node == sharp.node);
        EXPECT_TRUE(blurred.primitive == sharp.primitive);
        EXPECT_FALSE(blurred.sum == sharp.sum);
    }
}

TEST(Shutter, TimesLieOneInEachPart) {
    for (const uint32_t slices : {1u, 4u, 256u}) {
        for (uint64_t seed = 0; seed < 50; ++seed) {
            const Shutter shutter{.opens_s = -2.0, .open_s = 0.5, .slices = slices, .seed = seed};
            for (uint32_t slice = 0; slice < slices; ++slice) {
                const double time = slice_time(shutter, slice);
                EXPECT_GE(time, -2.0 + 0.5 * slice / slices);
                EXPECT_LT(time, -2.0 + 0.5 * (slice + 1) / slices);
            }
        }
    }
}

TEST(Shutter, ThreadsAndEarlierFramesDoNotMatter) {
    for (Moving& moving : all_motions()) {
        SCOPED_TRACE(moving.name);
        const Shutter shutter{.opens_s = kOpens, .open_s = kOpen, .slices = 8, .seed = 5};
        set_thread_count(1);
        const Film one = expose(moving, shutter, 12);
        expose(moving, {.opens_s = 0.9, .open_s = 0.1, .slices = 2}, 2);
        set_thread_count(3);
        const Film three = expose(moving, shutter, 12);
        set_thread_count(0);
        EXPECT_EQ(one.sample_count, 12);
        EXPECT_TRUE(has_same_bits(one.sum, three.sum));
        EXPECT_TRUE(has_same_bits(one.depth, three.depth));
    }
}

TEST(Shutter, CancelledItSaysSo) {
    Moving moving = from_list("rigid-10");
    std::atomic<bool> cancel = true;
    moving.config.cancel = &cancel;
    Film film(kWidth, kHeight);
    FrameStats stats;
    const Take take = moving.take();
    Exposure exposure(take, {.opens_s = kOpens, .open_s = kOpen, .slices = 4}, moving.config, &film, &stats);
    EXPECT_FALSE(exposure.add(4));
}

TEST(Shutter, AFrameLikeTheLastAllocatesNothing) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    for (const char* const name : {"rigid-10", "deforming-20", "skinned-4"}) {
        Moving moving = from_list(name);
        Film film(kWidth, kHeight);
        const Take take = moving.take();
        size_t count = 0;
        for (int round = 0; round < 3; ++round) {
            FrameStats stats;
            const size_t before = allocation_count();
            Exposure exposure(take, {.opens_s = kOpens, .open_s = kOpen, .slices = 4}, moving.config, &film, &stats);
            ASSERT_TRUE(exposure.add(4));
            count = allocation_count() - before;
        }
        EXPECT_EQ(count, 0u) << name;
    }
    set_thread_count(0);
}

}  // namespace
}  // namespace zoe::test
