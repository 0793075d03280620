// The scenes of the content list: whole, deterministic, and refused by name where there are none.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/frame.h"

namespace zoe::test {
namespace {

TEST(ContentList, MakesWholeScenesThatShowSomething) {
    for (const ContentInfo& info : content_list()) {
        Content content = make_content(info.name, 12);
        EXPECT_EQ(check(content.scene), "") << info.name;
        if (content.write) content.write(content.scene, 0.5);
        EXPECT_FALSE(advance(content.scene, 0.5).instances.empty()) << info.name;
        EXPECT_TRUE(content.scene.warnings().empty()) << info.name << ": " << content.scene.warnings().begin()->first;
    }
}

TEST(ContentList, MakesTheSameSceneEachTime) {
    for (const ContentInfo& info : content_list()) {
        const Content a = make_content(info.name, 7), b = make_content(info.name, 7);
        ASSERT_EQ(a.scene.meshes.size(), b.scene.meshes.size()) << info.name;
        for (size_t i = 0; i < a.scene.meshes.size(); ++i) {
            EXPECT_EQ(a.scene.meshes[i].positions, b.scene.meshes[i].positions) << info.name << " mesh " << i;
            EXPECT_EQ(a.scene.meshes[i].corners, b.scene.meshes[i].corners) << info.name << " mesh " << i;
        }
    }
}

TEST(ContentList, LoopsWithoutASeam) {
    for (const ContentInfo& info : content_list()) {
        const Content content = make_content(info.name, 5);
        for (const Clip& clip : content.scene.clips) {
            EXPECT_EQ(clip.duration_s, 4.0) << info.name;
            for (const AnimationChannel& channel : clip.channels) {
                const Sampler& sampler = clip.samplers[channel.sampler];
                if (sampler.interpolation == Interpolation::kStep) continue;
                std::vector<float> first(sampler.width), last(sampler.width);
                sample(sampler, 0.0, first);
                sample(sampler, 4.0, last);
                float same = 0.0f, opposite = 0.0f;  // A rotation by whole turns may end at -q.
                for (size_t k = 0; k < first.size(); ++k) {
                    same = std::max(same, std::abs(first[k] - last[k]));
                    opposite = std::max(opposite, std::abs(first[k] + last[k]));
                }
                EXPECT_LT(sampler.is_rotation ? std::min(same, opposite) : same, 2e-5f)
                    << info.name << ": " << content.scene[channel.node].name;
            }
        }
    }
}

TEST(ContentList, SaysWhichNamesThereAre) {
    try {
        make_content("no such thing");
        FAIL() << "an unknown name was accepted";
    } catch (const SceneError& error) {
        for (const ContentInfo& info : content_list()) {
            EXPECT_NE(std::string(error.what()).find(info.name), std::string::npos) << info.name;
        }
    }
    EXPECT_THROW(make_content("static", -1), SceneError);
}

}  // namespace
}  // namespace zoe::test
