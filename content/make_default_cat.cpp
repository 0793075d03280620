#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "content/body.h"
#include "content/make_default_parts.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// The cat's own space: it sits on y = 0 and looks along +Z.
struct Joint {
    const char* name;
    int parent;
    glm::vec3 place;
};

constexpr int kChest = 3, kNeck = 4, kHead = 5, kEarLeft = 6, kEarRight = 7, kTail = 8, kTailCount = 8;

const std::vector<Joint>& joints() {
    static const std::vector<Joint> list = {{"root", -1, {0, 0, 0}},
                                            {"hips", 0, {0, .1f, -.06f}},
                                            {"spine", 1, {0, .17f, -.03f}},
                                            {"chest", 2, {0, .25f, .02f}},
                                            {"neck", 3, {0, .325f, .06f}},
                                            {"head", 4, {0, .375f, .075f}},
                                            {"left ear", 5, {.042f, .44f, .085f}},
                                            {"right ear", 5, {-.042f, .44f, .085f}},
                                            {"tail 0", 1, {0, .05f, -.15f}},
                                            {"tail 1", 8, {.015f, .036f, -.22f}},
                                            {"tail 2", 9, {.05f, .03f, -.285f}},
                                            {"tail 3", 10, {.105f, .03f, -.33f}},
                                            {"tail 4", 11, {.17f, .032f, -.35f}},
                                            {"tail 5", 12, {.235f, .04f, -.345f}},
                                            {"tail 6", 13, {.29f, .06f, -.32f}},
                                            {"tail 7", 14, {.33f, .095f, -.285f}}};
    return list;
}

std::vector<BodyPiece> make_pieces() {
    std::vector<BodyPiece> pieces = {
        {1, {0, .115f, -.075f}, {0, .13f, -.03f}, .108f, .1f},   {2, {0, .165f, -.035f}, {0, .215f, -.005f}, .1f, .088f},
        {3, {0, .225f, .015f}, {0, .295f, .045f}, .082f, .064f}, {4, {0, .31f, .05f}, {0, .36f, .075f}, .056f, .05f},
        {5, {0, .402f, .082f}, {0, .396f, .1f}, .067f, .06f},    {5, {0, .381f, .14f}, {0, .378f, .15f}, .03f, .026f}};
    for (const float s : {1.0f, -1.0f}) {
        const int ear = s > 0.0f ? kEarLeft : kEarRight;
        pieces.insert(pieces.end(), {{1, {s * .085f, .1f, -.04f}, {s * .092f, .075f, .03f}, .072f, .056f},
                                     {0, {s * .1f, .02f, .0f}, {s * .098f, .02f, .105f}, .026f, .023f},
                                     {3, {s * .045f, .26f, .05f}, {s * .042f, .2f, .078f}, .042f, .034f},
                                     {2, {s * .042f, .2f, .078f}, {s * .04f, .11f, .095f}, .033f, .026f},
                                     {0, {s * .04f, .11f, .095f}, {s * .04f, .03f, .1f}, .026f, .023f},
                                     {0, {s * .04f, .018f, .1f}, {s * .042f, .018f, .132f}, .025f, .024f},
                                     {5, {s * .028f, .383f, .118f}, {s * .03f, .383f, .118f}, .036f, .036f},
                                     {ear, {s * .038f, .44f, .085f}, {s * .054f, .497f, .08f}, .03f, .005f}});
    }
    for (int k = 0; k < kTailCount; ++k) {
        const auto i = static_cast<size_t>(kTail + k);
        const glm::vec3 from = joints()[i].place;
        const glm::vec3 to = k + 1 < kTailCount ? joints()[i + 1].place : glm::vec3(.345f, .135f, -.26f);
        const float taper = static_cast<float>(k) / kTailCount;
        pieces.push_back({kTail + k, from, to, .027f - .009f * taper, .026f - .009f * taper});
    }
    return pieces;
}

glm::vec3 fur(const glm::vec3& p) {
    const glm::vec3 ginger = srgb(0xc9793a), dark = srgb(0x99521f), cream = srgb(0xf1e2c8);
    const float back = std::sin(58.0f * (p.y - 0.6f * p.z) + 3.0f * std::sin(16.0f * p.x));
    const float tail = std::sin(75.0f * (p.x - 0.5f * p.z));
    const bool is_tail = p.z < -0.17f && p.y < 0.16f;
    const float stripe = glm::smoothstep(0.35f, 0.75f, is_tail ? tail : back);
    glm::vec3 color = glm::mix(ginger, dark, p.z < 0.06f || p.y > 0.42f ? stripe : 0.0f);
    const float bib = glm::smoothstep(0.05f, 0.075f, p.z - 0.35f * std::abs(p.x)) * glm::smoothstep(0.36f, 0.33f, p.y) *
                      glm::smoothstep(0.14f, 0.18f, p.y);
    const float muzzle = glm::smoothstep(0.05f, 0.035f, glm::distance(p, glm::vec3(0, .374f, .165f)));
    const float paws = glm::smoothstep(0.05f, 0.035f, p.y) * glm::smoothstep(0.02f, 0.05f, p.z);
    const float tip = is_tail ? glm::smoothstep(0.325f, 0.34f, p.x) : 0.0f;
    color = glm::mix(color, cream, std::max({bib, muzzle, paws, tip}));
    return color;
}

