#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "content/make_default_parts.h"
#include "content/polygonise.h"

namespace zoe {
namespace {

using Profile = std::vector<glm::vec2>;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kFigures = 16;  // The drum turns by one figure a frame, so at 24 fps each place shows one hop in 16 frames.
constexpr int kSlots = 18;
constexpr int kTurns = 6;  // 96 frames / 16 figures.
constexpr float kDrumRadius = 0.36f, kDrumBottom = 0.2f, kWall = 0.15f;

// Distance to an ellipsoid, about right near its surface.
float ellipsoid(const glm::vec3& p, const glm::vec3& centre, const glm::vec3& radii) {
    const glm::vec3 q = (p - centre) / radii, g = q / radii;
    const float k0 = glm::length(q), k1 = glm::length(g);
    return k1 < 1e-9f ? -std::min({radii.x, radii.y, radii.z}) : k0 * (k0 - 1.0f) / k1;
}

float smooth_min(float a, float b, float k) {
    const float h = std::max(k - std::abs(a - b), 0.0f) / k;
    return std::min(a, b) - 0.25f * h * h * k;
}

// Facing +Z, feet on y = 0, 1 long.
Mesh make_rabbit() {
    const auto field = [](const glm::vec3& world) {
        const glm::vec3 p(std::abs(world.x), world.y, world.z);
        float d = ellipsoid(p, {0, 0.4f, -0.12f}, {0.25f, 0.29f, 0.36f});
        d = smooth_min(d, ellipsoid(p, {0, 0.46f, 0.16f}, {0.18f, 0.2f, 0.2f}), 0.12f);
        d = smooth_min(d, ellipsoid(p, {0, 0.68f, 0.38f}, {0.17f, 0.17f, 0.21f}), 0.1f);
        d = smooth_min(d, ellipsoid(p, {0.17f, 0.24f, -0.16f}, {0.1f, 0.2f, 0.2f}), 0.07f);
        d = smooth_min(d, ellipsoid(p, {0.18f, 0.06f, 0.0f}, {0.075f, 0.06f, 0.2f}), 0.05f);
        d = smooth_min(d, ellipsoid(p, {0.1f, 0.2f, 0.26f}, {0.06f, 0.2f, 0.065f}), 0.07f);
        return smooth_min(d, ellipsoid(p, {0, 0.4f, -0.52f}, {0.1f, 0.1f, 0.1f}), 0.04f);
    };
    return polygonise(field, {{-0.42f, -0.06f, -0.72f}, {0.42f, 0.96f, 0.7f}}, 0.055f);
}

// Both ears, from the origin up and back.
Mesh make_ears() {
    Mesh ears, ear = make_sphere(1.0f, 14, 10);
    for (const float side : {-1.0f, 1.0f}) {
        append(ears, ear, at({side * 0.085f, 0.22f, -0.04f}, side * -10.0f, {0, 0, 1}, {0.06f, 0.25f, 0.035f}));
    }
    return ears;
}

Mesh make_gear(int teeth, float pitch_radius, float y0, float y1, int spokes) {
    const float module = 2.0f * pitch_radius / static_cast<float>(teeth), pitch = 2.0f * kPi / static_cast<float>(teeth);
    const float tip = pitch_radius + 0.95f * module, root = pitch_radius - 1.15f * module, rim = root - 2.2f * module;
    std::vector<glm::vec2> outer, inner;
    for (int t = 0; t < teeth; ++t) {
        const float at[] = {-0.29f, -0.13f, 0.13f, 0.29f};
        for (int k = 0; k < 4; ++k) {
            const float angle = pitch * (static_cast<float>(t) + at[k]), radius = k == 1 || k == 2 ? tip : root;
            outer.push_back({radius * std::cos(angle), radius * std::sin(angle)});
            inner.push_back({rim * std::cos(angle), rim * std::sin(angle)});
        }
    }
    Mesh gear = make_ring(outer, inner, y0, y1);
    const float hub = 0.22f * pitch_radius;
    append(gear, make_cylinder(hub, y0 - 0.004f, y1 + 0.006f, 24));
    for (int s = 0; s < spokes; ++s) {
        append(gear, make_box({0.6f * hub, y0 + 0.003f, -0.35f * hub}, {rim + 0.2f * module, y1 - 0.003f, 0.35f * hub}),
               at(glm::vec3(0.0f), 360.0f * static_cast<float>(s) / static_cast<float>(spokes), {0, 1, 0}));
    }
    return gear;
}

Mesh make_drum(GlbWriter& glb) {
    const MaterialId red = glb.material("drum, outside", srgb(0xb23a2e)),
                     night = glb.material("drum, inside", srgb(0x27415a));
    const MaterialId gold = glb.material("drum brass", srgb(0xd0a04c)), cream = glb.material("drum cream", srgb(0xeadcbc));
    Mesh drum;
    const Profile hull = {{0, 0}, {0.1f, 0}, {kDrumRadius, 0.012f}, {kDrumRadius, 0.03f}, {0, 0.03f}};
    append(drum, make_lathe(hull, 72), {}, red);
    const float pitch = 2.0f * kPi / kSlots, slot = 0.2f * pitch, skin = 0.006f;
    for (const bool is_inside : {false, true}) {
        const float r0 = kDrumRadius - (is_inside ? 2.0f : 1.0f) * skin, r1 = r0 + skin;
        const MaterialId material = is_inside ? night : red;
        append(drum, make_ring(circle(r1, 72), circle(r0, 72), 0.03f, 0.055f), {}, material);
        append(drum, make_ring(circle(r1, 72), circle(r0, 72), kWall - 0.022f, kWall), {}, material);
        for (int s = 0; s < kSlots; ++s) {
            const float begin = pitch * static_cast<float>(s) + 0.5f * slot;
            append(drum, make_arc(r0, r1, begin, begin + pitch - slot, 0.055f, kWall - 0.022f, 4), {}, material);
        }
    }
    append(drum, make_torus(kDrumRadius - skin, 0.0085f, 72, 8), at({0, kWall, 0}), gold);
    append(drum, make_torus(kDrumRadius - 0.002f, 0.009f, 72, 8), at({0, 0.026f, 0}), gold);
    // The rabbits' track, and a tier for the balls.
    append(drum, make_ring(circle(0.325f, 72), circle(0.2f, 72), 0.03f, 0.062f), {}, night);
    const Profile tier = {{0.2f, 0.03f},  {0.2f, 0.15f},  {0.19f, 0.16f}, {0.09f, 0.16f}, {0.085f, 0.172f},
                          {0.05f, 0.18f}, {0.03f, 0.22f}, {0.024f, 0.3f}, {0, 0.3f}};
    append(drum, make_lathe(tier, 72), {}, cream);
    append(drum, make_torus(0.196f, 0.007f, 72, 8), at({0, 0.153f, 0}), gold);
    append(drum, make_sphere(0.036f, 28, 16), at({0, 0.325f, 0}), gold);
    const Profile spike = {{0.014f, 0.35f}, {0.009f, 0.375f}, {0, 0.42f}};
    append(drum, make_lathe(spike, 20), {}, gold);
    return drum;
}

void add_rabbits(GlbWriter& glb, int drum) {
    const MaterialId ivory = glb.material("rabbit", srgb(0xf3e9d6)), pink = glb.material("ears", srgb(0xe3a08c));
    Mesh body, ears;
    append(body, make_rabbit(), {}, ivory);
    append(ears, make_ears(), {}, pink);
    const int body_mesh = glb.mesh("rabbit", body), ears_mesh = glb.mesh("ears", ears);
    for (int k = 0; k < kFigures; ++k) {
        const float phase = static_cast<float>(k) / kFigures, angle = 2.0f * kPi * phase;
        const float flight = std::max(0.0f, (phase - 0.28f) / 0.72f), contact = std::min(phase / 0.28f, 1.0f);
        const float height = 0.5f * flight * (1.0f - flight);
        const float pitch = flight > 0.0f ? -34.0f * std::cos(kPi * flight) : 34.0f * std::cos(kPi * contact);
        const float squash = flight > 0.0f ? 1.0f + 0.16f * std::sin(kPi * flight) : 1.0f - 0.3f * std::sin(kPi * contact);
        const float size = 0.115f;
        const glm::quat turn =
            glm::angleAxis(kPi - angle, glm::vec3(0, 1, 0)) * glm::angleAxis(glm::radians(pitch), glm::vec3(1, 0, 0));
        const std::string number = std::to_string(k);
        const Trs placed{{0.263f * std::cos(angle), 0.062f + 0.6f * height, 0.263f * std::sin(angle)},
                         turn,
                         size * glm::vec3(1.0f / std::sqrt(squash), 1.0f / std::sqrt(squash), squash)};
        const int rabbit = glb.node("rabbit " + number, drum, placed, body_mesh);
        const float swing = flight > 0.0f ? -25.0f - 70.0f * (1.0f - flight) : -25.0f + 30.0f * std::sin(kPi * contact);
        glb.node("ears " + number, rabbit,
                 Trs{{0, 0.78f, 0.34f}, glm::angleAxis(glm::radians(swing), glm::vec3(1, 0, 0)), glm::vec3(1)}, ears_mesh);
    }
}

void add_balls(GlbWriter& glb, int drum) {
    const MaterialId ochre = glb.material("ball", srgb(0xe8a33d));
    Mesh ball;
    append(ball, make_sphere(0.023f, 24, 14), {}, ochre);
    const int mesh = glb.mesh("ball", ball);
    for (int k = 0; k < kFigures; ++k) {
        const float angle = 2.0f * kPi * static_cast<float>(k) / kFigures;
        const float u = static_cast<float>(k % (kFigures / 2)) / (kFigures / 2), rise = 4.0f * u * (1.0f - u);
        const float stretch = u == 0.0f ? 0.62f : 1.0f + 0.22f * (1.0f - rise);
        const glm::vec3 scale(1.0f / std::sqrt(stretch), stretch, 1.0f / std::sqrt(stretch));
        const Trs placed{{0.143f * std::cos(angle), 0.16f + 0.023f * stretch + 0.085f * rise, 0.143f * std::sin(angle)},
                         glm::quat(1, 0, 0, 0),
                         scale};
        glb.node("ball " + std::to_string(k), drum, placed, mesh);
    }
}

// Three gears on the stand; each starts with a tooth in its neighbour's gap. A turn by a positive angle about +Y moves a
// tooth from +X towards -Z.
void add_gears(GlbWriter& glb, int stand) {
    const MaterialId brass = glb.material("gear brass", srgb(0xbf9146)), steel = glb.material("gear steel", srgb(0x8d979b));
    const MaterialId knob = glb.material("knob", srgb(0x8e2f28));
    const float pinion_radius = 0.075f, wheel_radius = 0.225f, idler_radius = 0.1125f;
    const float to_wheel = glm::radians(42.0f), to_idler = glm::radians(172.0f);
    const glm::vec3 wheel_at = (pinion_radius + wheel_radius) * glm::vec3(std::cos(to_wheel), 0, std::sin(to_wheel));
    const glm::vec3 idler_at =
        wheel_at + (wheel_radius + idler_radius) * glm::vec3(std::cos(to_idler), 0, std::sin(to_idler));
    const float pinion_start = -to_wheel, wheel_start = -(to_wheel + kPi + kPi / 48.0f);
    // A tooth of the wheel that points at the idler at some turn decides the idler's start.
    const float teeth_to_idler = (to_idler + wheel_start) * 48.0f / (2.0f * kPi);
    const float ahead = (teeth_to_idler - std::floor(teeth_to_idler)) * 2.0f * kPi / 24.0f;
    const float idler_start = -(to_idler + kPi + kPi / 24.0f) - ahead;

    Mesh pinion, wheel, idler;
    append(pinion, make_gear(16, pinion_radius, 0.058f, 0.085f, 3), {}, steel);
    append(wheel, make_gear(48, wheel_radius, 0.06f, 0.083f, 6), {}, brass);
    append(wheel, make_cylinder(0.007f, 0.08f, 0.1f, 16), at({0.165f, 0, 0}), steel);
    const Profile grip = {{0, 0.1f}, {0.014f, 0.1f}, {0.013f, 0.115f}, {0.02f, 0.15f}, {0.014f, 0.172f}, {0, 0.176f}};
    append(wheel, make_lathe(grip, 24), at({0.165f, 0, 0}), knob);
    append(wheel, make_box({0.1f, 0.083f, -0.014f}, {0.19f, 0.089f, 0.014f}), {}, steel);
    append(idler, make_gear(24, idler_radius, 0.06f, 0.083f, 4), {}, steel);
    append(idler, make_cylinder(0.012f, 0.083f, 0.1f, 20), {}, brass);

    const auto add = [&](const char* name, const Mesh& mesh, const glm::vec3& place, int turns, float start) {
        const glm::quat turn = glm::angleAxis(start, glm::vec3(0, 1, 0));
        const int node = glb.node(name, stand, Trs{place, turn, glm::vec3(1)}, glb.mesh(name, mesh));
        glb.spin(node, {0, 1, 0}, turns, glm::degrees(start));
    };
    add("pinion", pinion, glm::vec3(0.0f), kTurns, pinion_start);
    add("crank wheel", wheel, wheel_at, -kTurns / 3, wheel_start);
    add("idler", idler, idler_at, 2 * kTurns / 3, idler_start);
}

}  // namespace

void add_zoetrope(GlbWriter& glb) {
    const MaterialId wood = glb.material("stand", srgb(0xb98550)), edge = glb.material("stand, dark", srgb(0x4f3120));
    const MaterialId brass = glb.material("stand brass", srgb(0xb98f4a));
    Mesh stand;
    append(stand, make_box({-0.4f, 0, -0.4f}, {0.5f, 0.014f, 0.46f}), {}, edge);
    append(stand, make_box({-0.385f, 0.014f, -0.385f}, {0.485f, 0.04f, 0.445f}), {}, wood);
    const Profile shaft = {{0, 0.04f},       {0.05f, 0.04f},        {0.045f, 0.052f},
                           {0.018f, 0.056f}, {0.018f, kDrumBottom}, {0, kDrumBottom}};
    append(stand, make_lathe(shaft, 28), {}, brass);
    const Profile cup = {{0.019f, 0.11f}, {0.03f, 0.12f},       {0.034f, 0.14f},
                         {0.09f, 0.19f},  {0.09f, kDrumBottom}, {0, kDrumBottom}};
    append(stand, make_lathe(cup, 40), {}, wood);
    for (const float x : {-0.33f, 0.43f}) {
        for (const float z : {-0.33f, 0.39f}) append(stand, make_sphere(0.011f, 14, 8), at({x, 0.04f, z}), brass);
    }
    const int node = glb.node("zoetrope", -1, Trs{{-0.07f, kTableTop, -0.05f}, glm::quat(1, 0, 0, 0), glm::vec3(1.32f)},
                              glb.mesh("stand", stand));
    const int drum = glb.node("drum", node, glm::vec3(0, kDrumBottom, 0), glb.mesh("drum", make_drum(glb)));
    glb.spin(drum, {0, 1, 0}, kTurns);
    add_rabbits(glb, drum);
    add_balls(glb, drum);
    add_gears(glb, node);
}

}  // namespace zoe
