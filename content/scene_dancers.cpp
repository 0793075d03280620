#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "content/scenes.h"
#include "content/shapes.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

struct Bone {
    const char* name;
    char letter;  // Of its blocks below.
    int parent;
    glm::vec3 place;
    glm::vec3 axis;
    float swing_degrees, lean_degrees;
    float phase;  // In turns; a step is 1 s long.
};

constexpr std::array<Bone, 13> kBones = {{{"hips", 'P', -1, {0, .82f, 0}, {0, 1, 0}, 14, 0, 0},
                                          {"spine", 'S', 0, {0, .94f, 0}, {0, 0, 1}, 8, 0, .25f},
                                          {"chest", 'C', 1, {0, 1.06f, 0}, {0, 1, 0}, 12, 0, .5f},
                                          {"head", 'H', 2, {0, 1.32f, 0}, {0, 0, 1}, 10, 0, .1f},
                                          {"upper arm r", 'a', 2, {-.27f, 1.17f, 0}, {0, 0, 1}, 28, 38, 0},
                                          {"forearm r", 'A', 4, {-.55f, 1.17f, 0}, {0, 1, 0}, 42, 34, .2f},
                                          {"upper arm l", 'b', 2, {.27f, 1.17f, 0}, {0, 0, 1}, 28, -38, 0},
                                          {"forearm l", 'B', 6, {.55f, 1.17f, 0}, {0, 1, 0}, 42, -34, .2f},
                                          {"thigh r", 'T', 0, {-.18f, .7f, 0}, {1, 0, 0}, 26, -6, .5f},
                                          {"shin r", 'K', 8, {-.18f, .36f, 0}, {1, 0, 0}, 22, 24, .75f},
                                          {"thigh l", 'U', 0, {.18f, .7f, 0}, {1, 0, 0}, 26, -6, 0},
                                          {"shin l", 'L', 10, {.18f, .36f, 0}, {1, 0, 0}, 22, 24, .25f},
                                          {"neck", 'N', 2, {0, 1.28f, 0}, {0, 0, 1}, 4, 0, .1f}}};

// A figure of blocks that looks along +Z: rows from the top down, from back to front. Each block follows the bone of its
// letter.
constexpr int kColumns = 7, kRows = 11, kLayers = 3;
constexpr std::array<const char*, kRows> kBlocks[kLayers] = {
    {"..HHH..", "..HHH..", ".......", ".......", ".......", ".......", ".......", ".......", ".......", ".......",
     "......."},
    {"..HHH..", "..HHH..", "...N...", "AaCCCbB", "..CCC..", "..SSS..", "..PPP..", "..T.U..", "..T.U..", "..K.L..",
     "..K.L.."},
    {"..HHH..", "..HHH..", ".......", ".......", ".......", ".......", ".......", ".......", ".......", ".......",
     "..K.L.."}};
// Where one block ends and the next begins, in metres.
constexpr float kX[kColumns + 1] = {-.85f, -.55f, -.29f, -.09f, .09f, .29f, .55f, .85f};
constexpr float kY[kRows + 1] = {1.86f, 1.6f, 1.36f, 1.28f, 1.06f, .94f, .82f, .7f, .52f, .36f, .12f, 0.0f};
constexpr float kZ[kLayers + 1] = {-.25f, -.13f, .13f, .34f};
constexpr float kCap = kY[0], kBelt = kY[6], kSole = kY[kRows], kHand = kX[kColumns];
constexpr float kFlare = 1.3f;  // Of the shirt's hem.

using Cell = std::array<int, 3>;  // Column, row, layer.

int bone_of(const Cell& cell) {
    const auto [x, y, z] = cell;
    if (x < 0 || y < 0 || z < 0 || x >= kColumns || y >= kRows || z >= kLayers) return -1;
    const char letter = kBlocks[z][y][x];
    const auto found = std::find_if(kBones.begin(), kBones.end(), [&](const Bone& b) { return b.letter == letter; });
    return found == kBones.end() ? -1 : static_cast<int>(found - kBones.begin());
}

/// What is worn where: skin, shirt, trousers.
int material_of(int bone) {
    const char letter = kBones[static_cast<size_t>(bone)].letter;
    if (std::string("HNAB").find(letter) != std::string::npos) return 0;
    return std::string("SCab").find(letter) != std::string::npos ? 1 : 2;
}

