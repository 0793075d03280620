#include "engine/render/upsample.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "apps/common/screen_error.h"
#include "engine/math/parallel.h"
#include "engine/math/rng.h"
#include "engine/render/denoise.h"
#include "tests/render/upsample_frames.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

/// What a point of the picture shows; (0, 0) is its top left, (1, 1) its bottom right.
struct Shape {
    uint32_t node = 0;
    float depth = 2.0f;
    glm::vec3 normal{0.0f, 0.0f, 1.0f};
};

Guides guides_of(const Size& size, const std::function<Shape(double, double)>& shape_at) {
    Guides guides;
    guides.start(size.width, size.height);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const size_t k = size_t{1} * y * size.width + x;
            const Shape shape = shape_at((x + 0.5) / size.width, (y + 0.5) / size.height);
            guides.node[k] = shape.node;
            guides.depth[k] = shape.node == kNoNode ? kInfinity : shape.depth;
            guides.normal[k] = shape.node == kNoNode ? glm::vec3(0.0f) : shape.normal;
        }
    }
    return guides;
}

Guides wall(const Size& size) {
    return guides_of(size, [](double, double) { return Shape{}; });
}

Film film_of(const Size& size, int sample_count) {
    Film film(size.width, size.height);
    film.sample_count = sample_count;
    return film;
}

/// A film that shows light on the surfaces.
Film lit(const Guides& guides, int sample_count, const std::function<glm::dvec3(size_t)>& light_of) {
    Film film = film_of({guides.width, guides.height}, sample_count);
    for (size_t k = 0; k < film.sum.size(); ++k) {
        glm::dvec3 radiance(guides.unfiltered[k]);
        if (guides.node[k] != kNoNode) radiance += divisor(guides.albedo[k]) * light_of(k);
        film.sum[k] = glm::vec4(double(sample_count) * radiance, float(sample_count));
    }
    return film;
}

Film upsample(const Guides& from_guides, const Film& from, const Guides& guides, int sample_count = 1) {
    Film film = film_of({guides.width, guides.height}, sample_count);
    Upsampler().light(from_guides, from, guides, &film);
    return film;
}

/// Light [height * width] between pixels' centres, in double; at the border that of the border.
glm::dvec3 bilinear(const std::vector<glm::dvec3>& light, const Size& size, double x, double y) {
    const auto at = [&](double column, double row) {
        const double i = std::clamp(column, 0.0, size.width - 1.0), j = std::clamp(row, 0.0, size.height - 1.0);
        return light[static_cast<size_t>(j) * static_cast<size_t>(size.width) + static_cast<size_t>(i)];
    };
    const double left = std::floor(x), top = std::floor(y), right = x - left, down = y - top;
    return (1.0 - down) * ((1.0 - right) * at(left, top) + right * at(left + 1.0, top)) +
           down * ((1.0 - right) * at(left, top + 1.0) + right * at(left + 1.0, top + 1.0));
}

/// On a wall, and on a plane that its slope explains, however steep.
TEST(Upsample, WhereSurfacesGoOnLightIsBilinear) {
    Rng rng(5);
    for (const float steep : {0.0f, 1.0f, 40.0f}) {
        const auto plane = [&](double x, double y) { return Shape{.depth = float(2.0 + steep * (x + 0.5 * y))}; };
        for (const auto& [small, large] :
             {std::pair(Size{16, 9}, Size{64, 36}), {Size{13, 9}, Size{40, 31}}, {Size{8, 6}, Size{8, 6}}}) {
            const Guides from_guides = guides_of(small, plane), guides = guides_of(large, plane);
            std::vector<glm::dvec3> light(from_guides.node.size());
            for (glm::dvec3& some : light) some = {rng.uniform(), rng.uniform(), 10.0f * rng.uniform()};
            const Film film = upsample(from_guides, lit(from_guides, 3, [&](size_t k) { return light[k]; }), guides);
            for (int y = 0; y < large.height; ++y) {
                for (int x = 0; x < large.width; ++x) {
                    const glm::dvec3 expected =
                        divisor(glm::vec3(0.0f)) *
                        bilinear(light, small, place(x, large.width, small.width), place(y, large.height, small.height));
                    const glm::vec4& sum = film.sum[size_t{1} * y * large.width + x];
                    for (int c = 0; c < 3; ++c) ASSERT_NEAR(sum[c], expected[c], 1e-5 * 0.4) << x << ' ' << y;
                }
            }
        }
    }
}

