#include "tests/support/gltf_document.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/support/gltf_accessors.h"
#include "tests/support/gltf_container.h"

namespace zoe::test {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& reason) {
    throw std::runtime_error("oracle: " + reason);
}

std::vector<glm::dvec3> read_points(const GltfAccessors& accessors, int index) {
    const AccessorArray array = accessors.read(index);
    if (array.width != 3) refuse("a position that is not a VEC3");
    std::vector<glm::dvec3> points(array.count());
    for (size_t i = 0; i < points.size(); ++i) points[i] = array.vec3(i);
    return points;
}

std::vector<std::array<uint32_t, 3>> read_corners(const GltfAccessors& accessors, const Json& primitive,
                                                  size_t vertex_count) {
    std::vector<uint32_t> order(vertex_count);
    for (uint32_t i = 0; i < vertex_count; ++i) order[i] = i;
    if (primitive.contains("indices")) {
        const AccessorArray array = accessors.read(primitive["indices"].get<int>());
        order.assign(array.values.begin(), array.values.end());
        for (const uint32_t index : order) {
            if (index >= vertex_count) refuse("a vertex index is too high");
        }
    }
    std::vector<std::array<uint32_t, 3>> corners;
    const int mode = primitive.value("mode", 4);
    const size_t count = order.size();
    if (mode == 4) {
        for (size_t i = 0; i + 2 < count; i += 3) corners.push_back({order[i], order[i + 1], order[i + 2]});
    } else if (mode == 5) {
        for (size_t i = 0; i + 2 < count; ++i) corners.push_back({order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]});
    } else if (mode == 6) {
        for (size_t i = 0; i + 2 < count; ++i) corners.push_back({order[i + 1], order[i + 2], order[0]});
    }
    return corners;
}

DocumentPrimitive read_primitive(const GltfAccessors& accessors, const Json& json) {
    DocumentPrimitive primitive;
    const Json& attributes = json.at("attributes");
    if (!attributes.contains("POSITION")) return primitive;
    primitive.positions = read_points(accessors, attributes["POSITION"].get<int>());
    const size_t vertex_count = primitive.positions.size();
    primitive.corners = read_corners(accessors, json, vertex_count);
    for (const Json& target : json.value("targets", Json::array())) {
        primitive.targets.emplace_back();
        if (target.contains("POSITION")) primitive.targets.back() = read_points(accessors, target["POSITION"].get<int>());
    }
    std::vector<AccessorArray> joints, weights;
    for (int set = 0; attributes.contains("JOINTS_" + std::to_string(set)); ++set) {
        joints.push_back(accessors.read(attributes["JOINTS_" + std::to_string(set)].get<int>()));
        weights.push_back(accessors.read(attributes.at("WEIGHTS_" + std::to_string(set)).get<int>()));
        primitive.influence_count += 4;
    }
    for (size_t v = 0; v < vertex_count; ++v) {
        for (size_t set = 0; set < joints.size(); ++set) {
            for (size_t k = 0; k < 4; ++k) {
                primitive.joints.push_back(static_cast<uint32_t>(joints[set].values.at(4 * v + k)));
                primitive.weights.push_back(weights[set].values.at(4 * v + k));
            }
        }
    }
    return primitive;
}

glm::dvec3 vec3_or(const Json& object, const char* key, const glm::dvec3& otherwise) {
    if (!object.contains(key)) return otherwise;
    const std::array<double, 3> v = object[key].get<std::array<double, 3>>();
    return {v[0], v[1], v[2]};
}

std::vector<AffineDouble> read_instances(const GltfAccessors& accessors, const Json& extension) {
    AccessorArray translations, rotations, scales;
    size_t count = 0;
    const Json& attributes = extension.at("attributes");
    const auto read = [&](const char* name, AccessorArray* array) {
        if (!attributes.contains(name)) return;
        *array = accessors.read(attributes[name].get<int>());
        count = array->count();
    };
    read("TRANSLATION", &translations);
    read("ROTATION", &rotations);
    read("SCALE", &scales);
    std::vector<AffineDouble> instances(count);
    for (size_t i = 0; i < count; ++i) {
        const glm::dvec3 translation = translations.width != 0 ? translations.vec3(i) : glm::dvec3(0.0);
        const glm::dvec3 scale = scales.width != 0 ? scales.vec3(i) : glm::dvec3(1.0);
        Quaternion rotation;
        if (rotations.width != 0) {
            const double* q = &rotations.values[4 * i];
            rotation = {q[0], q[1], q[2], q[3]};
        }
        instances[i] = from_trs(translation, rotation, scale);
    }
    return instances;
}

