#include <cmath>

#include <glm/geometric.hpp>

#include "content/make_default_parts.h"
#include "engine/math/rng.h"

namespace zoe {
namespace {

using Profile = std::vector<glm::vec2>;

Mesh make_leg(float height) {
    const Profile profile = {{0, 0},        {.022f, 0},    {.03f, .015f}, {.03f, .04f},   {.018f, .06f},   {.026f, .1f},
                             {.034f, .16f}, {.030f, .22f}, {.02f, .27f},  {.032f, .29f},  {.032f, .31f},   {.022f, .33f},
                             {.03f, .42f},  {.036f, .5f},  {.03f, .56f},  {.036f, .575f}, {.036f, height}, {0, height}};
    return make_lathe(profile, 20);
}

void add_table(GlbWriter& glb, int parent) {
    const MaterialId walnut = glb.material("walnut", srgb(0x80522f)), dark = glb.material("walnut, dark", srgb(0x553521));
    Mesh table;
    const float x = 1.14f, z = 0.62f, top = kTableTop;
    append(table, make_box({-x, top - 0.028f, -z}, {x, top, z}), {}, walnut);
    append(table, make_box({-x + 0.015f, top - 0.04f, -z + 0.015f}, {x - 0.015f, top - 0.028f, z - 0.015f}), {}, walnut);
    append(table, make_box({-x + 0.06f, top - 0.14f, -z + 0.06f}, {x - 0.06f, top - 0.04f, z - 0.06f}), {}, dark);
    for (const float sx : {-1.0f, 1.0f}) {
        for (const float sz : {-1.0f, 1.0f}) {
            append(table, make_leg(top - 0.04f), at({sx * (x - 0.1f), 0, sz * (z - 0.1f)}), walnut);
        }
    }
    glb.node("table", parent, glm::vec3(0.0f), glb.mesh("table", table));

    Mesh stool;
    const Profile seat = {{0, .5f}, {.2f, .5f}, {.225f, .51f}, {.225f, .53f}, {.21f, .54f}, {0, .54f}};
    append(stool, make_lathe(seat, 40), {}, walnut);
    for (int i = 0; i < 3; ++i) {
        const float a = 2.0944f * static_cast<float>(i) + 0.5f;
        const glm::vec3 foot(0.2f * std::cos(a), 0, 0.2f * std::sin(a)),
            head(0.13f * std::cos(a), 0.5f, 0.13f * std::sin(a));
        const std::vector<glm::vec3> path = {foot, glm::mix(foot, head, 0.5f), head};
        const float radii[] = {0.014f, 0.024f, 0.02f};
        append(stool, make_tube(path, radii, 14), {}, dark);
    }
    append(stool, make_torus(0.165f, 0.011f, 40, 10), at({0, 0.22f, 0}), dark);
    const uint32_t covers[] = {0x39505a, 0xc99a4b, 0x8c3b3a};
    for (int i = 0; i < 3; ++i) {
        const float size = 0.15f - 0.012f * static_cast<float>(i), y = 0.54f + 0.036f * static_cast<float>(i);
        Mesh book = make_box({-size, 0, -0.72f * size}, {size, 0.035f, 0.72f * size});
        paint(book, srgb(covers[i]));
        append(stool, book, at({0, y, 0}, 17.0f * static_cast<float>(i) - 25.0f, {0, 1, 0}), kPaintByVertex);
    }
    const Profile mug = {{0, .648f}, {.036f, .648f}, {.04f, .655f}, {.042f, .74f}, {.038f, .74f}, {.036f, .66f}, {0, .66f}};
    Mesh cup = make_lathe(mug, 32);
    append(cup, make_torus(0.026f, 0.006f, 24, 10), at({0.047f, 0.697f, 0}, 90.0f, {1, 0, 0}));
    paint(cup, srgb(0x3f6f7a));
    append(stool, cup, at({0.02f, 0, 0.01f}, -40.0f, {0, 1, 0}), kPaintByVertex);
    glb.node("stool", parent, glm::vec3(1.62f, 0, 0.1f), glb.mesh("stool", stool));
}

void add_rug(GlbWriter& glb, int parent) {
    const int picture = glb.texture("rug", rug_png());
    const MaterialId wool =
        glb.material("rug", glm::vec3(1.0f), {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", picture}}}}}});
    const MaterialId fringe = glb.material("fringe", srgb(0xe3d6bb));
    Mesh rug, top = make_grid(1, 1, 3.3f, 2.1f);
    for (const glm::vec3& p : top.positions) top.uvs[0].push_back({p.x / 3.3f + 0.5f, p.z / 2.1f + 0.5f});
    append(rug, top, at({0, 0.012f, 0}), wool);
    append(rug, make_box({-1.65f, 0, -1.05f}, {1.65f, 0.0119f, 1.05f}), {}, fringe);
    for (int i = 0; i < 48; ++i) {
        const float z = -1.035f + 0.044f * static_cast<float>(i);
        append(rug, make_box({-1.72f, 0, z - 0.006f}, {-1.65f, 0.005f, z + 0.006f}), {}, fringe);
        append(rug, make_box({1.65f, 0, z - 0.006f}, {1.72f, 0.005f, z + 0.006f}), {}, fringe);
    }
    glb.node("rug", parent, glm::vec3(-0.05f, 0, 0.3f), glb.mesh("rug", rug));
}

void add_shelf(GlbWriter& glb, int parent) {
    const MaterialId wood = glb.material("shelf", srgb(0x7c5237));
    const MaterialId brass = glb.material("shelf brass", srgb(0xb98d43));
    Mesh shelf;
    append(shelf, make_box({-0.75f, -0.03f, 0}, {0.75f, 0, 0.24f}), {}, wood);
    for (const float x : {-0.6f, 0.6f}) append(shelf, make_box({x - 0.02f, -0.2f, 0}, {x + 0.02f, -0.03f, 0.18f}), {}, wood);
    const uint32_t covers[] = {0x8c3b3a, 0x2f4a5e, 0xc99a4b, 0x55694d, 0xd8cbb0, 0x6d4a68, 0xa85f3e, 0x39505a};
    Rng rng(5);
    float x = -0.7f;
    for (int i = 0; i < 15; ++i) {
        const float width = rng.uniform(0.026f, 0.05f), height = rng.uniform(0.2f, 0.3f), depth = rng.uniform(0.15f, 0.19f);
        Mesh book = make_box({0, 0, 0.02f}, {width, height, 0.02f + depth});
        paint(book, srgb(covers[rng.below(8)]));
        append(shelf, book, i == 14 ? at({x + 0.055f, 0, 0}, 14.0f, {0, 0, 1}) : at({x, 0, 0}), kPaintByVertex);
        x += width + 0.002f;
    }
    // A vase, a globe on its stand, and books that lie.
    const Profile vase = {{0, 0},       {.045f, 0},    {.075f, .06f}, {.07f, .12f}, {.03f, .18f}, {.026f, .21f},
                          {.04f, .23f}, {.03f, .225f}, {.018f, .2f},  {.02f, .15f}, {0, .05f}};
    Mesh pot = make_lathe(vase, 32);
    paint(pot, srgb(0x3f6f7a));
    append(shelf, pot, at({0.1f, 0, 0.12f}), kPaintByVertex);
    const Profile foot = {{0, 0}, {.06f, 0}, {.055f, .012f}, {.012f, .022f}, {.01f, .06f}, {0, .06f}};
    append(shelf, make_lathe(foot, 28), at({0.6f, 0, 0.12f}), brass);
    append(shelf, make_torus(0.1f, 0.006f, 48, 10), at({0.6f, 0.165f, 0.12f}, 66.0f, {1, 0, 0}), brass);
    Mesh globe = make_sphere(0.088f, 40, 20);
    for (const glm::vec3& n : globe.normals) {  // Land where a few waves say so.
        const float land =
            std::sin(3.1f * n.x + 1.0f) * std::cos(2.3f * n.y + 0.4f) + 0.6f * std::sin(4.7f * n.z - 2.0f * n.x);
        globe.colors.push_back(glm::vec4(srgb(land > 0.35f ? 0xb9a06a : 0x44707f), 1.0f));
    }
    append(shelf, globe, at({0.6f, 0.165f, 0.12f}, 23.0f, {0, 0, 1}), kPaintByVertex);
    const float thick[] = {0.035f, 0.028f, 0.04f};
    float y = 0.0f;
    for (int i = 0; i < 3; ++i) {
        Mesh book = make_box({-0.11f, 0, -0.075f}, {0.11f, thick[i], 0.075f});
        paint(book, srgb(covers[(3 * i + 1) % 8]));
        append(shelf, book, at({0.34f, y, 0.12f}, 7.0f * static_cast<float>(i) - 6.0f, {0, 1, 0}), kPaintByVertex);
        y += thick[i];
    }
    glb.node("shelf", parent, glm::vec3(1.27f, 1.62f, -1.9f), glb.mesh("shelf", shelf));
}

void add_pictures(GlbWriter& glb, int parent) {
    const int picture = glb.texture("landscape", landscape_png());
    const MaterialId canvas =
        glb.material("canvas", glm::vec3(1.0f), {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", picture}}}}}});
    const MaterialId gilt = glb.material("gilt", srgb(0xa9803f));
    Mesh mesh, sheet = make_grid(1, 1, 0.8f, 0.55f);
    for (const glm::vec3& p : sheet.positions) sheet.uvs[0].push_back({p.x / 0.8f + 0.5f, p.z / 0.55f + 0.5f});
    append(mesh, sheet, at({0, 0, 0.015f}, 90.0f, {1, 0, 0}), canvas);
    append(mesh, make_box({-0.4f, -0.275f, 0}, {0.4f, 0.275f, 0.0149f}), {}, gilt);
    for (const float s : {-1.0f, 1.0f}) {
        append(mesh, make_box({-0.45f, s * 0.3f - 0.03f, 0}, {0.45f, s * 0.3f + 0.03f, 0.04f}), {}, gilt);
        append(mesh, make_box({s * 0.425f - 0.03f, -0.33f, 0}, {s * 0.425f + 0.03f, 0.33f, 0.04f}), {}, gilt);
    }
    const Trs placed{{-2.3f, 1.62f, -0.75f}, glm::angleAxis(glm::radians(90.0f), glm::vec3(0, 1, 0)), glm::vec3(1)};
    glb.node("picture", parent, placed, glb.mesh("picture", mesh));
}

void add_bunting(GlbWriter& glb, int parent) {
    const uint32_t cloth[] = {0xc4574b, 0xe0b35a, 0x4f7f86, 0xe8dcc2, 0x7a5873};
    Mesh mesh;
    std::vector<glm::vec3> cord;
    for (int i = 0; i <= 60; ++i) {
        const float u = static_cast<float>(i) / 60.0f, swag = 2.0f * u - std::floor(2.0f * u);
        cord.push_back({-2.25f + 4.5f * u, 2.52f - 0.9f * swag * (1.0f - swag), -1.84f + 0.05f * swag * (1.0f - swag)});
    }
    cord.back().y = 2.52f;
    const std::vector<float> radii(cord.size(), 0.004f);
    Mesh string = make_tube(cord, radii, 6);
    paint(string, srgb(0xd9cdb4));
    append(mesh, string, {}, kPaintByVertex);
    for (int i = 0; i < 20; ++i) {
        const glm::vec3 a = cord[static_cast<size_t>(3 * i)], b = cord[static_cast<size_t>(3 * i + 2)];
        const glm::vec3 tip = 0.5f * (a + b) - glm::vec3(0, 0.2f, -0.012f * static_cast<float>(i % 3));
        Mesh flag = make_box({0, 0, 0}, {1, 1, 1});
        for (glm::vec3& p : flag.positions) {
            const glm::vec3 on = p.y > 0.5f ? glm::mix(a, b, p.x) : glm::mix(tip, glm::mix(a, b, p.x), 0.02f);
            p = on + glm::vec3(0, 0, 0.003f * (p.z - 0.5f));
        }
        paint(flag, srgb(cloth[i % 5]));
        append(mesh, flag, {}, kPaintByVertex);
    }
    glb.node("bunting", parent, glm::vec3(0.0f), glb.mesh("bunting", mesh));
}

void add_lamp(GlbWriter& glb, int parent) {
    const MaterialId brass = glb.material("lamp brass", srgb(0xa88346)),
                     linen = glb.material("linen", srgb(0xe9d3a4), {{"emissiveFactor", {0.5f, 0.3f, 0.12f}}});
    const MaterialId glow =
        glb.material("bulb", glm::vec3(0.9f),
                     {{"emissiveFactor", {1.0f, 0.72f, 0.4f}},
                      {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 2.5f}}}}}});
    Mesh lamp;
    const Profile stand = {{0, 0},         {.16f, 0},      {.155f, .015f}, {.06f, .03f},   {.02f, .06f},
                           {.012f, .1f},   {.012f, 1.02f}, {.024f, 1.04f}, {.012f, 1.06f}, {.012f, 1.42f},
                           {.022f, 1.43f}, {.022f, 1.47f}, {0, 1.47f}};
    append(lamp, make_lathe(stand, 28), {}, brass);
    const Profile shade = {{.25f, 1.36f}, {.253f, 1.36f}, {.135f, 1.7f}, {.132f, 1.7f}, {.25f, 1.36f}};
    append(lamp, make_lathe(shade, 48), {}, linen);
    append(lamp, make_sphere(0.042f, 24, 14), at({0, 1.51f, 0}), glow);
    const int node = glb.node("floor lamp", parent, glm::vec3(1.85f, 0, -1.42f), glb.mesh("floor lamp", lamp));
    // The light hangs below the shade, clear of the bulb, which would hide it, and of what it would overexpose.
    auto& document = glb.document();
    document["extensions"]["KHR_lights_punctual"]["lights"].push_back(
        {{"name", "lamp light"}, {"type", "point"}, {"color", {1.0f, 0.66f, 0.34f}}, {"intensity", 1.1f}, {"range", 12.0f}});
    glb.node("lamp light", node, Trs{.translation = {-0.12f, 1.2f, 0.3f}}, -1,
             {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
}

}  // namespace

void add_furniture(GlbWriter& glb) {
    const int furniture = glb.node("furniture", -1, glm::vec3(0.0f));
    add_rug(glb, furniture);
    add_table(glb, furniture);
    add_shelf(glb, furniture);
    add_pictures(glb, furniture);
    add_bunting(glb, furniture);
    add_lamp(glb, furniture);
}

}  // namespace zoe
