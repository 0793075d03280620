#include "engine/scene/weld.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace zoe {
namespace {

/// Order of `count` values at places a and b of an array, by their bytes; 0: they are the same.
template <typename T>
int compare(const std::vector<T>& values, size_t a, size_t b, size_t count = 1) {
    return values.empty() ? 0 : std::memcmp(&values[a * count], &values[b * count], count * sizeof(T));
}

int compare(const Mesh& mesh, uint32_t a, uint32_t b) {
    if (const int order = compare(mesh.positions, a, b)) return order;
    for (const MorphTarget& target : mesh.targets) {
        if (const int order = compare(target.positions, a, b)) return order;
    }
    const uint32_t n = mesh.binding.influence_count;
    if (n == 0) return 0;
    const int order = compare(mesh.binding.joints, a, b, n);
    return order != 0 ? order : compare(mesh.binding.weights, a, b, n);
}

template <typename T>
void keep(const std::vector<uint32_t>& kept, std::vector<T>* values, size_t count = 1) {
    if (values->empty()) return;
    for (size_t k = 0; k < kept.size(); ++k) {  // They ascend: nothing is overwritten before it was read.
        for (size_t i = 0; i < count; ++i) (*values)[k * count + i] = (*values)[kept[k] * count + i];
    }
    values->resize(kept.size() * count);
}

}  // namespace

Welding weld(const Mesh& mesh) {
    std::vector<uint32_t> order(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const int by_value = compare(mesh, a, b);
        return by_value != 0 ? by_value < 0 : a < b;
    });
    // The first of each run of equal ones stands for it.
    std::vector<uint32_t> stands_for(order.size());
    for (size_t k = 0; k < order.size(); ++k) {
        const bool is_same = k > 0 && compare(mesh, order[k - 1], order[k]) == 0;
        stands_for[order[k]] = is_same ? stands_for[order[k - 1]] : order[k];
    }
    Welding welding;
    welding.vertex_of.resize(order.size());
    for (uint32_t v = 0; v < order.size(); ++v) {
        if (stands_for[v] == v) {
            welding.vertex_of[v] = static_cast<uint32_t>(welding.first.size());
            welding.first.push_back(v);
        } else {
            welding.vertex_of[v] = welding.vertex_of[stands_for[v]];
        }
    }
    return welding;
}

void keep_welded(const Welding& welding, Mesh* mesh) {
    keep(welding.first, &mesh->positions);
    for (MorphTarget& target : mesh->targets) {
        keep(welding.first, &target.positions);
        target.normals.clear();
    }
    keep(welding.first, &mesh->binding.joints, mesh->binding.influence_count);
    keep(welding.first, &mesh->binding.weights, mesh->binding.influence_count);
    mesh->normals.clear();
    mesh->tangents.clear();
    mesh->tangent_corners.clear();
    for (std::vector<glm::vec2>& uvs : mesh->uvs) uvs.clear();
    mesh->colors.clear();
}

CageUvs weld_uvs(const Welding& welding, const std::vector<glm::vec2>& uvs, const std::vector<uint32_t>& corners) {
    const auto order_of = [&](uint32_t a, uint32_t b) {
        if (welding.vertex_of[a] != welding.vertex_of[b]) return welding.vertex_of[a] < welding.vertex_of[b] ? -1 : 1;
        return compare(uvs, a, b);
    };
    std::vector<uint32_t> order(corners.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const int by_value = order_of(corners[a], corners[b]);
        return by_value != 0 ? by_value < 0 : a < b;
    });
    CageUvs welded;
    welded.corners.resize(corners.size());
    for (size_t k = 0; k < order.size(); ++k) {
        if (k == 0 || order_of(corners[order[k - 1]], corners[order[k]]) != 0)
            welded.values.push_back(uvs[corners[order[k]]]);
        welded.corners[order[k]] = static_cast<uint32_t>(welded.values.size() - 1);
    }
    return welded;
}

}  // namespace zoe
