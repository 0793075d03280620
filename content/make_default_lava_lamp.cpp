#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "content/make_default_parts.h"
#include "content/polygonise.h"

namespace zoe {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFloor = 0.2f, kCeiling = 0.7f;  // The wax moves between these.
constexpr int kFrames = 96;

Mesh make_wax(float share) {
    struct Drop {
        float radius, low, high, phase, drift;
    };
    const Drop drops[] = {{.054f, .2f, .58f, .0f, .3f},    {.043f, .22f, .64f, 1.3f, 2.1f}, {.034f, .2f, .63f, 2.5f, 4.0f},
                          {.048f, .18f, .56f, 3.4f, 5.2f}, {.029f, .24f, .64f, 4.4f, 1.2f}, {.039f, .19f, .6f, 5.3f, 3.2f}};
    const float turn = 2.0f * kPi * share;
    const auto field = [&](const glm::vec3& p) {
        const glm::vec3 pool = (p - glm::vec3(0, kFloor + 0.012f, 0)) / glm::vec3(0.074f, 0.034f, 0.074f);
        const float length = glm::length(pool);
        float d = (length - 1.0f) * 0.045f;
        for (const Drop& drop : drops) {
            const float rise = 0.5f - 0.5f * std::cos(turn + drop.phase + 0.5f * std::sin(turn + drop.phase));
            const glm::vec3 centre(0.022f * std::sin(turn + drop.drift), glm::mix(drop.low, drop.high, rise),
                                   0.022f * std::cos(turn + 1.7f * drop.drift));
            const glm::vec3 stretch(1.0f, 1.0f - 0.16f * std::sin(turn + drop.phase), 1.0f);
            const float own = glm::length((p - centre) * stretch) - drop.radius, k = 0.045f;
            const float h = std::max(k - std::abs(d - own), 0.0f) / k;
            d = std::min(d, own) - 0.25f * h * h * k;
        }
        return std::max(d, kFloor - p.y);  // Flat where it lies.
    };
    return polygonise(field, {{-0.12f, kFloor - 0.02f, -0.12f}, {0.12f, kCeiling + 0.05f, 0.12f}}, 0.0205f);
}

}  // namespace

void add_lava_lamp(GlbWriter& glb) {
    const MaterialId metal = glb.material("lava lamp metal", srgb(0x33474f)),
                     band = glb.material("lava lamp brass", srgb(0xc0974f));
    const MaterialId wax = glb.material("wax", srgb(0xe8622f), {{"emissiveFactor", {0.7f, 0.2f, 0.05f}}});
    Mesh stand;
    const std::vector<glm::vec2> base = {{0, 0},       {.125f, 0},  {.125f, .015f}, {.07f, .1f}, {.095f, .185f},
                                         {.095f, .2f}, {.08f, .2f}, {.08f, .192f},  {0, .192f}};
    append(stand, make_lathe(base, 56), {}, metal);
    append(stand, make_torus(0.071f, 0.008f, 48, 10), at({0, 0.1f, 0}), band);
    const std::vector<glm::vec2> cap = {{0, .7f}, {.062f, .7f}, {.066f, .71f}, {.045f, .8f}, {.03f, .812f}, {0, .816f}};
    append(stand, make_lathe(cap, 48), {}, metal);
    append(stand, make_sphere(0.016f, 20, 12), at({0, 0.826f, 0}), band);
    for (int i = 0; i < 3; ++i) {
        const float a = 2.0f * kPi * (static_cast<float>(i) + 0.25f) / 3.0f;
        const glm::vec3 low(0.089f * std::cos(a), 0.19f, 0.089f * std::sin(a)),
            high(0.056f * std::cos(a), 0.71f, 0.056f * std::sin(a));
        const std::vector<glm::vec3> path = {low, 0.5f * (low + high), high};
        const float radii[] = {0.0045f, 0.0045f, 0.0045f};
        append(stand, make_tube(path, radii, 10), {}, band);
    }
    const int lamp = glb.node("lava lamp", -1, glm::vec3(0.9f, kTableTop, -0.22f), glb.mesh("lava lamp", stand));

    const Trs cube{{-0.12f, kFloor - 0.02f, -0.12f}, glm::quat(1, 0, 0, 0), glm::vec3(0.58f)};
    std::vector<int> meshes;
    for (int frame = 0; frame < kFrames; ++frame) {
        Mesh mesh = make_wax(static_cast<float>(frame) / kFrames);
        mesh.materials = {{0, static_cast<uint32_t>(mesh.corners.size()), wax}};
        meshes.push_back(glb.mesh("wax " + std::to_string(frame), mesh, &cube));
    }
    glb.node("wax", lamp, cube, meshes.front(), {{"extras", {{"mesh_sequence", {{"meshes", meshes}, {"fps", 24}}}}}});
}

}  // namespace zoe