/// The figure's outside: a face wherever a block has no neighbour.
class FigureBuilder {
public:
    Mesh make(std::span<const MaterialId> materials) {
        std::vector<MaterialRange> ranges;
        for (int material = 0; material < static_cast<int>(materials.size()); ++material) {
            const uint32_t begin = 2 * static_cast<uint32_t>(surface_.cage.face_sizes.size());
            for_each_cell([&](const Cell& cell, int bone) {
                if (material_of(bone) == material) add_faces(cell);
            });
            ranges.push_back({begin, 2 * static_cast<uint32_t>(surface_.cage.face_sizes.size()), materials[material]});
        }
        crease();
        bind();
        Mesh mesh = make_surface(std::move(positions_), std::move(surface_));
        mesh.materials = std::move(ranges);
        mesh.binding = std::move(binding_);
        return mesh;
    }

private:
    template <typename Body>
    static void for_each_cell(Body&& body) {
        for (int z = 0; z < kLayers; ++z) {
            for (int y = 0; y < kRows; ++y) {
                for (int x = 0; x < kColumns; ++x) {
                    if (const int bone = bone_of({x, y, z}); bone >= 0) body({x, y, z}, bone);
                }
            }
        }
    }

    uint32_t vertex(const Cell& point) {
        const auto [found, is_new] = vertices_.try_emplace(point, static_cast<uint32_t>(positions_.size()));
        if (is_new) {
            const float flare = kY[point[1]] == kBelt ? kFlare : 1.0f;
            positions_.push_back({flare * kX[point[0]], kY[point[1]], flare * kZ[point[2]]});
        }
        return found->second;
    }

    void add_faces(const Cell& cell) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) {
                Cell next = cell;
                next[axis] += side == 0 ? -1 : 1;
                if (bone_of(next) >= 0) continue;
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                Cell corner = cell;
                corner[axis] += side;
                // Rows count downwards: what is counter-clockwise in cells is clockwise in space.
                constexpr int kTurn[4][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
                for (int k = 0; k < 4; ++k) {
                    const int* step = kTurn[side == 1 ? k : 3 - k];
                    Cell at = corner;
                    at[u] += step[0];
                    at[v] += step[1];
                    surface_.cage.vertices.push_back(vertex(at));
                }
                surface_.cage.face_sizes.push_back(4);
            }
        }
    }

    /// Sharpens the rims of what lies in a plane, where it meets something else.
    void crease() {
        const Cage& cage = surface_.cage;
        std::map<std::array<uint32_t, 2>, float> creases;
        const auto look = [&](int axis, float place, float sharpness, size_t face) {
            const uint32_t* corners = &cage.vertices[4 * face];
            const auto is_in = [&](int k) { return positions_[corners[k % 4]][axis] == place; };
            if (is_in(0) && is_in(1) && is_in(2)) return;
            for (int k = 0; k < 4; ++k) {
                const uint32_t a = corners[k], b = corners[(k + 1) % 4];
                if (is_in(k) && is_in(k + 1)) creases[{std::min(a, b), std::max(a, b)}] = sharpness;
            }
        };
        for (size_t face = 0; face < cage.face_sizes.size(); ++face) {
            look(1, kCap, 1.4f, face);
            look(1, kBelt, 3.0f, face);
            look(1, kSole, 10.0f, face);
            look(0, kHand, 0.7f, face);
            look(0, -kHand, 0.7f, face);
        }
        for (const auto& [edge, sharpness] : creases) {
            surface_.cage.crease_edges.push_back(edge);
            surface_.cage.crease_sharpness.push_back(sharpness);
        }
    }

    /// A vertex follows the bones of the blocks around it, each as much as it has blocks there.
    void bind() {
        binding_.influence_count = 4;
        binding_.joints.resize(4 * positions_.size());
        binding_.weights.resize(4 * positions_.size());
        for (const auto& [point, vertex] : vertices_) {
            std::map<int, int> counts;
            for (int k = 0; k < 8; ++k) {
                const int bone = bone_of({point[0] - (k & 1), point[1] - (k >> 1 & 1), point[2] - (k >> 2)});
                if (bone >= 0) ++counts[bone];
            }
            int sum = 0, at = 0;
            for (const auto& [bone, count] : counts) sum += count;
            for (const auto& [bone, count] : counts) {
                binding_.joints[4 * vertex + at] = static_cast<uint16_t>(bone);
                binding_.weights[4 * vertex + at] = static_cast<float>(count) / static_cast<float>(sum);
                ++at;
            }
        }
    }

    std::map<Cell, uint32_t> vertices_;
    std::vector<glm::vec3> positions_;
    SubdivisionSurface surface_;
    SkinBinding binding_;
};

