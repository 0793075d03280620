#include "tests/fuzz/seeds.h"

#include <filesystem>
#include <utility>

#include "content/make_default_writer.h"
#include "content/shapes.h"
#include "engine/scene/image.h"
#include "tests/fuzz/entries.h"
#include "tests/fuzz/files.h"
#include "tests/scene/glb_builder.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

using nlohmann::json;

std::string bytes_of(GlbWriter& glb) {
    const TempFolder folder;
    glb.write(folder / "a.glb");
    return read_bytes(folder / "a.glb");
}

std::string png(int width, int height) {
    const TempFolder folder;
    std::vector<uint8_t> pixels(static_cast<size_t>(width) * static_cast<size_t>(height) * 4);
    for (size_t k = 0; k < pixels.size(); ++k) pixels[k] = static_cast<uint8_t>(37 * k ^ k >> 3);
    write_png(folder / "a.png", width, height, pixels);
    return read_bytes(folder / "a.png");
}

Mesh small_box(GlbWriter& glb) {
    const MaterialId red = glb.material("red", {1, 0, 0}),
                     lamp = glb.material("lamp", {1, 1, 1}, {{"emissiveFactor", {1, 1, 1}}});
    Mesh mesh;
    append(mesh, make_box({-1, -1, -1}, {1, 1, 1}), {}, red);
    append(mesh, make_grid(2, 1, 3, 3), at({0, 2, 0}), lamp);
    return mesh;
}

/// Nothing moves: materials, a texture, colours, a camera, lights.
std::string still_glb() {
    GlbWriter glb;
    const std::string picture = png(4, 4);
    const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(picture.data()), picture.size());
    const int texture = glb.texture("rug", bytes);
    json& pbr = glb.document()["materials"];
    Mesh mesh = small_box(glb);
    pbr[0]["pbrMetallicRoughness"]["baseColorTexture"] = {
        {"index", texture},
        {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"rotation", 1.0}, {"scale", {2, 2}}}}}}};
    pbr[0]["alphaMode"] = "MASK";
    pbr[1]["extensions"] = {{"KHR_materials_unlit", json::object()},
                            {"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}}};
    glb.document()["textures"][0]["sampler"] = 0;
    glb.document()["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
    paint(mesh, {0.5f, 0.25f, 1.0f});
    glb.node("box", -1, Trs{}, glb.mesh("box", mesh));
    glb.document()["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}, {"color", {1, 1, 0}}},
        {{"type", "directional"}, {"intensity", 3}}};
    glb.document()["cameras"] = {
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0}, {"zfar", 9}}}}};
    glb.node("lamp", -1, Trs{.translation = {0, 3, 0}}, -1,
             {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return bytes_of(glb);
}

/// Nodes above each other that turn, one given by a matrix, a mirror and a scale of zero, a box in 16 bits.
std::string rigid_glb() {
    GlbWriter glb;
    const Trs cube{.translation = {-1, -1, -1}, .scale = glm::vec3(4.0f)};
    const int mesh = glb.mesh("box", small_box(glb), &cube);
    const int root = glb.node("root", -1, {0, 1, 0});
    const int arm = glb.node("arm", root, cube, mesh, {{"extras", {{"motion", "rigid"}}}});
    glb.node("mirror", arm, Trs{.scale = {-1, 1, 1}}, mesh);
    glb.node("none", arm, Trs{.scale = {0, 1, 1}}, mesh);
    glb.node("matrix", root, Trs{}, mesh, {{"matrix", {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 2, 0, 3, 0, 0, 1}}});
    glb.spin(root, {0, 1, 0}, 1);
    Sampler steps{
        .interpolation = Interpolation::kStep, .width = 3, .times_s = {0, 0.25f, 2}, .values = {0, 0, 0, 1, 0, 0, 0, 2, 0}};
    glb.animate(arm, "translation", steps);
    steps.values = {1, 1, 1, 0, 0, 0, 2, 2, 2};
    glb.animate(arm, "scale", steps);
    return bytes_of(glb);
}

std::string skinned_glb() {
    GlbWriter glb;
    const glm::vec3 path[] = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}};
    const float radii[] = {0.3f, 0.2f, 0.1f};
    Mesh mesh = make_tube(path, radii, 4);
    mesh.binding.influence_count = 4;
    for (const glm::vec3& p : mesh.positions) {
        const float upper = glm::clamp(0.5f * p.y, 0.0f, 1.0f);
        mesh.binding.joints.insert(mesh.binding.joints.end(), {0, 1, 0, 0});
        mesh.binding.weights.insert(mesh.binding.weights.end(), {1.0f - upper, upper, 0, 0});
    }
    const int skeleton = glb.node("skeleton", -1);
    const int joints[] = {glb.node("lower", skeleton), glb.node("upper", skeleton + 1, {0, 1, 0})};
    const Affine joint_from_mesh[] = {Affine{}, at({0, -1, 0})};
    const int shown = glb.node("tube", -1, Trs{}, glb.mesh("tube", mesh));
    glb.document()["nodes"][static_cast<size_t>(shown)]["skin"] = glb.skin("skin", joints, joint_from_mesh);
    glb.spin(joints[1], {1, 0, 0}, 1, 10.0f);
    return bytes_of(glb);
}