/// The edge goes right through pixels of the light.
TEST(Upsample, NoLightCrossesAnEdge) {
    const auto turned = [](double cosine) { return glm::vec3(std::sqrt(1.0 - cosine * cosine), 0.0, cosine); };
    const Shape here;
    // Depths differ by a little more than a hundredth of the greater one; normals by more than 1 - cosine = 1 / 4.
    const Shape beyond[] = {{.node = 1}, {.depth = 2.0f / 0.989f}, {.normal = turned(0.74)}, {.node = kNoNode}};
    for (const Shape& there : beyond) {
        for (const double edge : {0.31, 0.5, 0.637}) {
            const auto shape = [&](double x, double y) { return x + 0.2 * y < edge ? here : there; };
            const Size small{15, 11}, large{97, 61};
            const Guides from_guides = guides_of(small, shape), guides = guides_of(large, shape);
            const auto is_here = [&](const Guides& of, size_t k) {
                return of.node[k] == here.node && of.depth[k] == here.depth && of.normal[k] == here.normal;
            };
            const Film film = upsample(
                from_guides, lit(from_guides, 1, [&](size_t k) { return glm::dvec3(is_here(from_guides, k) ? 1.0 : 1e6); }),
                guides);
            for (size_t k = 0; k < film.sum.size(); ++k) {
                const double expected = guides.node[k] == kNoNode ? 0.0 : 0.04 * (is_here(guides, k) ? 1.0 : 1e6);
                ASSERT_NEAR(film.sum[k].x, expected, 1e-5 * expected) << k << ", edge " << edge;
            }
        }
    }
}

/// A stripe that no pixel of the light shows: it is lit as the surface beside it that is most alike.
TEST(Upsample, WhatNoNeighbourShowsIsLitAsTheMostAlike) {
    const Size small{8, 8}, large{64, 64};
    const Shape front{.depth = 1.0f}, back{.node = 1, .depth = 8.0f};
    for (const bool is_at_the_back : {false, true}) {
        Shape thin = is_at_the_back ? back : front;
        thin.node = 2;
        const auto shape = [&](double x, double) {
            return std::abs(x - 0.5) < 1.0 / large.width ? thin : x < 0.5 ? front : back;
        };
        const Guides from_guides = guides_of(small, shape), guides = guides_of(large, shape);
        ASSERT_EQ(std::ranges::count(from_guides.node, 2u), 0);
        ASSERT_GT(std::ranges::count(guides.node, 2u), 0);
        const Film film = upsample(
            from_guides, lit(from_guides, 1, [&](size_t k) { return glm::dvec3(from_guides.node[k] == 0 ? 1.0 : 100.0); }),
            guides);
        for (size_t k = 0; k < film.sum.size(); ++k) {
            if (guides.node[k] != 2) continue;
            const double expected = is_at_the_back ? 4.0 : 0.04;
            ASSERT_NEAR(film.sum[k].x, expected, 1e-5 * expected) << k;
        }
    }
}

/// Beside the sky only, or far away from all that is known, the picture's mean is what there is.
TEST(Upsample, WhereNoLightIsKnownTheMeanIsTaken) {
    const Size small{12, 12}, large{48, 48};
    const auto shape = [&](double x, double) { return Shape{.node = x < 0.5 ? 0u : x < 0.9 ? kNoNode : 1u}; };
    const Guides from_guides = guides_of(small, shape), guides = guides_of(large, shape);
    Film from = lit(from_guides, 1, [](size_t k) { return glm::dvec3(k % 12 < 3 ? 2.0 : 4.0); });
    for (size_t k = 0; k < from.sum.size(); ++k) {
        if (from_guides.node[k] == 1) from.sum[k].x = kNan;
    }
    const Film film = upsample(from_guides, from, guides);
    for (size_t k = 0; k < film.sum.size(); ++k) {
        if (guides.node[k] == 1) {
            ASSERT_NEAR(film.sum[k].x, 0.04 * 3.0, 1e-6) << k;
        }
    }
    const Guides sky = guides_of(small, [](double, double) { return Shape{.node = kNoNode}; });
    for (const glm::vec4& sum : upsample(sky, film_of(small, 1), wall(large)).sum)
        EXPECT_EQ(glm::vec3(sum), glm::vec3(0.0f));
}

