#include "engine/scene/gltf_primitive.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace zoe {
namespace {

constexpr int kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The accessor of an attribute, -1 for none; refused where its count is another than the positions'.
int find_attribute(const GltfFile& file, const std::map<std::string, int>& attributes, const std::string& name,
                   uint64_t vertex_count, const std::string& place) {
    const auto found = attributes.find(name);
    if (found == attributes.end()) return -1;
    const uint64_t count = file.model.accessors[static_cast<size_t>(found->second)].count;
    if (count != vertex_count) {
        file.fail(place + "/" + name, fmt::format("{} elements, where POSITION has {}", count, vertex_count));
    }
    return found->second;
}

template <typename Vector>
std::vector<Vector> to_vectors(const std::vector<float>& floats) {
    std::vector<Vector> out(floats.size() / Vector::length());
    for (size_t i = 0; i < floats.size(); ++i) out[i / Vector::length()][static_cast<int>(i % Vector::length())] = floats[i];
    return out;
}

template <typename Vector>
bool is_finite(const Vector& v) {
    for (int i = 0; i < Vector::length(); ++i) {
        if (!std::isfinite(v[i])) return false;
    }
    return true;
}

/// Appends an optional attribute. `first`: how many vertices stood in the mesh before this primitive.
template <typename Vector>
void append(std::vector<Vector>& to, std::vector<Vector> from, size_t first, size_t count, const Vector& missing,
            const char* what, Scene& scene) {
    if (to.empty() && from.empty()) return;
    for (Vector& value : from) {
        if (is_finite(value)) continue;
        scene.warn(std::string("a vertex with a ") + what + " that is not finite");
        value = missing;
    }
    to.resize(first, missing);
    to.insert(to.end(), from.begin(), from.end());
    to.resize(first + count, missing);
}

std::vector<glm::vec4> read_colors(GltfFile& file, int accessor, GltfRange range, const std::string& place, Scene& scene) {
    require_type(file, accessor, {TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4}, place);
    const uint32_t width = component_count(file, accessor);
    const std::vector<float> floats = read_floats(file, accessor, range, true);
    std::vector<glm::vec4> colors(floats.size() / width, glm::vec4(1.0f));
    bool is_clamped = false;
    for (size_t i = 0; i < floats.size(); ++i) {
        const float value = floats[i];
        const float clamped = std::isnan(value) ? kNan : std::clamp(value, 0.0f, 1.0f);
        is_clamped |= clamped < value || clamped > value;
        colors[i / width][static_cast<int>(i % width)] = clamped;
    }
    if (is_clamped) scene.warn("vertex colours outside 0 to 1: clamped");
    return colors;
}

/// Gives every vertex room for more influences.
void widen(SkinBinding& binding, size_t vertex_count, uint32_t new_count) {
    SkinBinding wide{new_count, std::vector<uint16_t>(new_count * vertex_count, 0),
                     std::vector<float>(new_count * vertex_count, 0.0f)};
    for (size_t v = 0; v < vertex_count; ++v) {
        for (uint32_t i = 0; i < binding.influence_count; ++i) {
            wide.joints[v * new_count + i] = binding.joints[v * binding.influence_count + i];
            wide.weights[v * new_count + i] = binding.weights[v * binding.influence_count + i];
        }
    }
    binding = std::move(wide);
}

/// Appends JOINTS_n and WEIGHTS_n. All vertices of a mesh get the same number of influences.
void append_binding(GltfFile& file, const tinygltf::Primitive& primitive, GltfRange range, uint64_t vertex_count,
                    size_t first, const std::string& place, SkinBinding& binding) {
    const size_t count = range.end - range.begin;
    uint32_t set_count = 0;
    while (primitive.attributes.contains(fmt::format("JOINTS_{}", set_count)) ||
           primitive.attributes.contains(fmt::format("WEIGHTS_{}", set_count))) {
        ++set_count;
    }
    const uint32_t old_count = binding.influence_count;
    const uint32_t new_count = std::max(old_count, 4 * set_count);
    if (new_count == 0) return;
    file.spend(uint64_t{new_count} * count + uint64_t{new_count - old_count} * first, place);
    if (new_count != old_count) widen(binding, first, new_count);
    std::vector<uint16_t>& joints = binding.joints;
    std::vector<float>& weights = binding.weights;
    joints.resize(new_count * (first + count), 0);
    weights.resize(new_count * (first + count), 0.0f);
    for (uint32_t set = 0; set < set_count; ++set) {
        const std::string joints_name = fmt::format("JOINTS_{}", set), weights_name = fmt::format("WEIGHTS_{}", set);
        const int joints_accessor = find_attribute(file, primitive.attributes, joints_name, vertex_count, place);
        const int weights_accessor = find_attribute(file, primitive.attributes, weights_name, vertex_count, place);
        if (joints_accessor < 0 || weights_accessor < 0) {
            file.fail(place, joints_name + " and " + weights_name + " need each other");
        }
        require_type(file, joints_accessor, {TINYGLTF_TYPE_VEC4}, place + "/" + joints_name);
        require_type(file, weights_accessor, {TINYGLTF_TYPE_VEC4}, place + "/" + weights_name);
        const std::vector<uint32_t> set_joints = read_uints(file, joints_accessor, range);
        const std::vector<float> set_weights = read_floats(file, weights_accessor, range, true);
        for (size_t i = 0; i < 4 * count; ++i) {
            const size_t to = (first + i / 4) * new_count + 4 * set + i % 4;
            weights[to] = set_weights[i];
            if (!(std::fabs(weights[to]) > 0.0f)) continue;  // Exporters leave anything in joints without weight.
            if (set_joints[i] > 0xffff) {
                file.fail(place + "/" + joints_name, fmt::format("vertex {} names joint {}", i / 4, set_joints[i]));
            }
            joints[to] = static_cast<uint16_t>(set_joints[i]);
        }
    }
}

/// Offsets of one attribute of one morph target; where they are missing, zeros that stand for the vertices.
void append_offsets(GltfFile& file, const std::map<std::string, int>& target, const char* name, GltfRange range,
                    uint64_t vertex_count, size_t first, const std::string& place, std::vector<glm::vec3>& offsets) {
    const size_t count = range.end - range.begin;
    const int accessor = find_attribute(file, target, name, vertex_count, place);
    if (accessor < 0 && offsets.empty()) return;
    file.spend(3 * (first + count - offsets.size()), place);
    offsets.resize(first, glm::vec3(0.0f));
    if (accessor >= 0) {
        require_type(file, accessor, {TINYGLTF_TYPE_VEC3}, place + "/" + name);
        const std::vector<glm::vec3> values = to_vectors<glm::vec3>(read_floats(file, accessor, range));
        offsets.insert(offsets.end(), values.begin(), values.end());
    }
    offsets.resize(first + count, glm::vec3(0.0f));
}

}  // namespace

