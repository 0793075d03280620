#include <cmath>
#include <numbers>

#include "content/make_default_parts.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// A round thing that stands upright on the XY plane: the lathe's axis becomes +Z.
Affine upright(const glm::vec3& place) {
    return at(place, 90.0f, {1, 0, 0});
}

}  // namespace

void add_clock(GlbWriter& glb) {
    const MaterialId wood = glb.material("clock case", srgb(0x5d3a26)), face = glb.material("clock face", srgb(0xf0e6d0));
    const MaterialId ink = glb.material("clock ink", srgb(0x2b2a2c)), brass = glb.material("clock brass", srgb(0xc99b4a));
    Mesh box;
    const std::vector<glm::vec2> bezel = {{0, 0},           {0.19f, 0},     {0.19f, 0.05f},
                                          {0.175f, 0.065f}, {0.16f, 0.05f}, {0.158f, 0.04f}};
    append(box, make_lathe(bezel, 56), upright(glm::vec3(0.0f)), wood);
    append(box, make_cylinder(0.16f, 0.0f, 0.042f, 56), upright(glm::vec3(0.0f)), face);
    for (int hour = 0; hour < 12; ++hour) {
        const float size = hour % 3 == 0 ? 1.6f : 1.0f;
        append(box, make_box({-0.004f * size, 0.148f - 0.02f * size, 0.042f}, {0.004f * size, 0.148f, 0.045f}),
               at(glm::vec3(0.0f), 30.0f * static_cast<float>(hour), {0, 0, 1}), ink);
    }
    append(box, make_box({-0.1f, -0.56f, 0}, {0.1f, -0.12f, 0.014f}), {}, wood);
    for (const float s : {-1.0f, 1.0f})
        append(box, make_box({s * 0.1f - 0.012f, -0.56f, 0}, {s * 0.1f + 0.012f, -0.1f, 0.08f}), {}, wood);
    append(box, make_box({-0.13f, -0.59f, 0}, {0.13f, -0.56f, 0.095f}), {}, wood);
    const int clock = glb.node("clock", -1, glm::vec3(0.02f, 1.98f, -1.9f), glb.mesh("clock", box));

    // The pendulum swings twice; a spline through its turning points and its middle is near enough to a sine.
    Mesh bob;
    append(bob, make_box({-0.005f, -0.4f, -0.003f}, {0.005f, 0, 0.003f}), {}, brass);
    const std::vector<glm::vec2> lens = {{0, -0.012f}, {0.035f, -0.008f}, {0.045f, 0}, {0.035f, 0.008f}, {0, 0.012f}};
    append(bob, make_lathe(lens, 36), upright({0, -0.38f, 0}), brass);
    const int pendulum = glb.node("pendulum", clock, glm::vec3(0, -0.1f, 0.045f), glb.mesh("pendulum", bob));
    Sampler swing{.interpolation = Interpolation::kCubicSpline, .is_rotation = true, .width = 4};
    for (int k = 0; k <= 16; ++k) {
        const float phase = 4.0f * kPi * static_cast<float>(k) / 16.0f, half = 0.055f * std::sin(phase);
        const float slope = 0.055f * std::cos(phase) * 4.0f * kPi / GlbWriter::kDuration_s;
        swing.times_s.push_back(GlbWriter::kDuration_s * static_cast<float>(k) / 16.0f);
        for (int part = 0; part < 3; ++part) {
            const bool is_value = part == 1;
            swing.values.insert(swing.values.end(), {0, 0, is_value ? std::sin(half) : slope * std::cos(half),
                                                     is_value ? std::cos(half) : -slope * std::sin(half)});
        }
    }
    glb.animate(pendulum, "rotation", swing);

    // The long hand goes round once; the thin one ticks eight times a turn.
    const auto add_hand = [&](const char* name, float length, float width, float z, float degrees) {
        Mesh hand;
        append(hand, make_box({-width, -0.25f * length, z}, {width, length, z + 0.004f}), {}, ink);
        const glm::quat turn = glm::angleAxis(glm::radians(degrees), glm::vec3(0, 0, 1));
        return glb.node(name, clock, Trs{{0, 0, 0.045f}, turn, glm::vec3(1)}, glb.mesh(name, hand));
    };
    add_hand("hour hand", 0.085f, 0.006f, 0.0f, 52.0f);
    glb.spin(add_hand("minute hand", 0.13f, 0.0045f, 0.005f, 0.0f), {0, 0, 1}, -1);
    Sampler ticks{.interpolation = Interpolation::kStep, .is_rotation = true, .width = 4};
    for (int k = 0; k < 32; ++k) {
        const float half = -kPi * static_cast<float>(k) / 8.0f;
        ticks.times_s.push_back(GlbWriter::kDuration_s * static_cast<float>(k) / 32.0f);
        ticks.values.insert(ticks.values.end(), {0, 0, std::sin(half), std::cos(half)});
    }
    glb.animate(add_hand("second hand", 0.12f, 0.002f, 0.01f, 0.0f), "rotation", ticks);
}

void add_yarn(GlbWriter& glb) {
    const MaterialId wool = glb.material("yarn", srgb(0x4e8a8c));
    const float radius = 0.085f;
    Mesh yarn;
    append(yarn, make_sphere(0.9f * radius, 20, 12), {}, wool);
    for (int i = 0; i < 20; ++i) {  // Hoops in all directions.
        const float golden = 2.39996f * static_cast<float>(i), y = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / 20.0f;
        const float r = std::sqrt(1.0f - y * y);
        append(yarn, make_torus(0.93f * radius, 0.0065f, 26, 5),
               at(glm::vec3(0.0f), 90.0f * (1.0f + std::sin(golden)), {r * std::cos(golden), y, r * std::sin(golden)}),
               wool);
    }
    const glm::vec3 rest(-0.55f, 0.013f + radius, 0.83f);
    const int node = glb.node("yarn", -1, rest, glb.mesh("yarn", yarn));
    // To and fro without slipping: the turn is the way over the radius.
    Sampler way{.interpolation = Interpolation::kCubicSpline, .width = 3};
    Sampler turn{.is_rotation = true, .width = 4};
    const float reach = 0.17f;
    for (int k = 0; k <= 8; ++k) {
        const float phase = 2.0f * kPi * static_cast<float>(k) / 8.0f;
        const float slope = reach * std::cos(phase) * 2.0f * kPi / GlbWriter::kDuration_s;
        way.times_s.push_back(GlbWriter::kDuration_s * static_cast<float>(k) / 8.0f);
        way.values.insert(way.values.end(), {slope, 0, 0, rest.x + reach * std::sin(phase), rest.y, rest.z, slope, 0, 0});
    }
    for (int k = 0; k <= 32; ++k) {
        const float phase = 2.0f * kPi * static_cast<float>(k) / 32.0f, half = -0.5f * reach * std::sin(phase) / radius;
        turn.times_s.push_back(GlbWriter::kDuration_s * static_cast<float>(k) / 32.0f);
        turn.values.insert(turn.values.end(), {0, 0, std::sin(half), std::cos(half)});
    }
    glb.animate(node, "translation", way);
    glb.animate(node, "rotation", turn);
}

}  // namespace zoe
