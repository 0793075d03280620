#include <cmath>
#include <functional>
#include <numbers>

#include <glm/geometric.hpp>

#include "content/make_default_parts.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// The difference to another pose of the same mesh.
MorphTarget target_of(const Mesh& rest, const Mesh& pose) {
    MorphTarget target;
    for (size_t v = 0; v < rest.positions.size(); ++v) {
        target.positions.push_back(pose.positions[v] - rest.positions[v]);
        target.normals.push_back(pose.normals[v] - rest.normals[v]);
    }
    return target;
}

// Weights as a function of the clip's share, as a cubic spline with its own slopes.
Sampler weight_spline(uint32_t target_count, int key_count, const std::function<float(uint32_t, float)>& weight) {
    Sampler sampler{.interpolation = Interpolation::kCubicSpline, .width = target_count};
    for (int k = 0; k <= key_count; ++k) {
        const float share = static_cast<float>(k) / static_cast<float>(key_count), h = 0.001f;
        sampler.times_s.push_back(GlbWriter::kDuration_s * share);
        for (int part = 0; part < 3; ++part) {
            for (uint32_t t = 0; t < target_count; ++t) {
                const float slope = (weight(t, share + h) - weight(t, share - h)) / (2.0f * h * GlbWriter::kDuration_s);
                sampler.values.push_back(part == 1 ? weight(t, share) : slope);
            }
        }
    }
    return sampler;
}

// A petal from the origin: a strip that leaves the axis +Y by `angle`, towards +X, and curls on.
Mesh make_petal(float length, float width, float angle, float curl) {
    const int across = 4, along = 8;
    Mesh petal = make_grid(across, along, 1.0f, 1.0f);
    glm::vec2 spine[along + 1];  // (x, y)
    float tilt[along + 1];
    glm::vec2 at(0.012f, 0.0f);
    for (int r = 0; r <= along; ++r) {
        const float u = static_cast<float>(r) / along;
        tilt[r] = angle + curl * u;
        spine[r] = at;
        at += length / along * glm::vec2(std::sin(tilt[r]), std::cos(tilt[r]));
    }
    for (int r = 0; r <= along; ++r) {
        const float u = static_cast<float>(r) / along;
        const float half =
            0.5f * width * (0.25f + 0.75f * std::sin(kPi * std::pow(u, 0.75f) * 0.97f)) * (r == along ? 0.3f : 1.0f);
        for (int c = 0; c <= across; ++c) {
            const float s = 2.0f * static_cast<float>(c) / across - 1.0f, cup = 0.22f * half * s * s;
            petal.positions[static_cast<size_t>(r * (across + 1) + c)] = {spine[r].x - cup * std::cos(tilt[r]),
                                                                          spine[r].y + cup * std::sin(tilt[r]), half * s};
        }
    }
    return petal;
}

