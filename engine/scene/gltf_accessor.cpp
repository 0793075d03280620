#include "engine/scene/gltf_accessor.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace zoe {
namespace {

constexpr int kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125, kFloat = 5126;

uint64_t component_size(int component_type) {
    switch (component_type) {
        case kInt8:
        case kUint8:
            return 1;
        case kInt16:
        case kUint16:
            return 2;
        case kUint32:
        case kFloat:
            return 4;
        default:
            return 0;
    }
}

struct Shape {
    uint32_t rows = 1, columns = 1;
};

Shape shape_of(int type) {
    switch (type) {
        case TINYGLTF_TYPE_SCALAR:
            return {1, 1};
        case TINYGLTF_TYPE_VEC2:
            return {2, 1};
        case TINYGLTF_TYPE_VEC3:
            return {3, 1};
        case TINYGLTF_TYPE_VEC4:
            return {4, 1};
        case TINYGLTF_TYPE_MAT2:
            return {2, 2};
        case TINYGLTF_TYPE_MAT3:
            return {3, 3};
        default:
            return {4, 4};
    }
}

/// Where an accessor's elements lie, checked: whatever is inside `count` may be read.
struct Layout {
    const std::byte* data = nullptr;  ///< None: zeros.
    uint64_t stride = 0;
    uint64_t column_stride = 0;  ///< Columns of matrices begin at multiples of 4 bytes.
    uint64_t component_bytes = 0;
    int component_type = 0;
    Shape shape;
};

std::string place_of(int accessor) {
    return fmt::format("/accessors/{}", accessor);
}

/// The first of `count` elements of `element_bytes` in a view.
const std::byte* checked_range(const GltfFile& file, int view_index, uint64_t offset, uint64_t count, uint64_t stride,
                               uint64_t element_bytes, const std::string& place) {
    if (view_index < 0 || static_cast<size_t>(view_index) >= file.views.size()) file.fail(place, "no such bufferView");
    const GltfView& view = file.views[static_cast<size_t>(view_index)];
    // None of these can overflow: counts are below 2^31, strides too, offsets below 2^41.
    const uint64_t end = count == 0 ? offset : offset + (count - 1) * stride + element_bytes;
    if (end > view.length) {
        file.fail(place, fmt::format("{} elements end at byte {} of a bufferView of {}", count, end, view.length));
    }
    return file.buffer(view.buffer).data() + view.offset + offset;
}

Layout layout_of(const GltfFile& file, int index) {
    const tinygltf::Accessor& accessor = file.model.accessors[static_cast<size_t>(index)];
    Layout layout;
    layout.component_type = accessor.componentType;
    layout.component_bytes = component_size(accessor.componentType);
    if (layout.component_bytes == 0) {
        file.fail(place_of(index) + "/componentType", fmt::format("{} is not a component type", accessor.componentType));
    }
    layout.shape = shape_of(accessor.type);
    layout.column_stride = layout.shape.rows * layout.component_bytes;
    if (layout.shape.columns > 1) layout.column_stride = (layout.column_stride + 3) / 4 * 4;
    const uint64_t element_bytes = layout.column_stride * layout.shape.columns;
    layout.stride = element_bytes;
    // The view behind the file's own is the one that stands for "none".
    if (accessor.bufferView < 0 || static_cast<size_t>(accessor.bufferView) >= file.views.size()) return layout;

    const uint64_t stride = file.views[static_cast<size_t>(accessor.bufferView)].stride;
    if (stride != 0) layout.stride = stride;
    if (layout.stride < element_bytes) {
        file.fail(fmt::format("/bufferViews/{}/byteStride", accessor.bufferView),
                  fmt::format("{} is less than an element's {} bytes", stride, element_bytes));
    }
    layout.data = checked_range(file, accessor.bufferView, accessor.byteOffset, accessor.count, layout.stride, element_bytes,
                                place_of(index));
    return layout;
}

template <typename T>
T load(const std::byte* from) {
    T value;
    std::memcpy(&value, from, sizeof value);  // Files need not align.
    return value;
}

template <typename T>
float to_float(T value, bool is_normalized) {
    if constexpr (std::is_same_v<T, float>) {
        return value;
    } else {
        if (!is_normalized) return static_cast<float>(value);
        const double scaled = static_cast<double>(value) / static_cast<double>(std::numeric_limits<T>::max());
        return static_cast<float>(std::max(scaled, -1.0));
    }
}

template <typename T, typename Out>
void copy_element(const Layout& layout, const std::byte* element, bool is_normalized, Out* out) {
    for (uint32_t column = 0; column < layout.shape.columns; ++column) {
        const std::byte* from = element + column * layout.column_stride;
        for (uint32_t row = 0; row < layout.shape.rows; ++row) {
            const T value = load<T>(from + row * sizeof(T));
            if constexpr (std::is_same_v<Out, float>) {
                *out++ = to_float(value, is_normalized);
            } else {
                *out++ = static_cast<Out>(value);
            }
        }
    }
}

template <typename T, typename Out>
void copy_elements(const Layout& layout, GltfRange range, bool is_normalized, Out* out) {
    const uint32_t width = layout.shape.rows * layout.shape.columns;
    for (uint64_t i = range.begin; i < range.end; ++i, out += width) {
        copy_element<T>(layout, layout.data + i * layout.stride, is_normalized, out);
    }
}

template <typename Out>
void copy_any(const Layout& layout, GltfRange range, bool is_normalized, Out* out) {
    switch (layout.component_type) {
        case kInt8:
            return copy_elements<int8_t>(layout, range, is_normalized, out);
        case kUint8:
            return copy_elements<uint8_t>(layout, range, is_normalized, out);
        case kInt16:
            return copy_elements<int16_t>(layout, range, is_normalized, out);
        case kUint16:
            return copy_elements<uint16_t>(layout, range, is_normalized, out);
        case kUint32:
            return copy_elements<uint32_t>(layout, range, is_normalized, out);
        default:
            return copy_elements<float>(layout, range, is_normalized, out);
    }
}

uint32_t load_index(const std::byte* data, int component_type, uint64_t i) {
    if (component_type == kUint8) return load<uint8_t>(data + i);
    if (component_type == kUint16) return load<uint16_t>(data + 2 * i);
    return load<uint32_t>(data + 4 * i);
}

/// Writes the sparse values that fall into the range over the base.
template <typename Out>
void apply_sparse(const GltfFile& file, int index, Layout layout, GltfRange range, bool is_normalized, Out* out) {
    const tinygltf::Accessor& accessor = file.model.accessors[static_cast<size_t>(index)];
    if (!accessor.sparse.isSparse) return;
    const std::string place = place_of(index) + "/sparse";
    const uint64_t count = static_cast<uint64_t>(accessor.sparse.count);
    if (count > accessor.count) {
        file.fail(place + "/count", fmt::format("{} is more than the accessor's {}", count, accessor.count));
    }
    const auto& indices = accessor.sparse.indices;
    const int type = indices.componentType;
    if (type != kUint8 && type != kUint16 && type != kUint32) {
        file.fail(place + "/indices/componentType", fmt::format("{} is not an unsigned integer type", type));
    }
    const uint64_t index_bytes = component_size(type);
    const std::byte* index_data = checked_range(file, indices.bufferView, static_cast<uint64_t>(indices.byteOffset), count,
                                                index_bytes, index_bytes, place + "/indices");
    const uint32_t width = layout.shape.rows * layout.shape.columns;
    layout.stride = layout.column_stride * layout.shape.columns;
    const auto& values = accessor.sparse.values;
    layout.data = checked_range(file, values.bufferView, static_cast<uint64_t>(values.byteOffset), count, layout.stride,
                                layout.stride, place + "/values");
    for (uint64_t i = 0; i < count; ++i) {
        const uint64_t target = load_index(index_data, type, i);
        if (target >= accessor.count) {
            file.fail(place + "/indices", fmt::format("entry {} is {}, not below {}", i, target, accessor.count));
        }
        if (i > 0 && target <= load_index(index_data, type, i - 1)) {
            file.fail(place + "/indices", fmt::format("entry {} is not above the one before it", i));
        }
        if (target >= range.begin && target < range.end) {
            copy_any(layout, {i, i + 1}, is_normalized, out + (target - range.begin) * width);
        }
    }
}

template <typename Out>
std::vector<Out> read_any(GltfFile& file, int index, GltfRange range, bool is_normalized) {
    const tinygltf::Accessor& accessor = file.model.accessors[static_cast<size_t>(index)];
    const Layout layout = layout_of(file, index);
    range.end = std::min<uint64_t>(range.end, accessor.count);
    range.begin = std::min(range.begin, range.end);
    const uint64_t number_count = (range.end - range.begin) * layout.shape.rows * layout.shape.columns;
    const uint64_t sparse_count = accessor.sparse.isSparse ? static_cast<uint64_t>(accessor.sparse.count) : 0;
    file.spend(number_count + sparse_count, place_of(index));
    std::vector<Out> out(number_count);
    if (layout.data != nullptr) copy_any(layout, range, is_normalized, out.data());
    apply_sparse(file, index, layout, range, is_normalized, out.data());
    return out;
}

}  // namespace