DocumentNode read_node(const GltfAccessors& accessors, const Json& json) {
    DocumentNode node;
    node.mesh = json.value("mesh", -1);
    node.skin = json.value("skin", -1);
    if (json.contains("matrix")) node.matrix = from_columns(json["matrix"].get<std::array<double, 16>>());
    node.translation = vec3_or(json, "translation", glm::dvec3(0.0));
    node.scale = vec3_or(json, "scale", glm::dvec3(1.0));
    if (json.contains("rotation")) {
        const std::array<double, 4> q = json["rotation"].get<std::array<double, 4>>();
        node.rotation = {q[0], q[1], q[2], q[3]};
    }
    node.weights = json.value("weights", std::vector<double>());
    const Json extensions = json.value("extensions", Json::object());
    if (extensions.contains("EXT_mesh_gpu_instancing")) {
        node.has_instances = true;
        node.instances = read_instances(accessors, extensions["EXT_mesh_gpu_instancing"]);
    }
    return node;
}

void read_nodes(const Json& root, const GltfAccessors& accessors, Document* document) {
    for (const Json& json : root.value("nodes", Json::array())) document->nodes.push_back(read_node(accessors, json));
    for (size_t i = 0; i < document->nodes.size(); ++i) {
        for (const int child : root["nodes"][i].value("children", std::vector<int>())) {
            document->nodes.at(static_cast<size_t>(child)).parent = static_cast<int>(i);
        }
    }
    // Shown is what hangs below the default scene's roots; without scenes, everything.
    if (!root.contains("scenes")) {
        for (DocumentNode& node : document->nodes) node.is_shown = true;
        return;
    }
    const Json& scene = root["scenes"].at(root.value("scene", size_t{0}));
    std::vector<int> open = scene.value("nodes", std::vector<int>());
    while (!open.empty()) {
        const size_t i = static_cast<size_t>(open.back());
        open.pop_back();
        document->nodes.at(i).is_shown = true;
        for (const int child : root["nodes"][i].value("children", std::vector<int>())) open.push_back(child);
    }
}

void read_skins(const Json& root, const GltfAccessors& accessors, Document* document) {
    for (const Json& json : root.value("skins", Json::array())) {
        DocumentSkin skin;
        skin.joints = json.at("joints").get<std::vector<int>>();
        skin.inverse_bind.resize(skin.joints.size());
        if (json.contains("inverseBindMatrices")) {
            const AccessorArray array = accessors.read(json["inverseBindMatrices"].get<int>());
            for (size_t i = 0; i < skin.joints.size(); ++i) {
                std::array<double, 16> columns;
                std::copy_n(&array.values.at(16 * i), 16, columns.begin());
                skin.inverse_bind[i] = from_columns(columns);
            }
        }
        document->skins.push_back(std::move(skin));
    }
}

void read_clips(const Json& root, const GltfAccessors& accessors, Document* document) {
    for (const Json& json : root.value("animations", Json::array())) {
        DocumentClip clip;
        clip.name = json.value("name", "");
        for (const Json& channel_json : json.at("channels")) {
            const Json& sampler = json.at("samplers").at(channel_json.at("sampler").get<size_t>());
            DocumentChannel channel;
            channel.node = channel_json.at("target").value("node", -1);
            channel.path = channel_json.at("target").at("path").get<std::string>();
            channel.interpolation = sampler.value("interpolation", "LINEAR");
            channel.times_s = accessors.read(sampler.at("input").get<int>()).values;
            channel.values = accessors.read(sampler.at("output").get<int>()).values;
            const size_t key_count = channel.times_s.size();
            if (key_count == 0) refuse("an animation without keys");
            channel.width = static_cast<uint32_t>(channel.values.size() /
                                                  (key_count * (channel.interpolation == "CUBICSPLINE" ? 3 : 1)));
            clip.duration_s = std::max(clip.duration_s, channel.times_s.back());
            clip.channels.push_back(std::move(channel));
        }
        document->clips.push_back(std::move(clip));
    }
}

}  // namespace

Document read_document(const std::filesystem::path& file) {
    GltfContainer container = read_container(file);
    const Json root = Json::parse(container.json);
    const GltfAccessors accessors(root, file.parent_path(), std::move(container.binary));
    Document document;
    for (const Json& mesh_json : root.value("meshes", Json::array())) {
        DocumentMesh mesh;
        for (const Json& primitive : mesh_json.at("primitives")) {
            mesh.primitives.push_back(read_primitive(accessors, primitive));
        }
        mesh.weights = mesh_json.value("weights", std::vector<double>());
        document.meshes.push_back(std::move(mesh));
    }
    read_nodes(root, accessors, &document);
    read_skins(root, accessors, &document);
    read_clips(root, accessors, &document);
    return document;
}

}  // namespace zoe::test
