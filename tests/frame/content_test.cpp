// The scenes of the content list: whole, deterministic, and refused by name where there are none.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/render/view.h"

namespace zoe::test {
namespace {

/// A size that is made at once; 0 where the scene has one size.
int small_size(const ContentInfo& info, int size) {
    return info.max_size == 0 ? 0 : size;
}

TEST(ContentList, MakesWholeScenesThatShowSomething) {
    for (const ContentInfo& info : content_list()) {
        Content content = make_content(info.name, small_size(info, 3));
        EXPECT_EQ(check(content.scene), "") << info.name;
        if (content.write) content.write(content.scene, 0.5);
        EXPECT_FALSE(advance(content.scene, 0.5).instances.empty()) << info.name;
        EXPECT_TRUE(content.scene.warnings().empty()) << info.name << ": " << content.scene.warnings().begin()->first;
    }
}

TEST(ContentList, MakesTheSameSceneEachTime) {
    for (const ContentInfo& info : content_list()) {
        const int size = small_size(info, 7);
        const Content a = make_content(info.name, size), b = make_content(info.name, size);
        ASSERT_EQ(a.scene.meshes.size(), b.scene.meshes.size()) << info.name;
        for (size_t i = 0; i < a.scene.meshes.size(); ++i) {
            EXPECT_EQ(a.scene.meshes[i].positions, b.scene.meshes[i].positions) << info.name << " mesh " << i;
            EXPECT_EQ(a.scene.meshes[i].corners, b.scene.meshes[i].corners) << info.name << " mesh " << i;
        }
    }
}

TEST(ContentList, LoopsWithoutASeam) {
    for (const ContentInfo& info : content_list()) {
        const Content content = make_content(info.name, small_size(info, 5));
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

size_t count_shown_triangles(const Scene& scene) {
    size_t count = 0;
    for (const Node& node : scene.nodes) {
        if (node.mesh != kNone<MeshId>) count += scene[node.mesh].corners.size();
    }
    return count;
}

void expect_about(size_t count, double expected, const std::string& what) {
    EXPECT_NEAR(static_cast<double>(count), expected, 0.1 * expected) << what;
}

TEST(ContentList, SizesMeanWhatTheListSays) {
    expect_about(count_shown_triangles(make_content("static", 5000).scene), 5000, "static");
    EXPECT_EQ(count_shown_triangles(make_content("rigid", 7).scene), 7000u);
    EXPECT_EQ(count_shown_triangles(make_content("deforming", 20).scene), 2u * 20 * 20);
    EXPECT_EQ(make_content("dancers", 3).scene.skins.size(), 3u);
    EXPECT_EQ(make_content("surface", 20).scene.meshes[0].surface->cage.face_sizes.size(), 20u * 20);
    EXPECT_EQ(count_shown_triangles(make_content("arbitrary", 500).scene), 500u);
    EXPECT_EQ(make_content("skinned", 9).scene.skins.size(), 9u);
    expect_about(count_shown_triangles(make_content("character", 8).scene), 8000, "character");
    EXPECT_EQ(count_shown_triangles(make_content("instances", 30).scene), 80u * 30);
    // 72,000 static, 5 x 1,000 rigid, 5,000 deforming, 1,000 exploding triangles a unit.
    expect_about(count_shown_triangles(make_content("mixed", 1).scene), 83'000, "mixed");
    EXPECT_GT(count_shown_triangles(make_content("topology", 24).scene),
              count_shown_triangles(make_content("topology", 12).scene));
}

TEST(ContentList, ViewsAreFilledWithWhatThereIsToSee) {
    constexpr int kWidth = 64, kHeight = 36;
    for (const ContentInfo& info : content_list()) {
        for (const int size : {small_size(info, 10), 0}) {
            Content content = make_content(info.name, size);
            const auto camera =
                std::ranges::find_if(content.scene.nodes, [](const Node& node) { return node.name == "view"; });
            ASSERT_NE(camera, content.scene.nodes.end()) << info.name;
            if (content.write) content.write(content.scene, 0.4);
            const Tlas& tlas = advance(content.scene, 0.4);
            const NodeId id{static_cast<uint32_t>(camera - content.scene.nodes.begin())};
            const View view = view_from_camera(content.scene, id, float(kWidth) / float(kHeight));
            int hit_count = 0;
            for (int y = 0; y < kHeight; ++y) {
                for (int x = 0; x < kWidth; ++x) {
                    const Ray ray = camera_ray(view, float(x) + 0.5f, float(y) + 0.5f, kWidth, kHeight);
                    hit_count += any_hit(tlas, ray) ? 1 : 0;
                }
            }
            EXPECT_GT(hit_count, kWidth * kHeight / (size == 0 ? 2 : 10)) << info.name << "-" << size;
        }
    }
}

/// Pieces of a mesh that share no vertex.
size_t count_parts(const Mesh& mesh) {
    std::vector<uint32_t> part(mesh.positions.size());
    std::iota(part.begin(), part.end(), 0u);
    const auto root = [&](uint32_t v) {
        while (part[v] != v) v = part[v] = part[part[v]];
        return v;
    };
    for (const glm::uvec3& c : mesh.corners) {
        part[root(c.y)] = root(c.x);
        part[root(c.z)] = root(c.x);
    }
    std::set<uint32_t> roots;
    for (const glm::uvec3& c : mesh.corners) roots.insert(root(c.x));
    return roots.size();
}

TEST(ContentList, DropsMeetAndPart) {
    Content content = make_content("topology", 32);
    std::set<size_t> counts;
    for (int k = 0; k < 16; ++k) {
        content.write(content.scene, 0.25 * k);
        counts.insert(count_parts(content.scene.meshes.front()));
    }
    EXPECT_GE(counts.size(), 3u) << "between " << *counts.begin() << " and " << *counts.rbegin() << " parts";
}

TEST(ContentNames, MayCarryASize) {
    EXPECT_EQ(parse_content_name("rigid").size, 0);
    EXPECT_EQ(parse_content_name("rigid-50").size, 50);
    EXPECT_STREQ(parse_content_name("instances-100000").info->name, "instances");
    const Content named = make_content("rigid-3"), sized = make_content("rigid", 3);
    EXPECT_EQ(named.scene.nodes.size(), sized.scene.nodes.size());
    EXPECT_EQ(count_shown_triangles(named.scene), 3000u);
}

TEST(ContentNames, BadSizesAreRefused) {
    for (const char* const name :
         {"rigid-", "rigid-0", "rigid--3", "rigid-abc", "rigid-1.5", "rigid-3x", "rigid- 3", "rigid-+3",
          "rigid-99999999999999999999", "rigid-100001", "default-3", "rigid-3-4", "-3", "-", "", "Rigid"}) {
        EXPECT_THROW(parse_content_name(name), SceneError) << name;
        EXPECT_THROW(make_content(name), SceneError) << name;
    }
    EXPECT_THROW(make_content("rigid-3", 4), SceneError);
    EXPECT_THROW(make_content("default", 2), SceneError);
    EXPECT_FALSE(is_content_name("fox.glb"));
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