// open: -1 closed, 0 half open, 1 wide open. bend: metres that the top is off its place. Same vertices for all poses.
Mesh make_flower_pose(MaterialId leaf, MaterialId outer, MaterialId inner, MaterialId heart, float open,
                      const glm::vec2& bend) {
    Mesh flower;
    std::vector<glm::vec3> path;
    std::vector<float> radii;
    for (int i = 0; i <= 14; ++i) {
        const float u = static_cast<float>(i) / 14.0f;
        path.push_back({0.05f * std::sin(4.0f * u), 0.2f + 0.72f * u, 0.03f * std::sin(3.0f * u + 1.0f) - 0.025f});
        radii.push_back(0.013f - 0.004f * u);
    }
    append(flower, make_tube(path, radii, 10), {}, leaf);
    for (int i = 0; i < 6; ++i) {
        const float turn = 137.5f * static_cast<float>(i) + 20.0f;
        append(flower, make_petal(0.34f - 0.025f * static_cast<float>(i), 0.13f, 0.5f + 0.04f * static_cast<float>(i), 1.1f),
               at(path[static_cast<size_t>(1 + i)], turn, {0, 1, 0}), leaf);
    }
    const Affine head = at(path.back(), 34.0f, {0.86f, 0.0f, -0.4f});
    const auto add_petals = [&](int count, float first, float length, float width, float angle, MaterialId material) {
        for (int i = 0; i < count; ++i) {
            const float turn = first + 360.0f * static_cast<float>(i) / static_cast<float>(count);
            append(flower, make_petal(length, width, angle, 0.25f + 0.5f * open),
                   head * at(glm::vec3(0.0f), turn, {0, 1, 0}), material);
        }
    };
    add_petals(11, 0.0f, 0.2f, 0.1f, 0.8f + 0.62f * open, outer);
    add_petals(8, 15.0f, 0.15f, 0.085f, 0.52f + 0.5f * open, inner);
    const glm::vec2 dome[] = {{0.02f, -0.02f}, {0.05f, 0.012f}, {0.04f, 0.03f}, {0.02f, 0.04f}, {0, 0.043f}};
    append(flower, make_lathe(dome, 24), head, heart);
    for (glm::vec3& p : flower.positions) {
        const float lift = std::max(0.0f, p.y - 0.2f) / 0.72f;
        p += glm::vec3(bend.x, 0, bend.y) * lift * lift;
    }
    smooth_normals(flower);
    return flower;
}

Mesh make_jelly_pose(MaterialId jelly, MaterialId cherry, float squash, const glm::vec2& lean) {
    Mesh mesh;
    const float height = 0.125f;
    std::vector<glm::vec2> profile = {{0, 0}};
    for (int i = 0; i <= 14; ++i) {
        const float u = static_cast<float>(i) / 14.0f;
        profile.push_back({0.104f - 0.032f * u, 0.001f + 0.104f * u});
    }
    for (int i = 1; i <= 8; ++i) {
        const float a = 0.5f * kPi * static_cast<float>(i) / 8.0f;
        profile.push_back({0.05f + 0.022f * std::cos(a), 0.105f + 0.02f * std::sin(a)});
    }
    profile.insert(profile.end(), {{0.025f, 0.1215f}, {0, 0.119f}});
    Mesh body = make_lathe(profile, 50);
    for (glm::vec3& p : body.positions) {
        const float angle = std::atan2(p.z, p.x), flute = 0.055f * std::cos(10.0f * angle) * (1.0f - 0.5f * p.y / height);
        p.x *= 1.0f + flute;
        p.z *= 1.0f + flute;
    }
    append(mesh, body, {}, jelly);
    append(mesh, make_sphere(0.022f, 20, 12), at({0, 0.137f, 0}), cherry);
    const std::vector<glm::vec3> stalk = {
        {0, 0.157f, 0}, {0.004f, 0.17f, 0}, {0.012f, 0.186f, 0.003f}, {0.024f, 0.198f, 0.006f}};
    const float radii[] = {0.0022f, 0.0018f, 0.0018f, 0.0024f};
    append(mesh, make_tube(stalk, radii, 8), {}, cherry);
    for (glm::vec3& p : mesh.positions) {
        const float u = std::min(p.y, height) / height;
        const float belly = 1.0f + squash * 0.5f * std::sin(kPi * std::min(u * 0.9f + 0.05f, 1.0f));
        p = {p.x * belly + lean.x * u * u, p.y - squash * 0.45f * height * u, p.z * belly + lean.y * u * u};
    }
    smooth_normals(mesh);
    return mesh;
}

}  // namespace

