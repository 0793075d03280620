// Trees on disk, as a scene uses them: the same hits, and whatever is wrong with the folder is a warning.

#include "engine/bvh/cache.h"

#include <cstring>
#include <filesystem>
#include <memory>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/math/rng.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

/// Large enough that building takes many times longer than any file.
constexpr const char* kScenes[] = {"static-30000", "rigid-20"};

struct Played {
    FrameStats stats;
    std::vector<Hit> hits;
    std::map<std::string, uint64_t> warnings;
};

/// Plays three frames of a scene and shoots the same rays through each.
/// folder     empty: no cache.
Played play(const std::string& name, const fs::path& folder) {
    Content content = make_content(name);
    Scene& scene = content.scene;
    if (!folder.empty()) scene.tree_cache = std::make_shared<TreeCache>(folder);
    Played played;
    Rng rng(7);
    for (int frame = 0; frame < 3; ++frame) {
        const Tlas& tlas = advance(scene, frame / 24.0, &played.stats);
        const Aabb bounds = tlas.bounds();
        const auto point = [&] {
            return bounds.lo + (bounds.hi - bounds.lo) * glm::vec3(rng.uniform(), rng.uniform(), rng.uniform());
        };
        for (int k = 0; k < 2000; ++k) {
            const glm::vec3 origin = point();
            played.hits.push_back(closest_hit(tlas, {.origin = origin, .direction = point() - origin}));
        }
    }
    played.warnings = scene.warnings();
    return played;
}

void expect_same_hits(const Played& a, const Played& b) {
    ASSERT_EQ(a.hits.size(), b.hits.size());
    size_t hit_count = 0;
    for (size_t k = 0; k < a.hits.size(); ++k) {
        const Hit &x = a.hits[k], &y = b.hits[k];
        ASSERT_EQ(std::memcmp(&x.t, &y.t, sizeof x.t), 0) << "ray " << k;
        ASSERT_EQ(std::memcmp(&x.u, &y.u, sizeof x.u), 0) << "ray " << k;
        ASSERT_EQ(std::memcmp(&x.v, &y.v, sizeof x.v), 0) << "ray " << k;
        ASSERT_EQ(x.node, y.node) << "ray " << k;
        ASSERT_EQ(x.primitive, y.primitive) << "ray " << k;
        hit_count += static_cast<bool>(x);
    }
    EXPECT_GT(hit_count, 100u);
}

TEST(SceneCache, IsOffUnlessSet) {
    EXPECT_EQ(Scene().tree_cache, nullptr);
    const Played played = play(kScenes[0], {});
    EXPECT_EQ(played.stats.loaded + played.stats.stored, 0u);
}

TEST(SceneCache, TreesThatWereKeptGiveTheSameHits) {
    for (const char* const name : kScenes) {
        SCOPED_TRACE(name);
        const TempFolder folder;
        const Played without = play(name, {}), first = play(name, folder.path()), second = play(name, folder.path());
        EXPECT_EQ(first.stats.loaded, 0u);
        EXPECT_GT(first.stats.stored, 0u);
        EXPECT_EQ(second.stats.loaded, first.stats.stored);
        EXPECT_EQ(second.stats.stored, 0u);
        EXPECT_EQ(second.stats.rebuilt, first.stats.rebuilt) << "nodes, wherever their tree comes from";
        EXPECT_EQ(second.warnings, without.warnings);
        expect_same_hits(without, first);
        expect_same_hits(without, second);
    }
}

TEST(SceneCache, TreesThatDeformOrAreRebuiltAreNotKept) {
    for (const char* const name : {"deforming-100", "arbitrary-20000"}) {
        SCOPED_TRACE(name);
        const TempFolder folder;
        Content content = make_content(name);
        content.scene.tree_cache = std::make_shared<TreeCache>(folder.path());
        FrameStats stats;
        for (int frame = 0; frame < 3; ++frame) {
            if (content.write) content.write(content.scene, frame / 24.0);
            advance(content.scene, frame / 24.0, &stats);
        }
        EXPECT_GT(stats.rebuilt, 0u);
        EXPECT_EQ(stats.loaded + stats.stored, 0u);
        EXPECT_TRUE(fs::is_empty(folder.path()));
    }
}

TEST(SceneCache, BrokenFilesAreAWarningWithACount) {
    const char* const name = kScenes[0];
    const TempFolder folder;
    const Played without = play(name, {}), first = play(name, folder.path());
    ASSERT_GT(first.stats.stored, 0u);
    for (const fs::directory_entry& entry : fs::directory_iterator(folder.path())) {
        fs::resize_file(entry.path(), entry.file_size() - 1);
    }
    const Played broken = play(name, folder.path());
    EXPECT_EQ(broken.stats.loaded, 0u);
    EXPECT_EQ(broken.stats.stored, first.stats.stored) << "they are replaced";
    uint64_t count = 0;
    for (const auto& [text, times] : broken.warnings) {
        if (text.find("cut short") != std::string::npos && text.find(folder.path().native()) != std::string::npos) {
            count += times;
        }
    }
    EXPECT_EQ(count, first.stats.stored);
    expect_same_hits(without, broken);
    EXPECT_EQ(play(name, folder.path()).stats.loaded, first.stats.stored);
}

TEST(SceneCache, FolderThatCannotBeUsedIsAWarning) {
    const TempFolder folder;
    const fs::path file = folder.write("file", "someone's");
    const Played without = play(kScenes[0], {}), with = play(kScenes[0], file);
    EXPECT_EQ(with.stats.loaded + with.stats.stored, 0u);
    EXPECT_GT(with.warnings.size(), without.warnings.size());
    expect_same_hits(without, with);
}

}  // namespace
}  // namespace zoe::test
