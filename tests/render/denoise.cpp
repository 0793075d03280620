#include "engine/render/denoise.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "apps/common/screen_error.h"
#include "content/content.h"
#include "engine/math/parallel.h"
#include "engine/math/rng.h"
#include "engine/render/past_frame.h"
#include "tests/render/scenes.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

size_t pixel_at(const Guides& guides, int x, int y) {
    return static_cast<size_t>(y) * static_cast<size_t>(guides.width) + static_cast<size_t>(x);
}

/// A wall that faces the viewer two metres away, and has not moved.
Guides wall(int width, int height) {
    Guides guides;
    guides.start(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const size_t k = pixel_at(guides, x, y);
            guides.albedo[k] = glm::vec3(0.5f);
            guides.normal[k] = {0.0f, 0.0f, 1.0f};
            guides.depth[k] = guides.was_depth[k] = 2.0f;
            guides.node[k] = 0;
            guides.was_at[k] = {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
        }
    }
    return guides;
}

/// One sample a pixel.
Film film_of(const Guides& guides, const glm::vec3& radiance) {
    Film film(guides.width, guides.height);
    film.sample_count = 1;
    std::fill(film.sum.begin(), film.sum.end(), glm::vec4(radiance, 1.0f));
    return film;
}

/// Frames of the default scene, seen by a camera that swings or stands still, each with one sample a pixel.
class Frames {
public:
    Frames(const char* camera, int width, int height) : width_(width), height_(height) {
        for (uint32_t i = 0; i < content_.scene.nodes.size(); ++i) {
            if (content_.scene.nodes[i].name == camera) camera_ = NodeId{i};
        }
        guides.past = &past_;
    }
    void advance_to(double time_s) {
        if (tlas != nullptr) past_.keep(*tlas, view);
        tlas = &advance(content_.scene, time_s);
        view = view_from_camera(content_.scene, camera_, static_cast<float>(width_) / static_cast<float>(height_));
    }
    Film sample(int sample_count, uint32_t first_number, Guides* seen) const {
        RenderConfig config;
        config.is_jittered = false;
        config.max_bounces = 2;
        config.first_number = first_number;
        config.guides = seen;
        Film film(width_, height_);
        render(content_.scene, *tlas, view, config, sample_count, &film, nullptr);
        return film;
    }
    const Scene& scene() const { return content_.scene; }
    Scene& scene() { return content_.scene; }

    Guides guides;
    View view;
    const Tlas* tlas = nullptr;

private:
    int width_, height_;
    Content content_ = make_content("default");
    NodeId camera_ = kNone<NodeId>;
    PastFrame past_;
};

constexpr int kWidth = 128, kHeight = 72, kReferenceSamples = 48;
constexpr uint32_t kReferenceBegin = 1 << 20;

/// Seen from where it stands still, moving things are a small part of the picture.
TEST(Denoise, ErrorOfFramesInMotionFalls) {
    for (const auto& [camera, factor] : {std::pair("swing", 1.9), {"view", 2.9}}) {
        Frames frames(camera, kWidth, kHeight);
        Denoiser denoiser;
        for (int frame = 0; frame < 10; ++frame) {
            frames.advance_to((30 + frame) / 24.0);
            const Film raw = frames.sample(1, static_cast<uint32_t>(frame), &frames.guides);
            Film smooth = raw;
            denoiser.filter(frames.guides, {}, &smooth);
            if (frame != 6 && frame != 9) continue;
            const Film reference = frames.sample(kReferenceSamples, kReferenceBegin, nullptr);
            const double before = screen_error(raw, reference), after = screen_error(smooth, reference);
            std::printf("%s, frame %d: error %.4f of one sample, %.4f smoothed\n", camera, frame, before, after);
            EXPECT_LT(factor * after, before) << camera << ", frame " << frame;
        }
    }
}

TEST(Denoise, StillSceneConverges) {
    Frames frames("view", 96, 54);
    Denoiser denoiser;
    constexpr int kFrames = 32;
    frames.advance_to(1.0);
    const Film reference = frames.sample(128, kReferenceBegin, nullptr);
    double first = 0.0, last = 0.0;
    for (int frame = 0; frame < kFrames; ++frame) {
        frames.advance_to(1.0);
        Film film = frames.sample(1, static_cast<uint32_t>(frame), &frames.guides);
        denoiser.filter(frames.guides, {.most_frames = 1 << 16}, &film);
        last = screen_error(film, reference);
        if (frame == 0) first = last;
    }
    EXPECT_LT(last, 0.5 * first);
}