std::vector<glm::uvec3> read_corners(GltfFile& file, const tinygltf::Primitive& primitive, uint64_t vertex_count,
                                     const std::string& place, Scene& scene) {
    const int mode = primitive.mode;
    if (mode < kTriangles) {
        scene.warn("a primitive of points or lines: not shown");
        return {};
    }
    std::vector<uint32_t> order;
    if (primitive.indices >= 0) {
        require_type(file, primitive.indices, {TINYGLTF_TYPE_SCALAR}, place + "/indices");
        order = read_uints(file, primitive.indices, whole(file, primitive.indices));
        const int type = file.model.accessors[static_cast<size_t>(primitive.indices)].componentType;
        const uint32_t restart = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 0xffu
                                 : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 0xffffu
                                                                                  : 0xffffffffu;
        for (size_t i = 0; i < order.size(); ++i) {
            if (order[i] == restart && (mode != kTriangles || restart >= vertex_count)) {
                file.fail(place + "/indices",
                          fmt::format("entry {} is the restart value {}, which glTF forbids", i, restart));
            }
            if (order[i] >= vertex_count) {
                file.fail(place + "/indices", fmt::format("entry {} is {}, not below {}", i, order[i], vertex_count));
            }
        }
    } else {
        file.spend(vertex_count, place);
        order.resize(vertex_count);
        for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<uint32_t>(i);
    }

    std::vector<glm::uvec3> corners;
    const size_t count = order.size();
    if (mode == kTriangles) {
        if (count % 3 != 0) scene.warn("a list of triangles whose length is not a multiple of 3: the rest is left out");
        for (size_t i = 0; i + 3 <= count; i += 3) corners.emplace_back(order[i], order[i + 1], order[i + 2]);
    } else if (mode == kTriangleStrip) {
        for (size_t i = 0; i + 3 <= count; ++i) {  // Every other one turns the other way.
            corners.emplace_back(order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]);
        }
    } else if (mode == kTriangleFan) {
        for (size_t i = 1; i + 2 <= count; ++i) corners.emplace_back(order[i], order[i + 1], order[0]);
    }
    if (mode != kTriangles && count < 3) scene.warn("a triangle strip or fan of less than 3 vertices");
    return corners;
}

