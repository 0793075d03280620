// Copies of a scene, side by side: whole, apart, each at its own time.

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "apps/bench/bench_scenes.h"
#include "apps/common/place_copies.h"
#include "apps/common/usage_error.h"
#include "content/content.h"
#include "engine/frame/frame.h"

namespace zoe::test {
namespace {

/// `skinned-2` is one ring of two figures that walk and go round: nodes, skins and channels of every kind of reference.
constexpr const char* kOriginal = "skinned-2";

TEST(Copies, AreWholeAndApart) {
    Scene original = make_content(kOriginal).scene, copied = make_content(kOriginal).scene;
    place_copies(5, &copied);
    EXPECT_EQ(check(copied), "");
    EXPECT_EQ(copied.meshes.size(), original.meshes.size());
    EXPECT_EQ(copied.skins.size(), 5 * original.skins.size());
    for (const Node& node : copied.nodes) EXPECT_EQ(node.camera, kNone<CameraId>);
    const Tlas &one = advance(original, 0.0), &all = advance(copied, 0.0);
    ASSERT_EQ(all.instances.size(), 5 * one.instances.size());
    // What is of one copy stands within the place that the original takes up, moved to a place of its own.
    for (size_t k = 0; k < 5; ++k) {
        Aabb box;
        for (size_t i = 0; i < one.instances.size(); ++i) {
            const Instance& instance = all.instances[k * one.instances.size() + i];
            box.extend(instance.bounds_world);
            EXPECT_EQ(motion(copied, instance.node), motion(original, one.instances[i].node));
        }
        for (size_t i = 0; i < all.instances.size(); ++i) {
            if (i / one.instances.size() == k) continue;
            const Aabb& other = all.instances[i].bounds_world;
            const bool is_apart = glm::any(glm::lessThan(box.hi, other.lo)) || glm::any(glm::lessThan(other.hi, box.lo));
            EXPECT_TRUE(is_apart) << "copy " << k << " and instance " << i;
        }
    }
}

/// Copy k of n at t is the original at t plus k/n of the clip, moved. At the times of keys: 48 a clip of 4 s, and 4 copies.
TEST(Copies, PlayTheClipLater) {
    Scene original = make_content(kOriginal).scene, copied = make_content(kOriginal).scene;
    place_copies(4, &copied);
    for (const double time_s : {0.0, 0.5, 1.75}) {
        const Tlas& all = advance(copied, time_s);
        const size_t each = all.instances.size() / 4;
        for (size_t k = 0; k < 4; ++k) {
            const Tlas& one = advance(original, time_s + double(k));
            ASSERT_EQ(one.instances.size(), each);
            glm::vec3 moved(0.0f);
            for (size_t i = 0; i < each; ++i) {
                const Instance &copy = all.instances[k * each + i], &expected = one.instances[i];
                ASSERT_EQ(copy.positions.size(), expected.positions.size());
                const auto place_of = [](const Instance& instance, size_t v) {
                    return instance.world_from_local.point(instance.positions[v]);
                };
                if (i == 0) moved = place_of(copy, 0) - place_of(expected, 0);
                for (size_t v = 0; v < copy.positions.size(); ++v) {
                    ASSERT_LT(glm::distance(place_of(copy, v) - moved, place_of(expected, v)), 1e-4f)
                        << "time " << time_s << " copy " << k << " instance " << i << " vertex " << v;
                }
            }
            EXPECT_EQ(moved == glm::vec3(0.0f), k == 0) << "copy " << k;
        }
    }
}

TEST(Copies, OneIsTheSceneItself) {
    Scene scene = make_content("default").scene;
    const size_t node_count = scene.nodes.size();
    place_copies(1, &scene);
    EXPECT_EQ(scene.nodes.size(), node_count);
}

TEST(Copies, AreNamedByTheirCount) {
    const BenchScene scene = find_bench_scene("skinned*12");
    EXPECT_EQ(scene.name, "skinned*12");
    EXPECT_EQ(scene.scene, "skinned-100");
    EXPECT_EQ(scene.copies, 12);
    EXPECT_EQ(find_bench_scene("rigid-5*1").copies, 1);
    for (const char* const name : {"rigid*", "rigid*0", "rigid*-1", "rigid*1.5", "rigid*10001", "rigid*99999999999",
                                   "rigid*x", "rigid*2*3", "*3", "*", "rigid *3", "nowhere.glb*2", "rigid-0*2"}) {
        EXPECT_THROW(find_bench_scene(name), UsageError) << name;
    }
}

}  // namespace
}  // namespace zoe::test