/// The points that a ray meets are followed back to where the triangle is found by going there, in double precision.
TEST(Denoise, PointsAreFollowedToWhereTheyWere) {
    constexpr int kPictureWidth = 96, kPictureHeight = 54;
    Frames frames("swing", kPictureWidth, kPictureHeight);
    frames.advance_to(30 / 24.0);
    const View view_then = frames.view;
    frames.advance_to(31 / 24.0);
    frames.sample(1, 0, &frames.guides);
    const Guides& guides = frames.guides;
    std::vector<Hit> hits;
    for (size_t k = 0; k < guides.node.size(); ++k) {
        hits.push_back(closest_hit(*frames.tlas,
                                   camera_ray(frames.view, static_cast<float>(k % kPictureWidth) + 0.5f,
                                              static_cast<float>(k / kPictureWidth) + 0.5f, kPictureWidth, kPictureHeight)));
    }
    const Tlas& then = advance(frames.scene(), 30 / 24.0);
    int compared = 0, unknown = 0;
    for (size_t k = 0; k < guides.node.size(); ++k) {
        const Hit& hit = hits[k];
        if (guides.node[k] != index(hit.node) || !hit) continue;
        if (!(guides.was_at[k].x == guides.was_at[k].x)) {
            ++unknown;  // Another mesh of a sequence.
            continue;
        }
        const Instance& instance = then[hit.node];
        const glm::uvec3& corners = instance.mesh->corners[hit.primitive];
        const glm::dvec3 a(instance.positions[corners.x]), b(instance.positions[corners.y]),
            c(instance.positions[corners.z]);
        const glm::dvec3 local = a + double(hit.u) * (b - a) + double(hit.v) * (c - a);
        const glm::dvec3 was = glm::dmat3(instance.world_from_local.linear) * local +
                               glm::dvec3(instance.world_from_local.translation) - glm::dvec3(view_then.origin);
        const double depth = -glm::dot(was, glm::dvec3(view_then.axis_z));
        const double right = glm::dot(was, glm::dvec3(view_then.axis_x)) / (depth * view_then.half_width),
                     up = glm::dot(was, glm::dvec3(view_then.axis_y)) / (depth * view_then.half_height);
        EXPECT_NEAR(guides.was_at[k].x, 0.5 * kPictureWidth * (1.0 + right), 1e-2);
        EXPECT_NEAR(guides.was_at[k].y, 0.5 * kPictureHeight * (1.0 - up), 1e-2);
        EXPECT_NEAR(guides.was_depth[k], depth, 1e-4 * depth);
        ++compared;
    }
    EXPECT_GT(compared, 4000);
    EXPECT_LT(unknown, 400);
}

TEST(Denoise, WhatIsTheSameEverywhereStaysTheSame) {
    Rng rng(7);
    Guides guides = wall(61, 37);
    for (glm::vec3& albedo : guides.albedo) albedo = {rng.uniform(), rng.uniform(), rng.uniform()};
    for (glm::vec3& normal : guides.normal) normal = glm::normalize(glm::vec3(rng.uniform(), rng.uniform(), 1.0f));
    for (uint32_t& node : guides.node) node = static_cast<uint32_t>(rng.below(3));
    for (float& depth : guides.depth) depth = 1.0f + rng.uniform();
    Denoiser denoiser;
    for (int frame = 0; frame < 4; ++frame) {
        // Light of one brightness on surfaces of every colour: 4 % is what each reflects at least.
        Film film = film_of(guides, glm::vec3(0.0f));
        for (size_t k = 0; k < film.sum.size(); ++k)
            film.sum[k] = glm::vec4(3.0f * (0.04f + 0.96f * guides.albedo[k]), 1.0f);
        const Film before = film;
        denoiser.filter(guides, {}, &film);
        for (size_t k = 0; k < film.sum.size(); ++k) {
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(film.sum[k][c], before.sum[k][c], 1e-5f * before.sum[k][c]);
        }
    }
}

