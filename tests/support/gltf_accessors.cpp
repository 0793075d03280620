#include "tests/support/gltf_accessors.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "tests/support/gltf_container.h"

namespace zoe::test {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& reason) {
    throw std::runtime_error("oracle: " + reason);
}

const Json& element(const Json& root, const char* array, int index) {
    return root.at(array).at(static_cast<size_t>(index));
}

uint32_t component_count(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type == "VEC2") return 2;
    if (type == "VEC3") return 3;
    if (type == "VEC4") return 4;
    if (type == "MAT4") return 16;
    refuse("accessor type " + type);
}

size_t component_size(int type) {
    switch (type) {
        case 5120:
        case 5121:
            return 1;
        case 5122:
        case 5123:
            return 2;
        case 5125:
        case 5126:
            return 4;
        default:
            refuse("component type " + std::to_string(type));
    }
}

template <typename T>
double component(const uint8_t* bytes, double one) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return one == 0.0 ? static_cast<double>(value) : std::max(static_cast<double>(value) / one, -1.0);
}

double read_component(int type, bool is_normalised, const uint8_t* bytes) {
    switch (type) {
        case 5120:
            return component<int8_t>(bytes, is_normalised ? 127.0 : 0.0);
        case 5121:
            return component<uint8_t>(bytes, is_normalised ? 255.0 : 0.0);
        case 5122:
            return component<int16_t>(bytes, is_normalised ? 32767.0 : 0.0);
        case 5123:
            return component<uint16_t>(bytes, is_normalised ? 65535.0 : 0.0);
        case 5125:
            return component<uint32_t>(bytes, 0.0);
        default:
            return component<float>(bytes, 0.0);
    }
}

}  // namespace

GltfAccessors::GltfAccessors(const Json& root, const std::filesystem::path& folder, std::vector<uint8_t> binary)
    : root_(root) {
    const Json none = Json::array();
    for (const Json& buffer : root.value("buffers", none)) {
        const bool is_binary_chunk = buffers_.empty() && !buffer.contains("uri");
        buffers_.push_back(is_binary_chunk ? std::move(binary) : read_uri(folder, buffer.at("uri").get<std::string>()));
    }
}

AccessorArray GltfAccessors::read(int index) const {
    const Json& accessor = element(root_, "accessors", index);
    const int type = accessor.at("componentType").get<int>();
    const bool is_normalised = accessor.value("normalized", false);
    const size_t count = accessor.at("count").get<size_t>();
    AccessorArray array{.width = component_count(accessor.at("type").get<std::string>()), .values = {}};
    array.values.resize(count * array.width, 0.0);
    if (accessor.contains("bufferView")) {
        read_elements(accessor, type, is_normalised, count, array.width, array.values.data());
    }
    if (accessor.contains("sparse")) {
        const Json& sparse = accessor["sparse"];
        const size_t replaced = sparse.at("count").get<size_t>();
        std::vector<double> places(replaced), values(replaced * array.width);
        const Json& indices = sparse.at("indices");
        read_elements(indices, indices.at("componentType").get<int>(), false, replaced, 1, places.data());
        read_elements(sparse.at("values"), type, is_normalised, replaced, array.width, values.data());
        for (size_t i = 0; i < replaced; ++i) {
            const size_t place = static_cast<size_t>(places[i]);
            if (place >= count) refuse("a sparse index is too high");
            std::copy_n(&values[i * array.width], array.width, &array.values[place * array.width]);
        }
    }
    return array;
}

void GltfAccessors::read_elements(const Json& place, int type, bool is_normalised, size_t count, uint32_t width,
                                  double* out) const {
    const Json& view = element(root_, "bufferViews", place.at("bufferView").get<int>());
    const std::vector<uint8_t>& buffer = buffers_.at(view.at("buffer").get<size_t>());
    const size_t size = component_size(type);
    const size_t stride = view.value("byteStride", size_t{0}) != 0 ? view["byteStride"].get<size_t>() : size * width;
    const size_t begin = view.value("byteOffset", size_t{0}) + place.value("byteOffset", size_t{0});
    if (count > 0 && begin + (count - 1) * stride + size * width > buffer.size()) refuse("an accessor leaves its buffer");
    for (size_t i = 0; i < count; ++i) {
        for (uint32_t k = 0; k < width; ++k) {
            out[i * width + k] = read_component(type, is_normalised, &buffer[begin + i * stride + k * size]);
        }
    }
}

}  // namespace zoe::test
