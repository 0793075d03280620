#include "tests/frame/motion_class.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/frame/classify.h"
#include "engine/math/parallel.h"
#include "tests/support/compare.h"
#include "tests/support/rays.h"

namespace zoe::test {
namespace {

constexpr size_t kRayCount = 400;

// The rays of a case: around what it shows over all its times.
std::vector<OracleRay> rays_of(const Case& scene, uint64_t seed) {
    std::vector<OracleRay> rays;
    for (const double time_s : scene.times_s) {
        const std::vector<OracleRay> more = rays_around(scene.truth(time_s), kRayCount / 4, seed++);
        rays.insert(rays.end(), more.begin(), more.end());
    }
    return rays;
}

void expect_same(std::span<const Hit> hits, std::span<const Hit> expected, const std::string& what) {
    ASSERT_EQ(hits.size(), expected.size()) << what;
    size_t difference_count = 0, first = 0;
    for (size_t i = 0; i < hits.size(); ++i) {
        if (hits[i] == expected[i]) continue;
        if (difference_count++ == 0) first = i;
    }
    EXPECT_EQ(difference_count, 0u) << what
                                    << fmt::format(
                                           ": first is ray {}: t {:.9g} node {} primitive {} is not t {:.9g} node {} "
                                           "primitive {}",
                                           first, hits[first].t, index(hits[first].node), hits[first].primitive,
                                           expected[first].t, index(expected[first].node), expected[first].primitive);
}

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool shows_mesh(const Node& node) {
    return node.mesh != kNone<MeshId> || node.sequence.has_value();
}

}  // namespace

void add_triangles(std::span<const glm::dvec3> local, std::span<const glm::uvec3> corners, uint32_t node,
                   std::initializer_list<AffineDouble> above, std::vector<WorldTriangle>* triangles) {
    AffineDouble world;
    for (const AffineDouble& map : above) world = world * map;
    const auto magnitude = [&](const glm::dvec3& p) {
        double sum = glm::length(p);
        for (auto map = above.end(); map != above.begin();) {
            --map;
            sum = map->stretch() * sum + glm::length(map->t);
        }
        return sum;
    };
    for (uint32_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 &a = local[corners[i].x], &b = local[corners[i].y], &c = local[corners[i].z];
        triangles->push_back(
            {world.point(a), world.point(b), world.point(c), node, i, std::max({magnitude(a), magnitude(b), magnitude(c)})});
    }
}

std::vector<glm::dvec3> to_double(std::span<const glm::vec3> positions) {
    return {positions.begin(), positions.end()};
}

Quaternion turn(const glm::dvec3& axis, double degrees) {
    const double half = degrees * M_PI / 360.0;
    return {std::sin(half) * axis.x, std::sin(half) * axis.y, std::sin(half) * axis.z, std::cos(half)};
}

const Tlas& play(Content& content, double time_s, FrameStats* stats) {
    if (content.write) content.write(content.scene, time_s);
    return advance(content.scene, time_s, stats);
}

std::vector<Hit> hits_at(Content& content, double time_s, std::span<const OracleRay> rays) {
    const Tlas& tlas = play(content, time_s);
    std::vector<Hit> hits;
    for (const OracleRay& ray : rays) hits.push_back(closest_hit(tlas, engine_ray(ray)));
    return hits;
}

void expect_hits_equal_the_oracle(const Case& scene, uint64_t seed) {
    ASSERT_EQ(scene.times_s.size(), 8u);
    Content content = scene.make();
    for (const double time_s : scene.times_s) {
        SCOPED_TRACE(fmt::format("time {} s, seed {}", time_s, seed));
        uint32_t& exact_up_to = content.scene.tlas_build.exact_up_to;
        exact_up_to = exact_up_to == 0 ? ~0u : 0;  // The fast form of the top level, then the exact one, and so on.
        const BruteForce truth(scene.truth(time_s));
        const std::vector<OracleRay> rays = rays_around(truth.triangles(), kRayCount, seed++);
        const Tlas& tlas = play(content, time_s);
        std::vector<Ray> batch;
        for (const OracleRay& ray : rays) batch.push_back(engine_ray(ray));
        std::vector<Hit> hits(rays.size());
        std::vector<uint8_t> is_hit(rays.size());
        closest_hits(tlas, batch, hits);
        any_hits(tlas, batch, is_hit);

        Agreement closest, any;
        for (size_t i = 0; i < rays.size(); ++i) {
            const Hit hit = closest_hit(tlas, batch[i]);
            EXPECT_EQ(hit, hits[i]) << "ray " << i << " alone and in a batch";
            EXPECT_EQ(any_hit(tlas, batch[i]), is_hit[i] != 0) << "ray " << i << " alone and in a batch";
            EXPECT_EQ(static_cast<bool>(hit), is_hit[i] != 0) << "ray " << i << ": closest and any hit disagree";
            compare_closest(truth, rays[i], hit, &closest);
            compare_any(truth, rays[i], is_hit[i] != 0, &any);
            if (!hit || !(hit.t > batch[i].t_min)) continue;
            Ray before = batch[i];
            before.t_max = std::nextafter(hit.t, 0.0f);
            EXPECT_FALSE(any_hit(tlas, before)) << "ray " << i << ": something before its closest hit";
            before.t_max = hit.t;
            EXPECT_TRUE(any_hit(tlas, before)) << "ray " << i << ": nothing up to its closest hit";
        }
        EXPECT_TRUE(closest.verdict());
        EXPECT_TRUE(any.verdict());
        EXPECT_GT(closest.hit_count, kRayCount / 8) << "too few hits to tell anything";
    }
}

void expect_boxes_contain_every_vertex(const Case& scene) {
    Content content = scene.make();
    for (const double time_s : scene.times_s) {
        SCOPED_TRACE(fmt::format("time {} s", time_s));
        const Tlas& tlas = play(content, time_s);
        std::vector<Aabb> boxes(tlas.instances.size());
        for (size_t k = 0; k < tlas.parts.size(); ++k) boxes[tlas.parts[k].instance].extend(tlas.boxes[k]);
        for (size_t k = 0; k < tlas.instances.size(); ++k) {
            const Instance& instance = tlas.instances[k];
            SCOPED_TRACE(fmt::format("node {}", index(instance.node)));
            EXPECT_TRUE(instance.bounds_world.contains(boxes[k]));
            size_t outside_count = 0;
            const glm::dmat3 linear(instance.world_from_local.linear);
            const glm::dvec3 translation(instance.world_from_local.translation);
            for (const glm::uvec3& c : instance.mesh->corners) {
                const glm::vec3 p[] = {instance.positions[c.x], instance.positions[c.y], instance.positions[c.z]};
                const bool is_bounded = is_finite(p[0]) && is_finite(p[1]) && is_finite(p[2]);
                for (const glm::vec3& corner : p) {
                    if (!is_bounded) continue;
                    const glm::dvec3 world = linear * glm::dvec3(corner) + translation;
                    const glm::dvec3 lo(boxes[k].lo), hi(boxes[k].hi);
                    for (int axis = 0; axis < 3; ++axis) {
                        if (!(lo[axis] <= world[axis] && world[axis] <= hi[axis])) ++outside_count;
                    }
                }
            }
            EXPECT_EQ(outside_count, 0u) << "coordinates outside the boxes in the tree";
            EXPECT_EQ(validate(*instance.blas, instance.positions, instance.mesh->corners), "");
            EXPECT_EQ(tlas.instance_of_node[index(instance.node)], k);
        }
        EXPECT_EQ(validate(tlas.bvh, tlas.boxes), "");
        EXPECT_EQ(validate(tlas.tree, tlas.placed.size()), "");
    }
}

void expect_jump_equals_play(const Case& scene, uint64_t seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const std::vector<OracleRay> rays = rays_of(scene, seed);
    Content played = scene.make(), scrubbed = scene.make();
    std::vector<std::vector<Hit>> expected;
    for (const double time_s : scene.times_s) {
        Content jumped = scene.make();
        expected.push_back(hits_at(jumped, time_s, rays));
        expect_same(hits_at(played, time_s, rays), expected.back(), fmt::format("played to {} s", time_s));
    }
    for (size_t i = scene.times_s.size(); i-- > 0;) {
        expect_same(hits_at(scrubbed, scene.times_s[i], rays), expected[i], fmt::format("back to {} s", scene.times_s[i]));
    }
}

void expect_threads_do_not_matter(const Case& scene, uint64_t seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const std::vector<OracleRay> rays = rays_of(scene, seed);
    set_thread_count(1);
    Content one = scene.make(), many = scene.make();
    std::vector<std::vector<Hit>> expected;
    for (const double time_s : scene.times_s) expected.push_back(hits_at(one, time_s, rays));
    set_thread_count(3);
    for (size_t i = 0; i < scene.times_s.size(); ++i) {
        expect_same(hits_at(many, scene.times_s[i], rays), expected[i], fmt::format("3 threads at {} s", scene.times_s[i]));
    }
    set_thread_count(0);
}

void expect_more_general_classes_change_nothing(const Case& scene, uint64_t seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const std::vector<OracleRay> rays = rays_of(scene, seed);
    Content plain = scene.make();
    std::vector<std::vector<Hit>> expected;
    for (const double time_s : scene.times_s) expected.push_back(hits_at(plain, time_s, rays));
    for (uint32_t k = 0; k < plain.scene.nodes.size(); ++k) {
        if (!shows_mesh(plain.scene.nodes[k])) continue;
        const NodeId node{k};
        const Motion own = motion(plain.scene, node);
        for (int m = 0; m < kMotionCount; ++m) {
            const Motion forced = static_cast<Motion>(m);
            Content content = scene.make();
            play(content, scene.times_s[0]);  // What is written decides the class, too.
            if (forced < own) {
                EXPECT_THROW(set_motion(content.scene, node, forced), SceneError) << "node " << k << " as " << name(forced);
                continue;
            }
            set_motion(content.scene, node, forced);
            for (size_t i = 0; i < scene.times_s.size(); ++i) {
                expect_same(hits_at(content, scene.times_s[i], rays), expected[i],
                            fmt::format("node {} as {} at {} s", k, name(forced), scene.times_s[i]));
            }
            EXPECT_EQ(motion(content.scene, node), forced);
        }
    }
}

void expect_order_of_nodes_permutes_the_answer(const Case& scene, uint64_t seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const std::vector<OracleRay> rays = rays_of(scene, seed);
    Content plain = scene.make(), turned = scene.make();
    const auto count = static_cast<uint32_t>(plain.scene.nodes.size());
    const auto opposite = [&](NodeId node) { return node == kNone<NodeId> ? node : NodeId{count - 1 - index(node)}; };
    std::reverse(turned.scene.nodes.begin(), turned.scene.nodes.end());
    for (Node& node : turned.scene.nodes) node.parent = opposite(node.parent);
    for (Clip& clip : turned.scene.clips) {
        for (AnimationChannel& channel : clip.channels) channel.node = opposite(channel.node);
    }
    for (Skin& skin : turned.scene.skins) {
        for (NodeId& joint : skin.joints) joint = opposite(joint);
    }
    for (const double time_s : scene.times_s) {
        std::vector<Hit> expected = hits_at(plain, time_s, rays);
        for (Hit& hit : expected) hit.node = opposite(hit.node);
        expect_same(hits_at(turned, time_s, rays), expected, fmt::format("at {} s", time_s));
    }
}

void expect_all(const Case& scene, uint64_t seed) {
    expect_hits_equal_the_oracle(scene, seed);
    expect_boxes_contain_every_vertex(scene);
    expect_jump_equals_play(scene, seed + 100);
    expect_threads_do_not_matter(scene, seed + 200);
    expect_more_general_classes_change_nothing(scene, seed + 300);
    expect_order_of_nodes_permutes_the_answer(scene, seed + 400);
}

}  // namespace zoe::test