std::string morphed_glb() {
    GlbWriter glb;
    Mesh mesh = make_sphere(1.0f, 5, 3);
    MorphTarget up, wide;
    for (const glm::vec3& p : mesh.positions) {
        up.positions.push_back({0, p.y, 0});
        wide.positions.push_back({p.x, 0, 0});
        wide.normals.push_back({0, 0.1f, 0});
    }
    mesh.targets = {up, wide};
    mesh.default_weights = {0.25f, 0};
    const int shown = glb.node("ball", -1, Trs{}, glb.mesh("ball", mesh));
    Sampler spline{.interpolation = Interpolation::kCubicSpline, .width = 2, .times_s = {0, 1}, .values = {}};
    spline.values = {0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0};
    glb.animate(shown, "weights", spline);
    return bytes_of(glb);
}

/// A mesh a frame.
std::string arbitrary_glb() {
    GlbWriter glb;
    json meshes = json::array();
    for (int k = 3; k < 6; ++k) meshes.push_back(glb.mesh("drop", make_sphere(1.0f, k, 3)));
    glb.node("drops", -1, Trs{}, 0, {{"extras", {{"mesh_sequence", {{"meshes", meshes}, {"fps", 12}}}}}});
    glb.node("still", -1, Trs{.translation = {0, 3, 0}}, 1, {{"extras", {{"motion", "arbitrary"}}}});
    return bytes_of(glb);
}

GlbBuilder instanced() {
    GlbBuilder glb;
    glb.triangle();
    json& attributes = glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["TRANSLATION"] = glb.floats({0, 0, 0, 1, 0, 0, 2, 0, 0}, "VEC3");
    attributes["ROTATION"] =
        glb.accessor(std::vector<int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0, 0, 32767, 0, 0}, kShort, "VEC4", 3, true);
    attributes["SCALE"] = glb.floats({1, 1, 1, 2, 2, 2, -1, 1, 1}, "VEC3");
    glb.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    glb.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    return glb;
}