/// On a wall without edges light is moved, not made: away from the border the sum stays.
TEST(Denoise, NoiseIsSpreadAndNotLost) {
    Guides guides = wall(96, 96);
    guides.past = nullptr;
    Rng rng(11);
    double sum = 0.0, count = 0.0, before = 0.0, squares = 0.0;
    for (int frame = 0; frame < 16; ++frame) {
        Film film = film_of(guides, glm::vec3(1.0f));
        for (glm::vec4& pixel : film.sum) pixel = glm::vec4(glm::vec3(rng.uniform() < 0.5f ? 0.0f : 2.0f), 1.0f);
        const Film raw = film;
        Denoiser denoiser;
        denoiser.filter(guides, {}, &film);
        for (size_t k = 0; k < film.sum.size(); ++k) {
            sum += film.sum[k].x;
            before += raw.sum[k].x;
            squares += (film.sum[k].x - 1.0) * (film.sum[k].x - 1.0);
            count += 1.0;
        }
    }
    EXPECT_NEAR(sum / before, 1.0, 0.01);
    EXPECT_LT(std::sqrt(squares / count), 0.3);  // of 1 before
}

/// Something bright passes a wall: where it was, nothing of it is left.
TEST(Denoise, NoGhostIsLeftWhereSomethingWas) {
    constexpr int kSide = 48, kStep = 5, kFrames = 8;
    Denoiser denoiser;
    for (int frame = 0; frame < kFrames; ++frame) {
        Guides guides = wall(kSide, kSide);
        Film film = film_of(guides, glm::vec3(0.52f));
        const int left = frame * kStep;
        for (int y = 16; y < 32; ++y) {
            for (int x = left; x < std::min(left + 12, kSide); ++x) {
                const size_t k = pixel_at(guides, x, y);
                guides.node[k] = 1;
                guides.depth[k] = guides.was_depth[k] = 1.5f;
                guides.was_at[k].x -= kStep;
                film.sum[k] = glm::vec4(glm::vec3(52.0f), 1.0f);
            }
        }
        denoiser.filter(guides, {}, &film);
        for (size_t k = 0; k < film.sum.size(); ++k) {
            const float expected = guides.node[k] == 0 ? 0.52f : 52.0f;
            ASSERT_NEAR(film.sum[k].x, expected, 0.01f * expected) << "frame " << frame << ", pixel " << k;
        }
    }
}

/// Light that changes everywhere is followed: what is left of it halves in a few frames.
TEST(Denoise, LightThatChangesIsFollowed) {
    const Guides guides = wall(32, 32);
    Denoiser denoiser;
    Film film;
    for (int frame = 0; frame < 24; ++frame) {
        film = film_of(guides, glm::vec3(frame < 16 ? 1.0f : 0.0f));
        denoiser.filter(guides, {}, &film);
    }
    EXPECT_LT(film.sum[500].x, 0.4f);
}

TEST(Denoise, SamplesThatAreNotFiniteCountAsNone) {
    Guides guides = wall(40, 40);
    guides.normal[pixel_at(guides, 30, 30)] = glm::vec3(kNan);
    guides.depth[pixel_at(guides, 5, 30)] = kNan;
    guides.was_at[pixel_at(guides, 6, 6)] = {kInfinity, -kInfinity};
    guides.was_depth[pixel_at(guides, 7, 7)] = kNan;
    guides.albedo[pixel_at(guides, 8, 20)] = glm::vec3(kNan);
    Denoiser denoiser;
    for (int frame = 0; frame < 6; ++frame) {
        Film film = film_of(guides, glm::vec3(0.52f));
        for (const auto& [x, value] : {std::pair(3, kNan), {13, kInfinity}, {23, -kInfinity}})
            film.sum[pixel_at(guides, x, 10 + frame)] = glm::vec4(glm::vec3(value), 1.0f);
        denoiser.filter(guides, {}, &film);
        for (size_t k = 0; k < film.sum.size(); ++k) {
            ASSERT_TRUE(std::isfinite(film.sum[k].x)) << k;
            // Beside those whose surface is unknown, all is as if nothing had been.
            if (k / 40 < 18) {
                ASSERT_NEAR(film.sum[k].x, 0.52f, 1e-4f) << k;
            }
        }
    }
}

