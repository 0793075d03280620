// Frames, edits and rays that meet: who comes second is refused, and nothing has changed.

#include <atomic>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "content/content.h"
#include "engine/frame/classify.h"
#include "engine/render/path.h"
#include "tests/frame/motion_class.h"
#include "tests/frame/random_rays.h"

namespace zoe {
namespace {

using test::play;
using test::rays_at;

// Tries it again and again until rays are in its way. Fails where they never are.
template <typename Edit>
void expect_refused(const char* what, Edit&& edit) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (std::chrono::steady_clock::now() < end) {
        try {
            edit();
        } catch (const std::logic_error& error) {
            EXPECT_NE(std::string(error.what()).find("rays are being traced"), std::string::npos) << error.what();
            return;
        }
        std::this_thread::yield();
    }
    ADD_FAILURE() << what << " was never refused";
}

// Does it in another thread again and again, for a frame in making refuses it, until told to stop.
template <typename Trace>
class Tracing {
public:
    explicit Tracing(Trace trace)
        : thread_([this, trace = std::move(trace)] {
              while (!is_over_) {
                  try {
                      trace();
                  } catch (const std::logic_error&) {
                      std::this_thread::yield();
                  }
              }
          }) {}
    ~Tracing() {
        is_over_ = true;
        thread_.join();
    }

private:
    std::atomic<bool> is_over_{false};
    std::thread thread_;
};

// A rendering that does not end by itself: once it has begun, all that would pull the tree away is refused, changes nothing,
// and works afterwards.
TEST(RaysOnTheirWay, ARenderingRefusesFramesAndEdits) {
    Content content = make_content("mixed-1");
    Scene& scene = content.scene;
    const Tlas* const tlas = &play(content, 0.7);
    const std::vector<Ray> rays = rays_at(*tlas, 500, 8);
    std::vector<Hit> before(rays.size()), after(rays.size());
    closest_hits(*tlas, rays, before);
    const std::optional<Motion> motion_before = scene[NodeId{0}].motion;
    const size_t node_count = scene.nodes.size(), mesh_count = scene.meshes.size();
    std::atomic<bool> cancel{false}, is_done{false};
    bool is_finished = true;
    std::thread thread([&] {
        Film film(64, 64);
        RenderConfig config;
        config.cancel = &cancel;
        const View view = look_at({5, 5, 5}, {0, 0, 0}, 50.0f, 1.0f);
        is_finished = render(scene, *tlas, view, config, 1 << 28, &film, nullptr);
        is_done = true;
    });
    // A frame in making would refuse the rendering; this lets it in.
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (tlas->watch->is_idle() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    const std::vector<glm::vec3> positions = scene.meshes[0].positions;
    const std::vector<glm::uvec3> corners = scene.meshes[0].corners;
    EXPECT_THROW(advance(scene, 0.9), std::logic_error);
    EXPECT_THROW(scene.touch(), std::logic_error);
    EXPECT_THROW(set_motion(scene, NodeId{0}, Motion::kArbitrary), std::logic_error);
    EXPECT_THROW(scene.write_mesh(MeshId{0}, positions, {}, corners), std::logic_error);
    EXPECT_THROW(scene.write_cage(MeshId{0}, positions), std::logic_error);
    EXPECT_THROW(scene.add(Node{}), std::logic_error);
    EXPECT_THROW(scene.add(Mesh{}), std::logic_error);
    EXPECT_THROW(scene.add(Material{}), std::logic_error);
    closest_hits(*tlas, rays, after);  // Rays do not refuse each other.
    EXPECT_FALSE(is_done);
    cancel = true;
    thread.join();
    EXPECT_FALSE(is_finished);
    EXPECT_EQ(before, after);
    EXPECT_EQ(scene.nodes.size(), node_count);
    EXPECT_EQ(scene.meshes.size(), mesh_count);
    EXPECT_EQ(scene[NodeId{0}].motion, motion_before);

    // It was the rays alone.
    closest_hits(play(content, 0.7), rays, after);
    EXPECT_EQ(before, after);
    EXPECT_NO_THROW(scene.touch());
    closest_hits(play(content, 0.7), rays, after);
    EXPECT_EQ(before, after);
}

TEST(RaysOnTheirWay, BatchesRefuseFramesAndFramesRefuseBatches) {
    Content content = make_content("instances-2000");
    Scene& scene = content.scene;
    const Tlas& tlas = advance(scene, 0.0);
    const std::vector<Ray> rays = rays_at(tlas, 20'000, 9);
    std::atomic<int> closest_count{0}, refused_count{0};
    {
        const Tracing closest([&] {
            std::vector<Hit> hits(rays.size());
            try {
                closest_hits(tlas, rays, hits);
            } catch (const std::logic_error&) {
                ++refused_count;
                throw;
            }
            ++closest_count;
        });
        expect_refused("advance, by closest_hits", [&] { advance(scene, 0.3); });
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
        for (int k = 0; refused_count == 0 && std::chrono::steady_clock::now() < end; ++k) {
            try {
                advance(scene, 0.01 * k);
            } catch (const std::logic_error&) {
                std::this_thread::yield();
            }
        }
    }
    EXPECT_GT(closest_count, 0);
    EXPECT_GT(refused_count, 0);
    {
        const Tracing any([&] {
            std::vector<uint8_t> is_hit(rays.size());
            any_hits(tlas, rays, is_hit);
        });
        expect_refused("advance, by any_hits", [&] { advance(scene, 0.5); });
    }

    std::vector<Hit> hits(rays.size()), expected(rays.size());
    closest_hits(advance(scene, 0.7), rays, hits);
    Content fresh = make_content("instances-2000");
    closest_hits(advance(fresh.scene, 0.7), rays, expected);
    EXPECT_EQ(hits, expected);
}

// A copy of the tree leads to the same memory: it is watched as the tree is, and refuses rays once the scene was touched.
TEST(RaysOnTheirWay, CopiesOfATreeAreWatchedToo) {
    Content content = make_content("rigid-3");
    Scene& scene = content.scene;
    const Tlas copy = advance(scene, 0.0);
    const std::vector<Ray> rays = rays_at(copy, 10, 10);
    std::vector<Hit> hits(rays.size());
    {
        const RayBatch batch(copy.watch.get());
        EXPECT_THROW(advance(scene, 0.5), std::logic_error);
    }
    EXPECT_NO_THROW(closest_hits(copy, rays, hits));
    scene.touch();
    EXPECT_THROW(closest_hits(copy, rays, hits), std::logic_error);
    EXPECT_NO_THROW(closest_hits(advance(scene, 0.5), rays, hits));
    EXPECT_THROW(closest_hits(copy, rays, hits), std::logic_error);
    const Tlas of_nobody;
    EXPECT_NO_THROW(closest_hits(of_nobody, {}, {}));
}

}  // namespace
}  // namespace zoe