void add_flower(GlbWriter& glb) {
    const MaterialId clay = glb.material("terracotta", srgb(0xb0613f)), earth = glb.material("earth", srgb(0x3b2a20));
    const MaterialId leaf = glb.material("leaf", srgb(0x5f8347));
    const MaterialId outer = glb.material("petal", srgb(0xe79a8d)), inner = glb.material("inner petal", srgb(0xf3c3a4));
    const MaterialId heart = glb.material("flower heart", srgb(0xd9a437));
    Mesh pot;
    const std::vector<glm::vec2> profile = {{0, 0},       {.115f, 0},     {.125f, .015f}, {.155f, .2f},
                                            {.172f, .2f}, {.172f, .245f}, {.15f, .245f},  {.145f, .21f}};
    append(pot, make_lathe(profile, 48), {}, clay);
    const std::vector<glm::vec2> soil = {{.146f, .215f}, {.07f, .224f}, {0, .226f}};
    append(pot, make_lathe(soil, 48), {}, earth);
    const int node = glb.node("flower pot", -1, Trs{{-1.75f, 0, -1.2f}, glm::quat(1, 0, 0, 0), glm::vec3(1.4f)},
                              glb.mesh("flower pot", pot));

    const auto pose = [&](float open, const glm::vec2& bend) {
        return make_flower_pose(leaf, outer, inner, heart, open, bend);
    };
    Mesh flower = pose(0.0f, {0, 0});
    flower.targets = {target_of(flower, pose(1.0f, {0, 0})), target_of(flower, pose(-1.0f, {0, 0})),
                      target_of(flower, pose(0.0f, {0.1f, 0})), target_of(flower, pose(0.0f, {0, 0.1f}))};
    flower.default_weights = {0, 0, 0, 0};
    // The first two weights make a parabola go through the three poses; one of them is below 0 in between.
    const auto weight = [](uint32_t target, float share) {
        const float turn = 2.0f * kPi * share, open = std::cos(turn);
        if (target == 0) return 0.5f * open * (open + 1.0f);
        if (target == 1) return 0.5f * open * (open - 1.0f);
        return target == 2 ? 0.7f * std::sin(turn + 0.4f) : 0.4f * std::sin(2.0f * turn);
    };
    glb.animate(glb.node("flower", node, glm::vec3(0.0f), glb.mesh("flower", flower)), "weights",
                weight_spline(4, 16, weight));
}

void add_jelly(GlbWriter& glb) {
    const MaterialId raspberry = glb.material("jelly", srgb(0xb8315a)), cherry = glb.material("cherry", srgb(0x8c1621));
    const MaterialId china = glb.material("china", srgb(0xe9ecea)), rim = glb.material("china rim", srgb(0x4d7390));
    Mesh plate;
    const std::vector<glm::vec2> dish = {{0, .004f},     {.08f, .004f},  {.085f, 0},   {.092f, 0},    {.1f, .006f},
                                         {.165f, .022f}, {.167f, .026f}, {.1f, .013f}, {.09f, .011f}, {0, .011f}};
    append(plate, make_lathe(dish, 64), {}, china);
    append(plate, make_torus(0.164f, 0.0035f, 64, 8), at({0, 0.0245f, 0}), rim);
    const int node = glb.node("plate", -1, glm::vec3(-0.86f, kTableTop, 0.3f), glb.mesh("plate", plate));

    const auto pose = [&](float squash, const glm::vec2& lean) { return make_jelly_pose(raspberry, cherry, squash, lean); };
    Mesh jelly = pose(0.0f, {0, 0});
    jelly.targets = {target_of(jelly, pose(0.3f, {0, 0})), target_of(jelly, pose(0.0f, {0.05f, 0})),
                     target_of(jelly, pose(0.0f, {0, 0.05f}))};
    jelly.default_weights = {0, 0, 0};
    const auto weight = [](uint32_t target, float share) {
        const float turn = 2.0f * kPi * share;
        if (target == 0) return 0.15f + 0.75f * std::sin(4.0f * turn);
        return target == 1 ? 0.9f * std::sin(3.0f * turn) : 0.6f * std::cos(3.0f * turn) * std::sin(turn);
    };
    glb.animate(glb.node("jelly", node, glm::vec3(0, 0.011f, 0), glb.mesh("jelly", jelly)), "weights",
                weight_spline(3, 32, weight));
}

}  // namespace zoe