TEST(Denoise, LightOfAnyBrightnessStaysFinite) {
    const Guides guides = wall(40, 40);
    Denoiser denoiser;
    for (int frame = 0; frame < 6; ++frame) {
        Film film = film_of(guides, glm::vec3(1e-37f));
        for (const auto& [x, value] : {std::pair(3, 3e38f), {20, 1e20f}, {33, -3e38f}})
            film.sum[pixel_at(guides, x, 10 + frame)] = glm::vec4(glm::vec3(value), 1.0f);
        denoiser.filter(guides, {}, &film);
        for (const glm::vec4& pixel : film.sum) ASSERT_TRUE(std::isfinite(pixel.x) && pixel.x >= 0.0f);
    }
}

TEST(Denoise, SkyAndEmissionPassAsTheyAre) {
    Guides guides = wall(40, 30);
    Rng rng(3);
    Film film = film_of(guides, glm::vec3(0.0f));
    for (size_t k = 0; k < guides.node.size(); ++k) {
        const glm::vec3 glow(rng.uniform(), rng.uniform(), 5.0f * rng.uniform());
        guides.unfiltered[k] = glow;
        film.sum[k] = glm::vec4(glow, 1.0f);
        if (k % 3 == 0) continue;
        guides.node[k] = 0xffffffffu;
        guides.depth[k] = kInfinity;
        guides.normal[k] = guides.albedo[k] = glm::vec3(0.0f);
    }
    const Film before = film;
    Denoiser denoiser;
    denoiser.filter(guides, {}, &film);
    EXPECT_EQ(std::memcmp(film.sum.data(), before.sum.data(), film.sum.size() * sizeof(glm::vec4)), 0);
}

/// After a cut, or in another size, nothing is left of the frames before.
TEST(Denoise, CutsAndNewSizesBeginAnew) {
    Rng rng(5);
    const auto noisy = [&](const Guides& guides) {
        Film film = film_of(guides, glm::vec3(0.0f));
        for (glm::vec4& pixel : film.sum) pixel = glm::vec4(glm::vec3(rng.uniform()), 1.0f);
        return film;
    };
    const Guides large = wall(50, 40), small = wall(25, 20);
    Denoiser used;
    Film film = noisy(large);
    used.filter(large, {}, &film);
    for (const Guides* guides : {&small, &large, &large}) {
        used.forget();
        Film here = noisy(*guides);
        Film there = here;
        used.filter(*guides, {}, &here);
        Denoiser fresh;
        fresh.filter(*guides, {}, &there);
        EXPECT_EQ(std::memcmp(here.sum.data(), there.sum.data(), here.sum.size() * sizeof(glm::vec4)), 0);
    }
    Film here = noisy(small);
    Film there = here;
    used.filter(small, {}, &here);  // not told of the size
    Denoiser fresh;
    fresh.filter(small, {}, &there);
    EXPECT_EQ(std::memcmp(here.sum.data(), there.sum.data(), here.sum.size() * sizeof(glm::vec4)), 0);
}

TEST(Denoise, PicturesOfAnyShapeAreFiltered) {
    for (const auto& [width, height] : {std::pair(1, 1), {2, 1}, {1, 7}, {3, 3}, {33, 2}}) {
        const Guides guides = wall(width, height);
        Denoiser denoiser;
        for (int frame = 0; frame < 3; ++frame) {
            Film film = film_of(guides, glm::vec3(0.7f));
            denoiser.filter(guides, {.rounds = 16}, &film);
            for (const glm::vec4& pixel : film.sum) EXPECT_NEAR(pixel.x, 0.7f, 1e-5f) << width << "x" << height;
        }
    }
}

/// The bits of some frames do not depend on threads; and once sizes have settled, they allocate nothing.
TEST(Denoise, ThreadsDoNotMatterAndNothingIsAllocated) {
    std::vector<glm::vec4> pictures[2];
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        Frames frames("swing", 96, 54);
        Denoiser denoiser;
        for (int frame = 0; frame < 5; ++frame) {
            frames.advance_to(frame / 24.0);
            Film film = frames.sample(1, static_cast<uint32_t>(frame), &frames.guides);
            const size_t before = allocation_count();
            denoiser.filter(frames.guides, {}, &film);
            if (threads == 1 && frame > 0) {
                EXPECT_EQ(allocation_count(), before);
            }
            pictures[threads - 1].insert(pictures[threads - 1].end(), film.sum.begin(), film.sum.end());
        }
    }
    set_thread_count(0);
    EXPECT_EQ(std::memcmp(pictures[0].data(), pictures[1].data(), pictures[0].size() * sizeof(glm::vec4)), 0);
}

}  // namespace
}  // namespace zoe::test
