#include "tests/apps/small_scene.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace zoe::test {

using Json = nlohmann::json;

Json small_scene() {
    return Json::parse(R"({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [
            {"name": "turning", "mesh": 0},
            {"name": "resting", "mesh": 0, "translation": [0, -1.5, 0]},
            {"name": "front", "camera": 0, "translation": [0, 0, 5]}
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "animations": [{
            "name": "turn",
            "samplers": [{"input": 1, "output": 2}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}}]
        }],
        "buffers": [{"uri": "scene.bin", "byteLength": 76}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 8},
            {"buffer": 0, "byteOffset": 44, "byteLength": 32}
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC4"}
        ]
    })");
}

std::string small_buffer(float first_x) {
    const float half = 0.70710678f;
    const float values[] = {first_x, 0, 0, 1, 0, 0,    0, 1,   0,  // corners
                            0,       1,                            // key times
                            0,       0, 0, 1, 0, half, 0, half};   // rotations, xyzw
    return {reinterpret_cast<const char*>(values), sizeof values};
}

void write_small_scene(const TempFolder& folder, const Json& json) {
    folder.write("scene.gltf", json.dump());
    folder.write("scene.bin", small_buffer());
}

std::string small_glb() {
    Json json = small_scene();
    json["buffers"][0].erase("uri");
    std::string text = json.dump(), bytes = small_buffer();
    json["buffers"][0]["byteLength"] = bytes.size();
    text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string glb;
    const auto put = [&](uint32_t value) {
        char raw[4];
        std::memcpy(raw, &value, 4);
        glb.append(raw, 4);
    };
    put(0x46546c67);  // "glTF"
    put(2);
    put(static_cast<uint32_t>(12 + 8 + text.size() + 8 + bytes.size()));
    put(static_cast<uint32_t>(text.size()));
    put(0x4e4f534a);  // "JSON"
    glb += text;
    put(static_cast<uint32_t>(bytes.size()));
    put(0x004e4942);  // "BIN"
    return glb + bytes;
}

std::vector<std::string> small_pictures(const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"scene.gltf", "--headless", "--size", "48x32", "--spp", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

std::set<float> channel_values(const FloatImage& image, const std::string& name) {
    const auto found = std::ranges::find(image.channels, name);
    std::set<float> values;
    if (found == image.channels.end()) return values;
    const auto channel = static_cast<size_t>(found - image.channels.begin());
    for (size_t i = channel; i < image.values.size(); i += image.channels.size()) values.insert(image.values[i]);
    return values;
}

}  // namespace zoe::test
