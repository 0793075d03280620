#pragma once

#include <functional>
#include <initializer_list>
#include <span>
#include <vector>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/frame/trace.h"
#include "tests/support/affine_double.h"
#include "tests/support/brute_force.h"

/// What the tests of every motion class ask (DESIGN.md, section 7), of scenes whose triangles the test works out by hand.
namespace zoe::test {

/// A scene made in code, and where its triangles are.
struct Case {
    std::function<Content()> make;
    /// Every triangle that a frame shows, in double.
    std::function<std::vector<WorldTriangle>(double time_s)> truth;
    std::vector<double> times_s;  ///< Eight of them.
};

/// Adds a mesh's triangles.
/// local      [vertex_count] positions of this frame, in the node's space.
/// above      the maps from the root down to the node.
void add_triangles(std::span<const glm::dvec3> local, std::span<const glm::uvec3> corners, uint32_t node,
                   std::initializer_list<AffineDouble> above, std::vector<WorldTriangle>* triangles);
std::vector<glm::dvec3> to_double(std::span<const glm::vec3> positions);
/// A turn about an axis of length 1, counter-clockwise seen from its tip.
Quaternion turn(const glm::dvec3& axis, double degrees);

/// The frame at a time, meshes written before.
const Tlas& play(Content& content, double time_s, FrameStats* stats = nullptr);
/// Closest hits of rays through one frame.
std::vector<Hit> hits_at(Content& content, double time_s, std::span<const OracleRay> rays);

/// Closest and any hits equal the oracle's at every time; batches give the same; any hit agrees with closest hit, at the
/// hit and just before it.
void expect_hits_equal_the_oracle(const Case& scene, uint64_t seed);
/// Every vertex that a triangle uses is in its instance's box in the world, and every BLAS and the TLAS are valid.
void expect_boxes_contain_every_vertex(const Case& scene);
/// Jumping to a time gives the hits that playing up to it gives, bit for bit.
void expect_jump_equals_play(const Case& scene, uint64_t seed);
/// 1 and 3 threads give the same hits, bit for bit.
void expect_threads_do_not_matter(const Case& scene, uint64_t seed);
/// Any node in any more general class gives the same hits, bit for bit; a less general class is refused.
void expect_more_general_classes_change_nothing(const Case& scene, uint64_t seed);
/// Nodes in the opposite order give the same hits, bit for bit, under their new ids.
void expect_order_of_nodes_permutes_the_answer(const Case& scene, uint64_t seed);
/// All of the above.
void expect_all(const Case& scene, uint64_t seed);

}  // namespace zoe::test