Sampler swing_of(const Bone& bone, float figure_phase) {
    Sampler sampler{.is_rotation = true, .width = 4};
    for (int k = 0; k <= 48; ++k) {
        const float share = static_cast<float>(k) / 48.0f;
        const float wave = std::sin(2.0f * kPi * (4.0f * share + bone.phase + figure_phase));
        const float half = 0.5f * glm::radians(bone.lean_degrees + bone.swing_degrees * wave);
        const glm::vec3 v = std::sin(half) * bone.axis;
        sampler.times_s.push_back(static_cast<float>(kLoop_s) * share);
        sampler.values.insert(sampler.values.end(), {v.x, v.y, v.z, std::cos(half)});
    }
    return sampler;
}

constexpr float kApart = 1.9f;    // Metres from dancer to dancer.
constexpr float kFloor = -0.13f;  // As deep as toes reach.

// A floor under all of them, and a wall behind.
void add_stage(Scene& scene, int row_count) {
    const float half = 12.0f, front = 8.0f, back = -kApart * static_cast<float>(row_count - 1) - 1.2f;
    Mesh mesh;
    mesh.name = "stage";
    append(mesh, make_box({-half, kFloor - 0.1f, back}, {half, kFloor, front}), {}, add_color(scene, "floor", 0xa89a86));
    append(mesh, make_box({-half, kFloor - 0.1f, back - 0.1f}, {half, 6.0f, back}), {}, add_color(scene, "wall", 0xd8d0c0));
    Node node;
    node.name = mesh.name;
    node.mesh = scene.add(std::move(mesh));
    scene.add(std::move(node));
}

// Dancer i: joints, a skin and a node, all of its own.
void add_dancer(Scene& scene, MeshId mesh, int i, const glm::vec3& place) {
    Skin skin;
    skin.name = "dancer " + std::to_string(i);
    for (const Bone& bone : kBones) {
        const bool is_root = bone.parent < 0;
        Node joint;
        joint.name = bone.name;
        joint.parent = is_root ? kNone<NodeId> : skin.joints[static_cast<size_t>(bone.parent)];
        joint.local.translation = bone.place + (is_root ? place : -kBones[static_cast<size_t>(bone.parent)].place);
        const NodeId id = scene.add(std::move(joint));
        skin.joints.push_back(id);
        skin.joint_from_mesh.push_back(at(-bone.place));
        add_channel(scene, id, ChannelPath::kRotation,
                    add_sampler(scene, swing_of(bone, 0.381966f * static_cast<float>(i))));
    }
    Node node;
    node.name = skin.name;
    node.mesh = mesh;
    node.skin = SkinId{static_cast<uint32_t>(scene.skins.size())};
    scene.skins.push_back(std::move(skin));
    scene.add(std::move(node));
}

}  // namespace

// Dancers side by side, in rows of eight. All show one cage; each has its own phase.
Content make_dancers_scene(int size) {
    constexpr int kInRow = 8;
    Content content;
    Scene& scene = content.scene;
    const MaterialId materials[] = {add_color(scene, "skin", 0xdfb49b), add_color(scene, "shirt", 0x6f9fb0),
                                    add_color(scene, "trousers", 0x8a7a68)};
    Mesh cage = FigureBuilder().make(materials);
    cage.name = "dancer";
    const MeshId mesh = scene.add(std::move(cage));
    const float last_column = static_cast<float>(std::min(size, kInRow) - 1);
    for (int i = 0; i < size; ++i) {
        const float column = static_cast<float>(i % kInRow) - 0.5f * last_column, row = static_cast<float>(i / kInRow);
        add_dancer(scene, mesh, i, kApart * glm::vec3(column, 0, -row));
    }
    add_stage(scene, (size + kInRow - 1) / kInRow);
    const float away = 4.4f + 0.5f * kApart * last_column;
    add_view(scene, {0.3f * away, 0.7f + 0.15f * away, away}, {0.0f, 0.86f, 0.0f}, 30.0f);
    return content;
}

}  // namespace zoe