/// The same light on surfaces of every colour; what glows, and the sky, pass as they are, and coverage is left alone.
TEST(Upsample, ColoursSkyAndEmissionAreThoseOfTheLargePicture) {
    const Size small{20, 12}, large{50, 36};
    Rng rng(9);
    const auto shape = [&](double x, double y) { return Shape{.node = x > 0.6 && y < 0.5 ? kNoNode : 0u}; };
    Guides from_guides = guides_of(small, shape), guides = guides_of(large, shape);
    for (Guides* of : {&from_guides, &guides}) {
        for (size_t k = 0; k < of->node.size(); ++k) {
            if (of->node[k] != kNoNode) of->albedo[k] = {rng.uniform(), rng.uniform(), rng.uniform()};
            of->unfiltered[k] = {5.0f * rng.uniform(), rng.uniform(), 0.0f};
        }
    }
    constexpr int kSamples = 4;
    Film film = film_of(large, kSamples);
    for (glm::vec4& sum : film.sum) sum = {kNan, 1.0f, 2.0f, rng.uniform()};
    const Film before = film;
    const Film from = lit(from_guides, 2, [](size_t) { return glm::dvec3(1.0, 2.0, 3.0); });
    Upsampler().light(from_guides, from, guides, &film);
    const Film expected = lit(guides, kSamples, [](size_t) { return glm::dvec3(1.0, 2.0, 3.0); });
    for (size_t k = 0; k < film.sum.size(); ++k) {
        // What is taken out of the small picture leaves a rounding of what was in it, over an albedo's least.
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(film.sum[k][c], expected.sum[k][c], 2e-4) << k;
        if (guides.node[k] == kNoNode) {
            ASSERT_EQ(glm::vec3(film.sum[k]), float(kSamples) * guides.unfiltered[k]);
        }
        ASSERT_EQ(film.sum[k].a, before.sum[k].a);
    }
}

/// A wire in front of a wall; one of the two is unlit. The light's pixels see the wall or the wire, as it falls.
TEST(Upsample, NothingLightsWhatIsUnlitAndThatLightsNothing) {
    for (const bool is_wire_unlit : {true, false}) {
        for (const bool is_wire_seen : {true, false}) {
            const auto shape_at = [&](bool is_seen) {
                return [=](double x, double) {
                    const bool is_wire = is_seen && std::abs(x - 0.5) < 0.05;
                    return Shape{.node = is_wire ? 1u : 0u,
                                 .depth = is_wire ? 1.9f : 2.0f,
                                 .normal = is_wire == is_wire_unlit ? glm::vec3(0.0f) : glm::vec3(0, 0, 1)};
                };
            };
            Guides from_guides = guides_of({5, 4}, shape_at(is_wire_seen)), guides = guides_of({40, 32}, shape_at(true));
            for (Guides* const some : {&from_guides, &guides}) {
                for (size_t k = 0; k < some->node.size(); ++k)
                    some->unfiltered[k] = glm::vec3(some->normal[k] == glm::vec3(0.0f) ? 0.2f : 0.0f);
            }
            const auto light_of = [&](size_t k) { return glm::dvec3(from_guides.normal[k].z); };
            const Film film = upsample(from_guides, lit(from_guides, 1, light_of), guides);
            const bool has_light = is_wire_unlit || is_wire_seen;  // Else the small picture shows the unlit wall only.
            for (size_t k = 0; k < guides.node.size(); ++k) {
                const float expected = guides.normal[k] == glm::vec3(0.0f) ? 0.2f : has_light ? 0.04f : 0.0f;
                EXPECT_FLOAT_EQ(film.sum[k].r, expected) << k << ' ' << is_wire_unlit << is_wire_seen;
            }
        }
    }
}

TEST(Upsample, WhatIsNotFiniteIsLeftOut) {
    const Size small{16, 16}, large{64, 64};
    Guides from_guides = wall(small), guides = wall(large);
    Film from = lit(from_guides, 1, [](size_t) { return glm::dvec3(1.0); });
    const float values[] = {kNan, kInfinity, -kInfinity};
    for (size_t i = 0; i < 3; ++i) {
        from.sum[40 + 5 * i] = glm::vec4(values[i]);
        from_guides.depth[100 + 5 * i] = values[i];
        from_guides.normal[150 + 5 * i] = glm::vec3(values[i]);
        from_guides.albedo[200 + 5 * i] = glm::vec3(kNan);
    }
    const Film film = upsample(from_guides, from, guides);
    for (const glm::vec4& sum : film.sum) ASSERT_NEAR(sum.x, 0.04f, 1e-6f);
    for (size_t i = 0; i < 3; ++i) {
        guides.depth[500 + 64 * i] = guides.normal[700 + 64 * i].x = guides.albedo[900 + 64 * i].y =
            guides.unfiltered[1100 + 64 * i].z = values[i];
    }
    for (const glm::vec4& sum : upsample(from_guides, from, guides).sum) {
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(sum[c]));
    }
}

TEST(Upsample, LightOfAnyBrightnessStaysFinite) {
    const Size small{8, 8}, large{30, 30};
    const Guides from_guides = wall(small), guides = wall(large);
    Film from = film_of(small, 1);
    const float values[] = {3e38f, -3e38f, 1e-45f, 0.0f, 1e20f};
    for (size_t k = 0; k < from.sum.size(); ++k) from.sum[k] = glm::vec4(values[k % 5]);
    for (const glm::vec4& sum : upsample(from_guides, from, guides).sum)
        ASSERT_TRUE(std::isfinite(sum.x) && sum.x >= 0.0f && sum.x <= 1e15f);
}

