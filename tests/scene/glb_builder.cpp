#include "tests/scene/glb_builder.h"

#include <fstream>
#include <stdexcept>

namespace zoe::test {

void write_file(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out) throw std::runtime_error("cannot write " + file.string());
}

int GlbBuilder::push(const char* array, nlohmann::json value) {
    json[array].push_back(std::move(value));
    return static_cast<int>(json[array].size()) - 1;
}

int GlbBuilder::view(const void* data, size_t size, int stride) {
    while (binary.size() % 4 != 0) binary.push_back('\0');
    const size_t offset = binary.size();
    binary.append(static_cast<const char*>(data), size);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
    if (stride != 0) view["byteStride"] = stride;
    return push("bufferViews", view);
}

int GlbBuilder::accessor_of(int view, int component_type, const char* type, size_t count, bool is_normalized) {
    nlohmann::json accessor = {{"componentType", component_type}, {"type", type}, {"count", count}};
    if (view >= 0) accessor["bufferView"] = view;
    if (is_normalized) accessor["normalized"] = true;
    return push("accessors", accessor);
}

int GlbBuilder::floats(const std::vector<float>& values, const char* type) {
    const std::string name = type;
    const size_t width = name == "SCALAR" ? 1 : name == "MAT4" ? 16 : static_cast<size_t>(name.back() - '0');
    return accessor(values, kFloat, type, values.size() / width);
}

int GlbBuilder::triangle() {
    const int positions = floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    return push("nodes", {{"mesh", mesh({{"attributes", {{"POSITION", positions}}}})}});
}

std::string GlbBuilder::glb() const {
    nlohmann::json root = json;
    std::string data = binary;
    while (data.size() % 4 != 0) data.push_back('\0');
    if (!data.empty() && !root.contains("buffers")) root["buffers"] = {{{"byteLength", data.size()}}};
    std::string text = root.dump();
    while (text.size() % 4 != 0) text.push_back(' ');
    std::string out;
    const auto put = [&](size_t value) {
        for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(value >> (8 * i) & 0xff));
    };
    put(0x46546C67);
    put(2);
    put(12 + 8 + text.size() + (data.empty() ? 0 : 8 + data.size()));
    put(text.size());
    put(0x4E4F534A);
    out += text;
    if (data.empty()) return out;
    put(data.size());
    put(0x004E4942);
    return out + data;
}

Scene GlbBuilder::load(const GltfOptions& options) const {
    const TempFolder folder;
    write_file(folder / "scene.glb", glb());
    return load_gltf(folder / "scene.glb", options);
}

std::string GlbBuilder::error() const {
    const TempFolder folder;
    write_file(folder / "scene.glb", glb());
    return load_error(folder / "scene.glb");
}

std::string load_error(const std::filesystem::path& file) {
    try {
        load_gltf(file);
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

GlbBuilder make_rich_glb() {
    GlbBuilder glb;
    const int positions = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
    const int normals = glb.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int indices = glb.accessor(std::vector<uint16_t>{0, 1, 2, 1, 3, 2}, kUshort, "SCALAR", 6);
    const int joints = glb.accessor(std::vector<uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, kUbyte, "VEC4", 4);
    const int weights = glb.floats({1, 0, 0, 0, .5f, .5f, 0, 0, 0, 1, 0, 0, .25f, .75f, 0, 0}, "VEC4");
    const int target = glb.accessor_of(-1, kFloat, "VEC3", 4);
    const std::vector<uint16_t> sparse_indices{1, 3};
    const std::vector<float> sparse_values{0, 0, 1, 0, 0, 2};
    glb.json["accessors"][static_cast<size_t>(target)]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", glb.view(sparse_indices.data(), 4)}, {"componentType", kUshort}}},
        {"values", {{"bufferView", glb.view(sparse_values.data(), 24)}}}};
    glb.push("images", {{"bufferView", glb.view("\x89PNG", 4)}});
    glb.push("textures", {{"source", 0}});
    glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    nlohmann::json primitive = {
        {"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}},
        {"indices", indices},
        {"material", 0},
        {"targets", {{{"POSITION", target}}}}};
    glb.mesh(primitive);
    glb.push("skins", {{"joints", {1, 2}}});
    glb.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
    glb.json["extensionsUsed"] = {"KHR_lights_punctual"};
    glb.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 40}}};
    glb.push("nodes", {{"mesh", 0}, {"skin", 0}, {"camera", 0}});
    glb.push("nodes", {{"children", {2}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    glb.push("nodes", {{"translation", {0, 1, 0}}});
    glb.push("scenes", {{"nodes", {0, 1}}});
    glb.json["scene"] = 0;
    const int times = glb.floats({0, 1}, "SCALAR");
    const int rotations = glb.floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4");
    const int morphs = glb.floats({0, 1}, "SCALAR");
    glb.push("animations",
             {{"samplers", {{{"input", times}, {"output", rotations}}, {{"input", times}, {"output", morphs}}}},
              {"channels",
               {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
                {{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}}}}});
    return glb;
}

}  // namespace zoe::test
