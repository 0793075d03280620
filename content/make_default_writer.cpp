#include "content/make_default_writer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>

namespace zoe {
namespace {

using nlohmann::json;

constexpr int kByte = 5120, kUnsignedByte = 5121, kUnsignedShort = 5123, kFloat = 5126;
constexpr int kVertices = 34962, kIndices = 34963;

// Seven digits are enough for centimetres, and short in text.
double shortened(float value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.7g", static_cast<double>(value));
    return std::strtod(text, nullptr);
}

json array_of(const glm::vec3& v) {
    return {shortened(v.x), shortened(v.y), shortened(v.z)};
}

std::span<const float> flat(std::span<const glm::vec3> values) {
    return {&values.data()->x, values.size() * 3};
}

template <typename T>
T quantize(float value, float scale) {
    return static_cast<T>(std::lround(value * scale));
}

template <typename T>
std::span<const uint8_t> bytes_of(std::span<const T> values) {
    return {reinterpret_cast<const uint8_t*>(values.data()), values.size_bytes()};
}

}  // namespace

GlbWriter::GlbWriter() {
    json_ = {{"asset", {{"version", "2.0"}, {"generator", "Zoetrope make_default_glb"}, {"copyright", "CC0"}}},
             {"scene", 0},
             {"scenes", json::array({{{"name", "room"}, {"nodes", json::array()}}})},
             {"nodes", json::array()},
             {"meshes", json::array()},
             {"materials", json::array()},
             {"accessors", json::array()},
             {"bufferViews", json::array()},
             {"animations", json::array({{{"name", "loop"}, {"channels", json::array()}, {"samplers", json::array()}}})}};
}

MaterialId GlbWriter::material(const std::string& name, const glm::vec3& color, const json& more) {
    // Double-sided: all these meshes are solid, and a shadow ray may then stop at the first triangle that it meets.
    json m = {{"name", name},
              {"doubleSided", true},
              {"pbrMetallicRoughness",
               {{"baseColorFactor", {shortened(color.x), shortened(color.y), shortened(color.z), 1.0f}},
                {"metallicFactor", 0},
                {"roughnessFactor", 0.8}}}};
    if (!more.is_null()) m.merge_patch(more);
    json_["materials"].push_back(m);
    return MaterialId{static_cast<uint32_t>(json_["materials"].size() - 1)};
}

int GlbWriter::texture(const std::string& name, std::span<const uint8_t> png) {
    json_["images"].push_back({{"name", name}, {"mimeType", "image/png"}, {"bufferView", view(png, 0, 0)}});
    json_["textures"].push_back({{"source", json_["images"].size() - 1}});
    return static_cast<int>(json_["textures"].size() - 1);
}

int GlbWriter::mesh(const std::string& name, const Mesh& mesh, const Trs* cube) {
    json attributes;
    const size_t count = mesh.positions.size();
    if (cube != nullptr) {
        std::vector<uint16_t> values;
        for (const glm::vec3& p : mesh.positions) {
            const glm::vec3 q = glm::clamp((p - cube->translation) / cube->scale, 0.0f, 1.0f);
            for (int k = 0; k < 3; ++k) values.push_back(quantize<uint16_t>(q[k], 65535.0f));
        }
        attributes["POSITION"] = packed<uint16_t>(values, 3, kUnsignedShort, "VEC3", true);
        json lo = json::array(), hi = json::array();
        for (size_t k = 0; k < 3; ++k) {
            uint16_t least = 65535, most = 0;
            for (size_t v = k; v < values.size(); v += 3)
                least = std::min(least, values[v]), most = std::max(most, values[v]);
            lo.push_back(least);
            hi.push_back(most);
        }
        json& a = json_["accessors"].back();
        a["min"] = lo;
        a["max"] = hi;
    } else {
        attributes["POSITION"] = floats(flat(mesh.positions), "VEC3", true, kVertices);
    }
    if (!mesh.normals.empty()) {
        std::vector<int8_t> values;
        for (const glm::vec3& n : mesh.normals) {
            for (int k = 0; k < 3; ++k) values.push_back(quantize<int8_t>(n[k], 127.0f));
        }
        attributes["NORMAL"] = packed<int8_t>(values, 3, kByte, "VEC3", true);
    }
    if (!mesh.uvs[0].empty()) {
        attributes["TEXCOORD_0"] = floats({&mesh.uvs[0].data()->x, count * 2}, "VEC2", false, kVertices);
    }
    if (!mesh.colors.empty()) {
        std::vector<uint16_t> values;
        for (const glm::vec4& c : mesh.colors) {
            for (int k = 0; k < 4; ++k) values.push_back(quantize<uint16_t>(glm::clamp(c[k], 0.0f, 1.0f), 65535.0f));
        }
        attributes["COLOR_0"] = packed<uint16_t>(values, 4, kUnsignedShort, "VEC4", true);
    }
    if (mesh.binding.influence_count == 4) {
        std::vector<uint8_t> joints(mesh.binding.joints.begin(), mesh.binding.joints.end());
        attributes["JOINTS_0"] = packed<uint8_t>(joints, 4, kUnsignedByte, "VEC4", false);
        std::vector<uint16_t> weights;
        for (size_t v = 0; v < count; ++v) {  // They sum to exactly 65535: the first takes what rounding leaves over.
            uint16_t rest[4];
            int sum = 0;
            for (size_t k = 1; k < 4; ++k) sum += rest[k] = quantize<uint16_t>(mesh.binding.weights[v * 4 + k], 65535.0f);
            rest[0] = static_cast<uint16_t>(65535 - sum);
            weights.insert(weights.end(), rest, rest + 4);
        }
        attributes["WEIGHTS_0"] = packed<uint16_t>(weights, 4, kUnsignedShort, "VEC4", true);
    }
    json targets = json::array();
    for (const MorphTarget& target : mesh.targets) {
        json t = {{"POSITION", floats(flat(target.positions), "VEC3", true, kVertices)}};
        if (!target.normals.empty()) t["NORMAL"] = floats(flat(target.normals), "VEC3", false, kVertices);
        targets.push_back(t);
    }
    // One primitive a material; they share the vertices.
    std::map<uint32_t, std::vector<glm::uvec3>> corners_of_material;
    for (const MaterialRange& range : mesh.materials) {
        auto& corners = corners_of_material[index(range.material)];
        corners.insert(corners.end(), mesh.corners.begin() + range.begin, mesh.corners.begin() + range.end);
    }
    json primitives = json::array();
    for (const auto& [material_index, corners] : corners_of_material) {
        int indices = 0;
        const std::span<const uint32_t> wide(&corners.data()->x, corners.size() * 3);
        if (count <= 65535) {
            const std::vector<uint16_t> narrow(wide.begin(), wide.end());
            indices =
                accessor(view(bytes_of(std::span(narrow)), 0, kIndices), narrow.size(), kUnsignedShort, "SCALAR", false);
        } else {
            indices = accessor(view(bytes_of(wide), 0, kIndices), wide.size(), 5125, "SCALAR", false);
        }
        json primitive = {{"attributes", attributes}, {"indices", indices}};
        if (MaterialId{material_index} != kNone<MaterialId>) primitive["material"] = material_index;
        if (!targets.empty()) primitive["targets"] = targets;
        primitives.push_back(primitive);
    }
    json m = {{"name", name}, {"primitives", primitives}};
    if (!targets.empty()) m["weights"] = mesh.default_weights;
    json_["meshes"].push_back(m);
    return static_cast<int>(json_["meshes"].size() - 1);
}

int GlbWriter::node(const std::string& name, int parent, const Trs& local, int mesh, const json& more) {
    json n = {{"name", name}};
    if (local.translation != glm::vec3(0.0f)) n["translation"] = array_of(local.translation);
    if (local.rotation != glm::quat(1, 0, 0, 0)) {
        n["rotation"] = {shortened(local.rotation.x), shortened(local.rotation.y), shortened(local.rotation.z),
                         shortened(local.rotation.w)};
    }
    if (local.scale != glm::vec3(1.0f)) n["scale"] = array_of(local.scale);
    if (mesh >= 0) n["mesh"] = mesh;
    if (!more.is_null()) n.merge_patch(more);
    json_["nodes"].push_back(n);
    const int index = static_cast<int>(json_["nodes"].size() - 1);
    (parent < 0 ? json_["scenes"][0]["nodes"] : json_["nodes"][static_cast<size_t>(parent)]["children"]).push_back(index);
    return index;
}

int GlbWriter::node(const std::string& name, int parent, const glm::vec3& translation, int mesh) {
    return node(name, parent, Trs{.translation = translation}, mesh);
}

int GlbWriter::skin(const std::string& name, std::span<const int> joints, std::span<const Affine> joint_from_mesh) {
    std::vector<float> values;
    for (const Affine& m : joint_from_mesh) {
        for (int c = 0; c < 4; ++c) {
            const glm::vec3 column = c < 3 ? m.linear[c] : m.translation;
            values.insert(values.end(), {column.x, column.y, column.z, c < 3 ? 0.0f : 1.0f});
        }
    }
    const std::vector<int> list(joints.begin(), joints.end());
    json_["skins"].push_back({{"name", name},
                              {"joints", list},
                              {"skeleton", list.front()},
                              {"inverseBindMatrices", floats(values, "MAT4", false, 0)}});
    return static_cast<int>(json_["skins"].size() - 1);
}

void GlbWriter::animate(int node, const std::string& path, const Sampler& sampler) {
    json& clip = json_["animations"][0];
    auto [entry, is_new] = times_.try_emplace(sampler.times_s, 0);
    if (is_new) entry->second = floats(sampler.times_s, "SCALAR", true, 0);
    const char* interpolation = sampler.interpolation == Interpolation::kStep     ? "STEP"
                                : sampler.interpolation == Interpolation::kLinear ? "LINEAR"
                                                                                  : "CUBICSPLINE";
    const char* type = path == "weights" ? "SCALAR" : path == "rotation" ? "VEC4" : "VEC3";
    const int output = floats(sampler.values, type, false, 0);
    clip["samplers"].push_back({{"input", entry->second}, {"output", output}, {"interpolation", interpolation}});
    clip["channels"].push_back({{"sampler", clip["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

void GlbWriter::spin(int node, const glm::vec3& axis, int turns, float degrees) {
    Sampler sampler{.is_rotation = true, .width = 4};
    const int keys = 4 * std::abs(turns);  // A quarter turn apart: the short way is the right way.
    for (int k = 0; k <= keys; ++k) {
        const double share = static_cast<double>(k) / keys;
        const double half = 0.5 * degrees * std::numbers::pi / 180.0 + std::numbers::pi * turns * share;
        const glm::vec3 v = static_cast<float>(std::sin(half)) * axis;
        sampler.times_s.push_back(static_cast<float>(share * kDuration_s));
        sampler.values.insert(sampler.values.end(), {v.x, v.y, v.z, static_cast<float>(std::cos(half))});
    }
    animate(node, "rotation", sampler);
}

int GlbWriter::view(std::span<const uint8_t> bytes, int stride, int target) {
    json v = {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) v["byteStride"] = stride;
    if (target > 0) v["target"] = target;
    bin_.insert(bin_.end(), bytes.begin(), bytes.end());
    bin_.resize((bin_.size() + 3) / 4 * 4);
    json_["bufferViews"].push_back(v);
    return static_cast<int>(json_["bufferViews"].size() - 1);
}

int GlbWriter::accessor(int view, size_t count, int component_type, const char* type, bool is_normalized) {
    json a = {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}};
    if (is_normalized) a["normalized"] = true;
    json_["accessors"].push_back(a);
    return static_cast<int>(json_["accessors"].size() - 1);
}

int GlbWriter::floats(std::span<const float> values, const char* type, bool has_bounds, int target) {
    const std::map<std::string, size_t> widths = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    const size_t width = widths.at(type);
    const int a = accessor(view(bytes_of(values), 0, target), values.size() / width, kFloat, type, false);
    if (has_bounds) {
        std::vector<float> lo(values.begin(), values.begin() + static_cast<ptrdiff_t>(width)), hi = lo;
        for (size_t i = 0; i < values.size(); ++i) {
            lo[i % width] = std::min(lo[i % width], values[i]);
            hi[i % width] = std::max(hi[i % width], values[i]);
        }
        json_["accessors"].back()["min"] = lo;
        json_["accessors"].back()["max"] = hi;
    }
    return a;
}

template <typename T>
int GlbWriter::packed(std::span<const T> values, size_t width, int component_type, const char* type, bool is_normalized) {
    const size_t stride = (width * sizeof(T) + 3) / 4 * 4, count = values.size() / width;
    std::vector<uint8_t> bytes(stride * count);
    for (size_t i = 0; i < count; ++i) std::memcpy(&bytes[i * stride], &values[i * width], width * sizeof(T));
    return accessor(view(bytes, static_cast<int>(stride), kVertices), count, component_type, type, is_normalized);
}

void GlbWriter::write(const std::filesystem::path& file) {
    json_["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_mesh_quantization"};
    json_["extensionsRequired"] = {"KHR_mesh_quantization"};
    json_["buffers"] = json::array({{{"byteLength", bin_.size()}}});
    std::string text = json_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<uint8_t> glb;
    const auto put = [&](size_t value) {
        for (int shift = 0; shift < 32; shift += 8) glb.push_back(static_cast<uint8_t>(value >> shift));
    };
    put(0x46546c67);
    put(2);
    put(12 + 8 + text.size() + 8 + bin_.size());
    put(text.size());
    put(0x4e4f534a);
    glb.insert(glb.end(), text.begin(), text.end());
    put(bin_.size());
    put(0x004e4942);
    glb.insert(glb.end(), bin_.begin(), bin_.end());
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(glb.data()), static_cast<std::streamsize>(glb.size()));
    if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace zoe