uint32_t component_count(const GltfFile& file, int accessor) {
    const Shape shape = shape_of(file.model.accessors[static_cast<size_t>(accessor)].type);
    return shape.rows * shape.columns;
}

bool is_float(const GltfFile& file, int accessor) {
    return file.model.accessors[static_cast<size_t>(accessor)].componentType == kFloat;
}

void require_type(const GltfFile& file, int accessor, std::initializer_list<int> types, const std::string& place) {
    const int type = file.model.accessors[static_cast<size_t>(accessor)].type;
    if (std::find(types.begin(), types.end(), type) == types.end()) {
        file.fail(place, fmt::format("accessor {} has the wrong type for this", accessor));
    }
}

std::vector<float> read_floats(GltfFile& file, int accessor, GltfRange range, bool normalize) {
    const bool is_normalized = normalize || file.model.accessors[static_cast<size_t>(accessor)].normalized;
    return read_any<float>(file, accessor, range, is_normalized);
}

std::vector<uint32_t> read_uints(GltfFile& file, int accessor, GltfRange range) {
    const int type = file.model.accessors[static_cast<size_t>(accessor)].componentType;
    if (type != kUint8 && type != kUint16 && type != kUint32) {
        file.fail(place_of(accessor) + "/componentType", fmt::format("{} is not an unsigned integer type", type));
    }
    return read_any<uint32_t>(file, accessor, range, false);
}

}  // namespace zoe