void append_vertices(GltfFile& file, const tinygltf::Primitive& primitive, GltfRange range, const UvSets& uv_sets,
                     const std::string& place, Mesh& mesh, Scene& scene) {
    const std::string in_attributes = place + "/attributes";
    const int position = primitive.attributes.at("POSITION");
    const uint64_t vertex_count = file.model.accessors[static_cast<size_t>(position)].count;
    const size_t first = mesh.positions.size();
    const size_t count = range.end - range.begin;
    if (first + count > 0xfffffff0u) file.fail(place, "a mesh with more than 2^32 vertices");
    const auto find = [&](const std::string& name) {
        return find_attribute(file, primitive.attributes, name, vertex_count, in_attributes);
    };

    require_type(file, position, {TINYGLTF_TYPE_VEC3}, in_attributes + "/POSITION");
    const auto& used = file.model.extensionsUsed;
    if (!is_float(file, position) && std::find(used.begin(), used.end(), "KHR_mesh_quantization") == used.end()) {
        scene.warn("integer positions without KHR_mesh_quantization");
    }
    const std::vector<glm::vec3> positions = to_vectors<glm::vec3>(read_floats(file, position, range));
    mesh.positions.insert(mesh.positions.end(), positions.begin(), positions.end());

    std::vector<glm::vec3> normals;
    if (const int accessor = find("NORMAL"); accessor >= 0) {
        require_type(file, accessor, {TINYGLTF_TYPE_VEC3}, in_attributes + "/NORMAL");
        normals = to_vectors<glm::vec3>(read_floats(file, accessor, range));
    }
    append(mesh.normals, std::move(normals), first, count, glm::vec3(0.0f), "normal", scene);

    std::vector<glm::vec4> tangents;
    if (const int accessor = find("TANGENT"); accessor >= 0) {
        require_type(file, accessor, {TINYGLTF_TYPE_VEC4}, in_attributes + "/TANGENT");
        tangents = to_vectors<glm::vec4>(read_floats(file, accessor, range));
    }
    append(mesh.tangents, std::move(tangents), first, count, glm::vec4(0.0f), "tangent", scene);

    for (size_t set = 0; set < kMaxUvSets; ++set) {
        if (!uv_sets[set]) continue;
        const std::string name = fmt::format("TEXCOORD_{}", set);
        const int accessor = find(name);
        if (accessor < 0 && mesh.uvs[set].empty()) continue;
        file.spend(2 * (first - mesh.uvs[set].size() + (accessor < 0 ? count : 0)), in_attributes);  // What is filled.
        std::vector<glm::vec2> uvs;
        if (accessor >= 0) {
            require_type(file, accessor, {TINYGLTF_TYPE_VEC2}, in_attributes + "/" + name);
            uvs = to_vectors<glm::vec2>(read_floats(file, accessor, range));
        }
        append(mesh.uvs[set], std::move(uvs), first, count, glm::vec2(0.0f), "texture coordinate", scene);
    }
    std::vector<glm::vec4> colors;
    if (const int accessor = find("COLOR_0"); accessor >= 0) {
        colors = read_colors(file, accessor, range, in_attributes + "/COLOR_0", scene);
    }
    append(mesh.colors, std::move(colors), first, count, glm::vec4(1.0f), "colour", scene);
    append_binding(file, primitive, range, vertex_count, first, in_attributes, mesh.binding);

    for (size_t i = 0; i < primitive.targets.size(); ++i) {
        const std::string in_target = fmt::format("{}/targets/{}", place, i);
        append_offsets(file, primitive.targets[i], "POSITION", range, vertex_count, first, in_target,
                       mesh.targets[i].positions);
        append_offsets(file, primitive.targets[i], "NORMAL", range, vertex_count, first, in_target, mesh.targets[i].normals);
    }
}

}  // namespace zoe