TEST(Upsample, PicturesOfAnyShapeAreLit) {
    for (const auto& [small, large] : {std::pair(Size{1, 1}, Size{1, 1}),
                                       {Size{1, 1}, Size{5, 3}},
                                       {Size{2, 1}, Size{1, 7}},
                                       {Size{9, 9}, Size{2, 2}},
                                       {Size{1, 4}, Size{33, 4}}}) {
        const Guides from_guides = wall(small);
        const Film film = upsample(from_guides, lit(from_guides, 1, [](size_t) { return glm::dvec3(10.0); }), wall(large));
        for (const glm::vec4& sum : film.sum) EXPECT_NEAR(sum.x, 0.4f, 1e-6f) << large.width << 'x' << large.height;
    }
}

/// Rays without light see what those with light do, and cost a small part of them.
TEST(Upsample, SurfacesAreTheSameWithoutLight) {
    Frames frames;
    frames.advance_to(1.0);
    frames.advance_to(25 / 24.0);
    Guides with, without;
    FrameStats with_stats, without_stats;
    frames.sample({96, 54}, true, &with, 1, 7, &with_stats);
    const Film film = frames.sample({96, 54}, false, &without, 1, 7, &without_stats);
    const auto is_same = [](const auto& a, const auto& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
    };
    EXPECT_TRUE(is_same(with.albedo, without.albedo));
    EXPECT_TRUE(is_same(with.normal, without.normal));
    EXPECT_TRUE(is_same(with.unfiltered, without.unfiltered));
    EXPECT_TRUE(is_same(with.depth, without.depth));
    EXPECT_TRUE(is_same(with.node, without.node));
    EXPECT_TRUE(is_same(with.was_at, without.was_at));
    for (size_t k = 0; k < film.sum.size(); ++k) ASSERT_EQ(glm::vec3(film.sum[k]), without.unfiltered[k]) << k;
    EXPECT_EQ(without_stats.rays, without_stats.primary.rays);
    EXPECT_EQ(without_stats.primary.rays, with_stats.primary.rays);
    EXPECT_LT(3 * without_stats.rays, with_stats.rays);
}

/// Of frames in motion, as they are played: light of a sixteenth of the pixels.
TEST(Upsample, FineSurfacesTakeErrorFromCoarseLight) {
    const Size small{48, 27}, large{192, 108};
    Frames frames;
    Denoiser denoiser;
    Guides from_guides, guides;
    Film from;
    for (int frame = 0; frame < 6; ++frame) {
        frames.advance_to((30 + frame) / 24.0);
        from = frames.sample(small, true, &from_guides, 1, static_cast<uint32_t>(frame));
        denoiser.filter(from_guides, {}, &from);
    }
    Film film = frames.sample(large, false, &guides);
    Upsampler().light(from_guides, from, guides, &film);
    const Film reference = frames.sample(large, true, nullptr, 24, 1 << 20);
    std::vector<glm::dvec3> radiance;
    for (const glm::vec4& sum : from.sum) radiance.emplace_back(sum);
    Film stretched = film_of(large, 1);
    for (int y = 0; y < large.height; ++y) {
        for (int x = 0; x < large.width; ++x) {
            stretched.sum[size_t{1} * y * large.width + x] = glm::vec4(
                bilinear(radiance, small, place(x, large.width, small.width), place(y, large.height, small.height)), 1.0f);
        }
    }
    const double before = screen_error(stretched, reference), after = screen_error(film, reference);
    std::printf("error %.4f stretched, %.4f on fine surfaces\n", before, after);
    EXPECT_LT(1.25 * after, before);
}

TEST(Upsample, ThreadsDoNotMatterAndNothingIsAllocated) {
    Frames frames;
    frames.advance_to(1.0);
    Guides from_guides, guides;
    const Film from = frames.sample({40, 22}, true, &from_guides);
    const Film surfaces = frames.sample({160, 90}, false, &guides);
    Film films[2] = {surfaces, surfaces};
    for (const int threads : {1, 2}) {
        set_thread_count(threads);
        Upsampler upsampler;
        for (int turn = 0; turn < 2; ++turn) {
            const size_t before = allocation_count();
            upsampler.light(from_guides, from, guides, &films[threads - 1]);
            if (threads == 1 && turn > 0) {
                EXPECT_EQ(allocation_count(), before);
            }
        }
    }
    set_thread_count(0);
    EXPECT_EQ(std::memcmp(films[0].sum.data(), films[1].sum.data(), surfaces.sum.size() * sizeof(glm::vec4)), 0);
}

}  // namespace
}  // namespace zoe::test
