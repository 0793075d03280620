// Nodes that show subdivision surfaces: skinned, morphed, rigid, still, and written each frame.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "content/shapes.h"
#include "engine/frame/classify.h"
#include "engine/frame/refine.h"
#include "engine/math/parallel.h"
#include "tests/deform/subdivide_oracle.h"
#include "tests/frame/motion_class.h"
#include "tests/support/allocation_count.h"

namespace zoe::test {
namespace {

enum : uint32_t { kRig, kLow, kHigh, kSkinned, kTurning, kStill, kWritten, kNodeCount };

constexpr int kLevel = 2;
const glm::vec3 kRigPlace{1.5f, -0.5f, 0.5f}, kElbow{0.0f, 1.5f, 0.0f};
const glm::vec3 kTurningPlace{-2.5f, 0.5f, 0.0f}, kStillPlace{-2.5f, 3.5f, 0.5f}, kWrittenPlace{4.5f, 0.0f, 0.0f};
const glm::vec3 kAxis{0.6f, 0.0f, 0.8f};

// A column of three cubes, with a crease around its top that fades after one level.
PolygonMesh column() {
    PolygonMesh mesh;
    for (int y = 0; y < 4; ++y) {
        mesh.points.insert(mesh.points.end(), {{-0.5, y, 0.5}, {0.5, y, 0.5}, {0.5, y, -0.5}, {-0.5, y, -0.5}});
    }
    mesh.faces = {{3, 2, 1, 0}, {12, 13, 14, 15}};
    for (uint32_t y = 0; y < 3; ++y) {
        for (uint32_t k = 0; k < 4; ++k) {
            const uint32_t a = 4 * y + k, b = 4 * y + (k + 1) % 4;
            mesh.faces.push_back({a, b, b + 4, a + 4});
        }
    }
    for (uint32_t k = 0; k < 4; ++k) mesh.creases[edge_of(12 + k, 12 + (k + 1) % 4)] = 1.5;
    return mesh;
}

// A cube with a sharp corner and a crease that never fades.
PolygonMesh block() {
    PolygonMesh mesh = cube();
    mesh.creases[{0, 1}] = 10.0;
    mesh.creases[{1, 3}] = 10.0;
    mesh.corners[6] = 10.0;
    return mesh;
}

Mesh surface_mesh(const PolygonMesh& mesh) {
    return make_surface(mesh.positions(),
                        {.cage = mesh.cage(), .options = {.level = kLevel, .limit_positions = false, .normals = true}});
}

double high_weight(const glm::dvec3& p) {
    return std::clamp(0.5 * p.y - 0.25, 0.0, 1.0);
}
glm::dvec3 offset(const glm::dvec3& p) {
    return {0.25 * p.y, 0.0, 0.5 * p.x};
}
// Where a vertex of the written cage is.
glm::vec3 written_at(const glm::dvec3& p, double time_s) {
    return glm::vec3(p) * (1.0f + 0.25f * std::sin(static_cast<float>(2.0 * time_s + 3.0 * p.x * p.y + p.z)));
}

Node shown(MeshId mesh, const glm::vec3& place) {
    Node node;
    node.mesh = mesh;
    node.local.translation = place;
    return node;
}

Mesh skinned_mesh() {
    const PolygonMesh rest = column();
    Mesh mesh = surface_mesh(rest);
    mesh.binding.influence_count = 4;
    mesh.targets.resize(1);
    mesh.default_weights = {0};
    for (const glm::dvec3& p : rest.points) {
        const float high = static_cast<float>(high_weight(p));
        mesh.binding.joints.insert(mesh.binding.joints.end(), {0, 1, 0, 0});
        mesh.binding.weights.insert(mesh.binding.weights.end(), {1 - high, high, 0, 0});
        mesh.targets[0].positions.push_back(glm::vec3(offset(p)));
    }
    return mesh;
}

Content make() {
    Content content;
    Scene& scene = content.scene;
    const MeshId skinned = scene.add(skinned_mesh());
    const MeshId shared = scene.add(surface_mesh(block())), written = scene.add(surface_mesh(block()));
    scene.nodes.resize(kNodeCount);
    scene.nodes[kRig].local.translation = kRigPlace;
    scene.nodes[kLow].parent = NodeId{kRig};
    scene.nodes[kHigh].parent = NodeId{kLow};
    scene.nodes[kHigh].local.translation = kElbow;
    scene.nodes[kSkinned] = shown(skinned, {50, 0, 0});
    scene.nodes[kSkinned].skin = SkinId{0};
    scene.nodes[kTurning] = shown(shared, kTurningPlace);
    scene.nodes[kStill] = shown(shared, kStillPlace);
    scene.nodes[kWritten] = shown(written, kWrittenPlace);
    scene.skins.push_back({"arm", {NodeId{kLow}, NodeId{kHigh}}, {Affine{}, at(-kElbow)}});

    Clip clip;
    clip.duration_s = 4.0;
    const float h = std::sqrt(0.5f);
    const Sampler half_turn{
        .is_rotation = true, .width = 4, .times_s = {0, 2, 4}, .values = {0, 0, 0, 1, 0, 0, h, h, 0, 0, 0, 1}};
    const Sampler weight{.width = 1, .times_s = {0, 1, 4}, .values = {0, 1, 0}};
    const Sampler turning{.is_rotation = true,
                          .width = 4,
                          .times_s = {0, 4},
                          .values = {0, 0, 0, 1, h * kAxis.x, h * kAxis.y, h * kAxis.z, h}};
    clip.samplers = {half_turn, weight, turning};
    clip.channels = {{NodeId{kHigh}, ChannelPath::kRotation, 0},
                     {NodeId{kSkinned}, ChannelPath::kWeights, 1},
                     {NodeId{kTurning}, ChannelPath::kRotation, 2}};
    scene.clips.push_back(clip);
    scene.playback.clips = {ClipId{0}};
    content.write = [written](Scene& to, double time_s) {
        std::vector<glm::vec3> positions;
        for (const glm::dvec3& p : block().points) positions.push_back(written_at(p, time_s));
        to.write_cage(written, positions);
    };
    return content;
}

// The engine's triangles over points that the textbook's rules make of a posed cage. Which point is which vertex is told by
// the cage at rest, where no two are in the same place.
class Truth {
public:
    explicit Truth(const PolygonMesh& rest) : rest_(rest) {
        const Mesh mesh = surface_mesh(rest);
        const Refined refined = make_refined(mesh, kLevel);
        corners_ = refined.mesh.corners;
        const PolygonMesh points = refine(rest);
        for (const glm::vec3& p : refined.mesh.positions) {
            const auto distance = [&](const glm::dvec3& q) { return glm::length(q - glm::dvec3(p)); };
            const auto nearest = std::min_element(points.points.begin(), points.points.end(),
                                                  [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
            EXPECT_LT(distance(*nearest), 1e-5);
            point_of_.push_back(static_cast<size_t>(nearest - points.points.begin()));
        }
    }

    // cage       [vertex_count] of the posed cage.
    void add(std::vector<glm::dvec3> cage, uint32_t node, std::initializer_list<AffineDouble> above,
             std::vector<WorldTriangle>* triangles) const {
        PolygonMesh posed = rest_;
        posed.points = std::move(cage);
        posed = refine(posed);
        std::vector<glm::dvec3> vertices;
        for (const size_t k : point_of_) vertices.push_back(posed.points[k]);
        add_triangles(vertices, corners_, node, above, triangles);
    }

private:
    static PolygonMesh refine(PolygonMesh mesh) {
        for (int k = 0; k < kLevel; ++k) mesh = mesh.catmull_clark();
        return mesh;
    }
    PolygonMesh rest_;
    std::vector<glm::uvec3> corners_;
    std::vector<size_t> point_of_;
};

double turned_degrees(double t) {
    return t < 2 ? 45.0 * t : 45.0 * (4.0 - t);
}

std::vector<WorldTriangle> truth(double time_s) {
    static const Truth kColumn(column()), kBlock(block());
    const double t = std::fmod(time_s, 4.0);
    std::vector<WorldTriangle> triangles;
    const auto moved = [](const glm::vec3& place) { return from_trs(glm::dvec3(place), {}, {1, 1, 1}); };

    const double weight = t < 1 ? t : (4 - t) / 3;
    const AffineDouble bend = from_trs({}, turn({0, 0, 1}, turned_degrees(t)), {1, 1, 1});
    std::vector<glm::dvec3> posed;
    for (const glm::dvec3& p : column().points) {
        const glm::dvec3 point = p + weight * offset(p), elbow(kElbow);
        const double high = high_weight(p);
        posed.push_back((1 - high) * point + high * (elbow + bend.vector(point - elbow)));
    }
    kColumn.add(posed, kSkinned, {moved(kRigPlace)}, &triangles);

    const glm::dvec3 axis = glm::normalize(glm::dvec3(kAxis));
    const PolygonMesh rest = block();
    kBlock.add(rest.points, kTurning, {from_trs(glm::dvec3(kTurningPlace), turn(axis, 22.5 * t), {1, 1, 1})}, &triangles);
    kBlock.add(rest.points, kStill, {moved(kStillPlace)}, &triangles);
    std::vector<glm::dvec3> written;
    for (const glm::dvec3& p : rest.points) written.push_back(glm::dvec3(written_at(p, time_s)));
    kBlock.add(written, kWritten, {moved(kWrittenPlace)}, &triangles);
    return triangles;
}

TEST(Subdivision, AnswersAsEveryMotionClassDoes) {
    expect_all({make, truth, {0.0, 0.3, 1.0, 1.7, 2.0, 2.9, 3.6, 4.0}}, 6100);
}

TEST(Subdivision, ClassesFollowFromWhatMovesTheCage) {
    Content content = make();
    advance(content.scene, 0.0);
    EXPECT_EQ(motion(content.scene, NodeId{kSkinned}), Motion::kDeforming);
    EXPECT_EQ(motion(content.scene, NodeId{kTurning}), Motion::kRigid);
    EXPECT_EQ(motion(content.scene, NodeId{kStill}), Motion::kStatic);
    EXPECT_EQ(motion(content.scene, NodeId{kWritten}), Motion::kStatic) << "before the first write";
    content.write(content.scene, 0.0);
    advance(content.scene, 0.0);
    EXPECT_EQ(motion(content.scene, NodeId{kWritten}), Motion::kDeforming);
}

TEST(Subdivision, OnlyCagesThatMovedAreEvaluated) {
    Content content = make();
    content.scene.rebuild.frame_rays = 0.0;  // Trees are refitted only.
    const auto stats_at = [&](double time_s, bool is_written) {
        FrameStats stats;
        if (is_written) content.write(content.scene, time_s);
        advance(content.scene, time_s, &stats);
        return stats;
    };
    const FrameStats first = stats_at(0.0, true);
    EXPECT_EQ(first.subdivided, 3u) << "two nodes share one";
    EXPECT_EQ(first.refined, 2u) << "what stands still was evaluated when it was refined";
    const FrameStats held = stats_at(0.0, false);
    EXPECT_EQ(held.subdivided + held.refined + held.refitted + held.rebuilt, 0u);
    const FrameStats played = stats_at(1.0, false);
    EXPECT_EQ(played.subdivided, 0u);
    EXPECT_EQ(played.refined, 1u);
    EXPECT_EQ(played.refitted, 1u);
    const FrameStats written = stats_at(1.0, true);
    EXPECT_EQ(written.refined, 1u);
    EXPECT_EQ(written.refitted, 1u);
    EXPECT_EQ(written.kept, 3u);
}

TEST(Subdivision, AllocatesNothingOnceItsSurfacesAreRefined) {
    set_thread_count(1);  // With more, the scheduler allocates its own tasks.
    Content content = make();
    const MeshId mesh = content.scene.nodes[kWritten].mesh;
    size_t count = 0;
    for (int frame = 0; frame < 16; ++frame) {
        std::vector<glm::vec3> positions;
        for (const glm::dvec3& p : block().points) positions.push_back(written_at(p, 0.25 * (frame % 8)));
        const size_t before = allocation_count();
        content.scene.write_cage(mesh, positions);
        advance(content.scene, 0.25 * (frame % 8));
        if (frame >= 8) count += allocation_count() - before;
    }
    EXPECT_EQ(count, 0u);
    set_thread_count(0);
}

TEST(Subdivision, FacesKeepTheirMaterialsAndUvsTheirSeams) {
    const PolygonMesh mesh = column();
    SubdivisionSurface surface{.cage = mesh.cage(), .options = {.level = kLevel}};
    for (uint32_t k = 0; k < surface.cage.vertices.size(); ++k) {  // Every face is an island.
        surface.cage.uvs[0].corners.push_back(k);
        surface.cage.uvs[0].values.push_back({static_cast<float>(k), 0.0f});
    }
    Mesh made = make_surface(mesh.positions(), std::move(surface));
    made.materials = {{0, 4, MaterialId{2}}, {4, 4, MaterialId{0}}, {4, 28, MaterialId{1}}};
    const Refined refined = make_refined(made, kLevel);
    ASSERT_EQ(refined.mesh.corners.size(), 14u * 32);
    ASSERT_EQ(refined.mesh.materials.size(), 3u);
    EXPECT_EQ(refined.mesh.materials[0].end, 64u);
    EXPECT_EQ(refined.mesh.materials[1].begin, 64u);
    EXPECT_EQ(refined.mesh.materials[1].end, 64u);
    EXPECT_EQ(refined.mesh.materials[2].end, refined.mesh.corners.size());
    for (uint32_t triangle = 0; triangle < refined.mesh.corners.size(); ++triangle) {
        const float face = static_cast<float>(4 * (triangle / 32));
        for (int k = 0; k < 3; ++k) {
            const glm::vec2 uv = refined.mesh.uvs[0][refined.mesh.corners[triangle][k]];
            EXPECT_TRUE(uv.x >= face - 0.001f && uv.x <= face + 3.001f) << triangle;
        }
    }
}

}  // namespace
}  // namespace zoe::test