Mesh make_cat() {
    Mesh skin = make_body(make_pieces(), static_cast<int>(joints().size()), 0.015f, 0.028f, 0.013f);
    for (glm::vec3& p : skin.positions) p.y = std::max(p.y, 0.001f);
    for (const glm::vec3& p : skin.positions) skin.colors.push_back(glm::vec4(fur(p), 1.0f));

    Mesh cat;
    append(cat, skin, {}, kPaintByVertex);
    cat.binding = skin.binding;
    const auto add_bead = [&](const glm::vec3& place, const glm::vec3& radii, uint32_t color) {
        Mesh bead = make_sphere(1.0f, 14, 10);
        paint(bead, srgb(color));
        append(cat, bead, at(place, 0.0f, {0, 1, 0}, radii), kPaintByVertex);
        for (size_t v = 0; v < bead.positions.size(); ++v) {
            cat.binding.joints.insert(cat.binding.joints.end(), {kHead, 0, 0, 0});
            cat.binding.weights.insert(cat.binding.weights.end(), {1, 0, 0, 0});
        }
    };
    for (const float s : {1.0f, -1.0f}) {
        add_bead({s * .029f, .41f, .146f}, {.0125f, .0135f, .009f}, 0xb9bf4a);
        add_bead({s * .0295f, .41f, .1515f}, {.0055f, .0105f, .0055f}, 0x14120f);
    }
    add_bead({0, .39f, .1755f}, {.008f, .006f, .005f}, 0xb5605c);
    return cat;
}

// A rotation that sways about an axis: `degrees` * sin(turns * 2 pi share + phase), as keys a twelfth of a second apart.
Sampler sway(const glm::vec3& axis, float degrees, int turns, float phase, float offset = 0.0f) {
    Sampler sampler{.is_rotation = true, .width = 4};
    for (int k = 0; k <= 48; ++k) {
        const float share = static_cast<float>(k) / 48.0f;
        const float half =
            0.5f * glm::radians(offset + degrees * std::sin(2.0f * kPi * static_cast<float>(turns) * share + phase));
        sampler.times_s.push_back(GlbWriter::kDuration_s * share);
        sampler.values.insert(sampler.values.end(),
                              {std::sin(half) * axis.x, std::sin(half) * axis.y, std::sin(half) * axis.z, std::cos(half)});
    }
    return sampler;
}

}  // namespace

void add_cat(GlbWriter& glb) {
    const Trs placed{{-1.36f, 0.014f, 0.72f}, glm::angleAxis(glm::radians(72.0f), glm::vec3(0, 1, 0)), glm::vec3(1.35f)};
    const int rig = glb.node("cat rig", -1, placed);
    std::vector<int> nodes;
    std::vector<Affine> joint_from_mesh;
    for (const Joint& joint : joints()) {
        const bool is_root = joint.parent < 0;
        const glm::vec3 above = is_root ? glm::vec3(0.0f) : joints()[static_cast<size_t>(joint.parent)].place;
        nodes.push_back(glb.node(joint.name, is_root ? rig : nodes[static_cast<size_t>(joint.parent)], joint.place - above));
        joint_from_mesh.push_back(at(-joint.place));
    }
    const int skin = glb.skin("cat", nodes, joint_from_mesh);
    glb.node("cat", -1, {}, glb.mesh("cat", make_cat()), {{"skin", skin}});

    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const auto node = [&](int joint) { return nodes[static_cast<size_t>(joint)]; };
    glb.animate(node(2), "rotation", sway(z, 2.0f, 1, 0.4f));
    glb.animate(node(kNeck), "rotation", sway(y, 12.0f, 1, 0.9f, 6.0f));
    glb.animate(node(kHead), "rotation", sway(z, 11.0f, 1, 1.9f, 2.0f));
    glb.animate(node(kEarLeft), "rotation", sway(z, 9.0f, 4, 0.0f));
    glb.animate(node(kEarRight), "rotation", sway(z, 9.0f, 3, 1.0f));
    for (int k = 0; k < kTailCount; ++k) {
        const float phase = -0.55f * static_cast<float>(k);
        glb.animate(node(kTail + k), "rotation", sway(k < 4 ? y : x, k < 4 ? 13.0f : 17.0f, k < 4 ? 1 : 2, phase));
    }
    Sampler breath{.interpolation = Interpolation::kCubicSpline, .width = 3};
    for (int k = 0; k <= 4; ++k) {  // Two breaths; tangents are zero where it turns.
        const float size = k % 2 ? 1.035f : 1.0f;
        breath.times_s.push_back(static_cast<float>(k));
        breath.values.insert(breath.values.end(), {0, 0, 0, size, 1.0f, size, 0, 0, 0});
    }
    glb.animate(node(kChest), "scale", breath);
}

}  // namespace zoe
