#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

/// One node, one channel.
struct ChannelGlb : GlbBuilder {
    ChannelGlb(int input, int output, const char* path, const char* interpolation) {
        set(input, output, path, interpolation);
    }
    ChannelGlb() = default;
    void set(int input, int output, const char* path, const char* interpolation) {
        if (!json.contains("nodes")) push("nodes", nlohmann::json::object());
        push("animations", {{"name", "clip"},
                            {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}});
    }
};

TEST(AnimationReader, EveryPathAndInterpolationIsRead) {
    ChannelGlb glb;
    const int times = glb.floats({0.5f, 2.0f}, "SCALAR");
    glb.set(times, glb.floats({1, 2, 3, 4, 5, 6}, "VEC3"), "translation", "STEP");
    glb.set(times, glb.floats({0, 0, 0, 2, 0, 0, 3, 0}, "VEC4"), "rotation", "LINEAR");
    std::vector<float> spline(18, 0.0f);
    spline[3] = 1.0f;
    glb.set(times, glb.floats(spline, "VEC3"), "scale", "CUBICSPLINE");
    const Scene scene = glb.load();
    ASSERT_EQ(scene.clips.size(), 3u);
    EXPECT_EQ(scene.playback.clips, std::vector<ClipId>{ClipId{0}});
    EXPECT_TRUE(scene.playback.is_looping);
    const Sampler& step = scene.clips[0].samplers[0];
    EXPECT_EQ(step.interpolation, Interpolation::kStep);
    EXPECT_EQ(step.times_s, (std::vector<float>{0.5f, 2.0f}));
    EXPECT_EQ(step.values, (std::vector<float>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(scene.clips[0].duration_s, 2.0);
    const Sampler& rotation = scene.clips[1].samplers[0];
    EXPECT_TRUE(rotation.is_rotation);
    EXPECT_EQ(rotation.values, (std::vector<float>{0, 0, 0, 1, 0, 0, 1, 0})) << "normalised";
    EXPECT_EQ(scene.clips[2].samplers[0].interpolation, Interpolation::kCubicSpline);
    EXPECT_EQ(scene.clips[2].samplers[0].values.size(), 18u);
    EXPECT_EQ(scene.clips[2].channels[0].path, ChannelPath::kScale);
}

TEST(AnimationReader, NormalizedRotationsOfEveryIntegerTypeAreUnit) {
    const auto rotation = [](auto values, int type) {
        ChannelGlb glb;
        const int times = glb.floats({0}, "SCALAR");
        glb.set(times, glb.accessor(values, type, "VEC4", 1, true), "rotation", "LINEAR");
        return glb.load().clips[0].samplers[0].values;
    };
    const float half = std::sqrt(0.5f);
    for (const std::vector<float>& q :
         {rotation(std::vector<int8_t>{0, 90, 0, 90}, kByte), rotation(std::vector<uint8_t>{0, 180, 0, 180}, kUbyte),
          rotation(std::vector<int16_t>{0, 23170, 0, 23170}, kShort),
          rotation(std::vector<uint16_t>{0, 46341, 0, 46341}, kUshort)}) {
        ASSERT_EQ(q.size(), 4u);
        EXPECT_NEAR(q[1], half, 1e-6f);
        EXPECT_NEAR(q[3], half, 1e-6f);
    }
}

TEST(AnimationReader, SplineRotationsKeepTheirTangents) {
    ChannelGlb glb;
    const int times = glb.floats({0}, "SCALAR");
    glb.set(times, glb.floats({5, 5, 5, 5, 0, 0, 0, 2, 7, 7, 7, 7}, "VEC4"), "rotation", "CUBICSPLINE");
    EXPECT_EQ(glb.load().clips[0].samplers[0].values, (std::vector<float>{5, 5, 5, 5, 0, 0, 0, 1, 7, 7, 7, 7}));
}

TEST(AnimationReader, WeightsAreAsWideAsTheTargets) {
    const Scene scene = make_rich_glb().load();
    ASSERT_EQ(scene.clips[0].channels.size(), 2u);
    const Sampler& sampler = scene.clips[0].samplers[scene.clips[0].channels[1].sampler];
    EXPECT_EQ(sampler.width, 1u);
    EXPECT_EQ(sampler.values, (std::vector<float>{0, 1}));
    GlbBuilder glb = make_rich_glb();
    glb.json["animations"][0]["samplers"][1]["output"] = glb.floats({0, 1, 2}, "SCALAR");
    EXPECT_NE(glb.error().find("/animations/0/samplers/1/output"), std::string::npos);
}

TEST(AnimationReader, KeysOutOfOrderAreMovedToTheOneBefore) {
    ChannelGlb glb;
    const int times = glb.floats({0, 2, 1, 2, 3}, "SCALAR");
    glb.set(times, glb.floats(std::vector<float>(15, 0.0f), "VEC3"), "translation", "LINEAR");
    const Scene scene = glb.load();
    EXPECT_EQ(scene.clips[0].samplers[0].times_s, (std::vector<float>{0, 2, 2, 2, 3}));
    EXPECT_EQ(scene.warnings().size(), 2u) << "one for the key before, one for the equal one";
}

TEST(AnimationReader, WhatCannotBePlayedIsCounted) {
    ChannelGlb glb;
    const int times = glb.floats({0}, "SCALAR"), values = glb.floats({0, 0, 0}, "VEC3"), numbers = glb.floats({0}, "SCALAR");
    glb.set(times, values, "translation", "LINEAR");
    glb.set(times, numbers, "weights", "LINEAR");
    glb.set(times, values, "pointer", "LINEAR");
    nlohmann::json& channels = glb.json["animations"][0]["channels"];
    channels.push_back(channels[0]);
    channels.push_back({{"sampler", 0}, {"target", {{"path", "scale"}}}});
    const Scene scene = glb.load();
    EXPECT_EQ(scene.clips[0].channels.size(), 2u);
    EXPECT_TRUE(scene.clips[1].channels.empty());
    EXPECT_TRUE(scene.clips[2].channels.empty());
    EXPECT_EQ(scene.warnings().size(), 4u);
}

TEST(AnimationReader, BrokenSamplersAreRefused) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto error = [](const std::vector<float>& times, const std::vector<float>& values, const char* interpolation) {
        ChannelGlb glb;
        const int input = glb.floats(times, "SCALAR");
        glb.set(input, glb.floats(values, "VEC3"), "translation", interpolation);
        return glb.error();
    };
    EXPECT_NE(error({0, 1}, {0, 0, 0}, "LINEAR").find("/animations/0/samplers/0/output"), std::string::npos);
    EXPECT_NE(error({0}, {0, 0, 0}, "CUBICSPLINE").find("/animations/0/samplers/0/output"), std::string::npos);
    EXPECT_NE(error({0}, {0, 0, nan}, "LINEAR").find("/animations/0/samplers/0/output"), std::string::npos);
    EXPECT_NE(error({nan}, {0, 0, 0}, "LINEAR").find("/animations/0/samplers/0/input"), std::string::npos);
    EXPECT_NE(error({0}, {0, 0, 0}, "SMOOTH").find("/animations/0/samplers/0/interpolation"), std::string::npos);
}

}  // namespace
}  // namespace zoe::test