/// Strips, fans, lists without indices, every kind of index, interleaved attributes in integers, two primitives a mesh.
GlbBuilder primitives() {
    GlbBuilder glb;
    const std::vector<float> quad{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 0, 1};
    const int positions = glb.floats(quad, "VEC3");
    const std::vector<uint8_t> packed(5 * 12, 100);  // 2 x 16 bits of uv, 4 x 8 bits of colour, 4 x 8 bits of normal.
    const int view = glb.view(packed.data(), packed.size(), 12);
    const int uvs = glb.accessor_of(view, kUshort, "VEC2", 5, true), colors = glb.accessor_of(view, kUbyte, "VEC4", 5, true);
    const int normals = glb.accessor_of(view, kByte, "VEC3", 5, true);
    glb.json["accessors"][static_cast<size_t>(colors)]["byteOffset"] = 4;
    glb.json["accessors"][static_cast<size_t>(normals)]["byteOffset"] = 8;
    const json attributes = {
        {"POSITION", positions}, {"TEXCOORD_0", uvs}, {"TEXCOORD_3", uvs}, {"COLOR_0", colors}, {"NORMAL", normals}};
    glb.push("images", {{"uri", "missing.png"}});
    glb.push("textures", {{"source", 0}});
    glb.push("materials", {{"normalTexture", {{"index", 0}, {"texCoord", 3}}}});
    const json list = {{"attributes", attributes}, {"material", 0}};
    json strip = list, fan = list, points = list;
    strip["mode"] = 5;
    strip["indices"] = glb.accessor(std::vector<uint8_t>{0, 1, 2, 3, 4}, kUbyte, "SCALAR", 5);
    fan["mode"] = 6;
    fan["indices"] = glb.accessor(std::vector<uint32_t>{4, 2, 1, 0}, kUint, "SCALAR", 4);
    points["mode"] = 0;
    glb.push("meshes", {{"primitives", {strip, fan, list, points}}});
    glb.push("nodes", {{"mesh", 0}});
    return glb;
}

/// Text with a data URI, a buffer and a picture beside it, and two scenes.
std::string text_gltf() {
    GlbBuilder glb;
    glb.triangle();
    glb.json["buffers"] = {
        {{"byteLength", 36},
         {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}},
        {{"byteLength", 36}, {"uri", "a.bin"}}};
    glb.push("bufferViews", {{"buffer", 1}, {"byteLength", 36}});
    glb.mesh({{"attributes", {{"POSITION", glb.accessor_of(1, kFloat, "VEC3", 3)}}}, {"material", 0}});
    glb.push("images", {{"uri", "a.png"}, {"name", "a"}});
    glb.push("images", {{"uri", "./a.png"}});
    glb.push("textures", {{"source", 1}});
    glb.push("materials", {{"emissiveTexture", {{"index", 0}, {"texCoord", 1}}}});
    glb.push("nodes", {{"children", {2}}});
    glb.push("nodes", {{"mesh", 1}, {"weights", json::array()}});
    glb.push("scenes", {{"nodes", {0}}});
    glb.push("scenes", {{"nodes", {1}}});
    glb.json["scene"] = 1;
    return glb.json.dump();
}

}  // namespace

std::vector<std::string> gltf_seeds() {
    return {still_glb(),       rigid_glb(),        skinned_glb(),         morphed_glb(), arbitrary_glb(),
            instanced().glb(), primitives().glb(), make_rich_glb().glb(), text_gltf()};
}

std::vector<std::string> image_seeds() {
    std::vector<std::string> seeds = {png(1, 1), png(9, 7), png(16, 16)};
    const std::filesystem::path kept = std::filesystem::path(ZOETROPE_SOURCE_DIR) / "tests/fuzz/seeds";
    for (const char* name : {"a.jpg", "a.webp", "a.hdr", "lines.exr", "tiled.exr"}) seeds.push_back(read_bytes(kept / name));
    return seeds;
}

std::vector<std::string> sequence_seeds() {
    const std::vector<std::string> files = gltf_seeds();
    std::vector<std::string> seeds;
    for (size_t k = 0; k < files.size(); ++k) {
        if (!files[k].starts_with("glTF")) continue;
        const std::string pair[] = {files[k], files[k == 6 ? 2 : 6]};
        seeds.push_back(join_sequence(std::span(pair).first(k % 3 == 0 ? 1 : 2)));
    }
    return seeds;
}

}  // namespace zoe::test
