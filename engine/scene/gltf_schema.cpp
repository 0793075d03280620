#include "engine/scene/gltf_schema.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/scene/gltf_schema_table.h"

namespace zoe {
namespace {

using nlohmann::json;

std::string escaped(const std::string& key) {
    std::string out;
    for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return out;
}

/// Walks the JSON along the table; its depth is the table's, whatever the file holds.
class Checker {
public:
    Checker(const json& root, const std::string& file, Scene& scene) : file_(file), scene_(scene) {
        for (const auto& [key, value] : root.items()) {
            if (value.is_array()) counts_[key] = value.size();
        }
        const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
        if (root.contains(lights) && root[lights].is_array()) counts_["lights"] = root[lights].size();
    }

    void check_members(json& value, std::span<const SchemaMember> members, bool is_extensions) {
        if (!value.is_object()) fail("must be an object");
        if (is_extensions) {
            for (const auto& [key, unused] : value.items()) {
                if (!is_supported_extension(key)) scene_.warn("extension " + key + " is not supported: ignored");
            }
        }
        json kept = json::object();
        for (const SchemaMember& member : members) {
            const auto found = value.find(member.name);
            if (found == value.end()) {
                if (member.is_required) fail(fmt::format("'{}' is missing", member.name));
                continue;
            }
            const size_t length = push(member.name);
            if (check_value(*found, member)) kept[member.name] = std::move(*found);
            place_.resize(length);
        }
        value = std::move(kept);
    }

private:
    /// Returns    false where the value is to be left out.
    bool check_value(json& value, const SchemaMember& member) {
        switch (member.kind) {
            case SchemaKind::kAny:
                return true;
            case SchemaKind::kBool:
                if (!value.is_boolean()) fail("must be true or false");
                return true;
            case SchemaKind::kString:
                if (!value.is_string()) fail("must be a string");
                return true;
            case SchemaKind::kStrings:
                for_each(value, member, [&](json& item) {
                    if (!item.is_string()) fail("must be a string");
                });
                return true;
            case SchemaKind::kOneOf:
                check_one_of(value, member);
                return true;
            case SchemaKind::kNumber:
                check_number(value, member.lo, member.hi);
                return true;
            case SchemaKind::kNumbers:
                for_each(value, member, [&](json& item) { check_number(item, -kFloatMax, kFloatMax); });
                return true;
            case SchemaKind::kInteger:
                check_integer(value, member.lo, member.hi);
                return true;
            case SchemaKind::kIndex:
                check_index(value, member);
                return true;
            case SchemaKind::kIndices:
                for_each(value, member, [&](json& item) { check_index(item, member); });
                return true;
            case SchemaKind::kIndexMap:
                check_index_map(value, member);
                return true;
            case SchemaKind::kIndexMaps:
                for_each(value, member, [&](json& item) { check_index_map(item, member); });
                return true;
            case SchemaKind::kObject:
                check_members(value, member.members, false);
                return true;
            case SchemaKind::kExtensions:
                check_members(value, member.members, true);
                return true;
            case SchemaKind::kObjects:
                for_each(value, member, [&](json& item) { check_members(item, member.members, false); });
                return true;
            case SchemaKind::kExtras:  // Anyone's: what is not ours is no error, whatever it is.
                if (!value.is_object()) return false;
                for (const char* const ours : {"mesh_sequence", "subdivision"}) {
                    if (!value.contains(ours) || value[ours].is_object()) continue;
                    scene_.warn(fmt::format("extras.{} is not an object: ignored", ours));
                    value.erase(ours);
                }
                check_members(value, member.members, false);
                return true;
        }
        return false;
    }

    template <typename Body>
    void for_each(json& value, const SchemaMember& member, Body&& body) {
        if (!value.is_array()) fail("must be an array");
        const double size = static_cast<double>(value.size());
        if (size < member.lo || size > member.hi) {
            const std::string wanted =
                member.lo == member.hi ? fmt::format("{}", member.lo) : fmt::format("{} to {}", member.lo, member.hi);
            fail(fmt::format("has {} entries; {} are allowed", value.size(), wanted));
        }
        for (size_t i = 0; i < value.size(); ++i) {
            const size_t length = push(std::to_string(i));
            body(value[i]);
            place_.resize(length);
        }
    }

    void check_one_of(const json& value, const SchemaMember& member) {
        if (!value.is_string()) fail("must be a string");
        std::istringstream words(member.of);
        for (std::string word; words >> word;) {
            if (word == value.get_ref<const std::string&>()) return;
        }
        fail(fmt::format("'{}' is none of: {}", value.get_ref<const std::string&>(), member.of));
    }

    void check_number(const json& value, double lo, double hi) {
        if (!value.is_number()) fail("must be a number");
        const double number = value.get<double>();
        if (!(number >= lo && number <= hi)) fail(fmt::format("{} is out of range", number));
    }

    void check_integer(json& value, double lo, double hi) {
        check_number(value, lo, hi);
        if (value.is_number_integer()) return;
        const double number = value.get<double>();
        if (number != std::floor(number)) fail("must be an integer");
        value = static_cast<uint64_t>(number);
    }

    void check_index(json& value, const SchemaMember& member) {
        const auto found = counts_.find(member.of);
        const double count = found == counts_.end() ? 0.0 : static_cast<double>(found->second);
        if (!value.is_number()) fail("must be an index");
        const double number = value.get<double>();
        if (!(number >= 0.0 && number < count)) {
            fail(fmt::format("{} names none of the {} entries of {}", value.dump(), count, member.of));
        }
        check_integer(value, 0.0, count);
    }

    void check_index_map(json& value, const SchemaMember& member) {
        if (!value.is_object()) fail("must be an object");
        for (auto& [key, item] : value.items()) {
            const size_t length = push(key);
            check_index(item, member);
            place_.resize(length);
        }
    }

    size_t push(const std::string& key) {
        const size_t length = place_.size();
        place_ += "/" + escaped(key);
        return length;
    }

    [[noreturn]] void fail(const std::string& reason) const { throw SceneError(file_, place_, reason); }

    static constexpr double kFloatMax = std::numeric_limits<float>::max();

    const std::string& file_;
    Scene& scene_;
    std::string place_;
    std::map<std::string, size_t> counts_;
};

}  // namespace

void check_schema(json& root, const std::string& file, Scene& scene) {
    if (!root.is_object()) throw SceneError(file, "", "the JSON is not an object");
    Checker(root, file, scene).check_members(root, kSchemaRoot, false);
    if (!root.contains("cameras")) return;
    for (size_t i = 0; i < root["cameras"].size(); ++i) {
        const std::string& type = root["cameras"][i]["type"].get_ref<const std::string&>();
        if (root["cameras"][i].contains(type)) continue;
        throw SceneError(file, fmt::format("/cameras/{}", i), fmt::format("'{}' is missing", type));
    }
}

bool is_supported_extension(const std::string& name) {
    static const char* const kSupported[] = {
        "KHR_lights_punctual",  "KHR_mesh_quantization",           "EXT_mesh_gpu_instancing",
        "KHR_materials_unlit",  "KHR_materials_emissive_strength", "KHR_texture_transform",
        "KHR_materials_ior",    "KHR_materials_specular",          "KHR_materials_transmission",
        "KHR_materials_volume", "KHR_materials_clearcoat",         "KHR_materials_sheen",
        "FB_ngon_encoding"};
    return std::find(std::begin(kSupported), std::end(kSupported), name) != std::end(kSupported);
}

}  // namespace zoe
