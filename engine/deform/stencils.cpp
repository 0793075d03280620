#include "engine/deform/stencils.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include <glm/ext/vector_double3.hpp>
#include <glm/geometric.hpp>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 2048;

using Float4 = float __attribute__((vector_size(16)));

/// Loads cage vertices four floats at a time; the fourth is whatever lies behind and is never stored.
class Source {
public:
    explicit Source(std::span<const glm::vec3> points) : points_(points.data()), last_(points.size() - 1) {
        std::memcpy(tail_, &points.back(), sizeof(glm::vec3));
    }
    Float4 operator[](uint32_t k) const {
        // Behind the last one is nothing that may be read.
        const void* from = k == last_ ? static_cast<const void*>(tail_) : points_ + k;
        Float4 value;
        std::memcpy(&value, from, sizeof(value));
        return value;
    }

private:
    const glm::vec3* points_;
    size_t last_;
    float tail_[4] = {};
};

Float4 load(const float* from) {
    Float4 value;
    std::memcpy(&value, from, sizeof(value));
    return value;
}

glm::vec3 to_vec3(const Float4& v) {
    return {v[0], v[1], v[2]};
}

void evaluate_positions(const StencilTable& stencils, const Source& source, size_t begin, size_t end, glm::vec3* positions) {
    for (size_t v = begin; v < end; ++v) {
        Float4 sum = {};
        for (uint32_t k = stencils.offsets[v]; k < stencils.offsets[v + 1]; k += 4) {
            const uint32_t* index = &stencils.indices[k];
            const Float4 weights = load(&stencils.weights[k]);
            for (int j = 0; j < 4; ++j) sum += weights[j] * source[index[j]];
        }
        positions[v] = to_vec3(sum);
    }
}

glm::vec3 normal_of(const Float4& u, const Float4& v) {
    // In double: squares of squares of small tangents would vanish.
    const glm::dvec3 normal = glm::cross(glm::dvec3(to_vec3(u)), glm::dvec3(to_vec3(v)));
    const double square = glm::dot(normal, normal);
    return square > 0.0 ? glm::vec3(normal * (1.0 / std::sqrt(square))) : glm::vec3(0.0f);
}

void evaluate_both(const StencilTable& stencils, const Source& source, size_t begin, size_t end, glm::vec3* positions,
                   glm::vec3* normals) {
    for (size_t vertex = begin; vertex < end; ++vertex) {
        Float4 sum = {}, u = {}, v = {};
        for (uint32_t k = stencils.offsets[vertex]; k < stencils.offsets[vertex + 1]; k += 4) {
            const uint32_t* index = &stencils.indices[k];
            const Float4 weights = load(&stencils.weights[k]);
            const Float4 u_weights = load(&stencils.u_weights[k]), v_weights = load(&stencils.v_weights[k]);
            for (int j = 0; j < 4; ++j) {
                const Float4 point = source[index[j]];
                sum += weights[j] * point;
                u += u_weights[j] * point;
                v += v_weights[j] * point;
            }
        }
        positions[vertex] = to_vec3(sum);
        normals[vertex] = normal_of(u, v);
    }
}

}  // namespace

void sort_entries(StencilTable* stencils, std::span<const uint32_t> rank) {
    struct Entry {
        bool is_filling;  // Stands behind the others, with weights of 0.
        uint32_t index;
        float weight, u, v;
    };
    const bool has_tangents = !stencils->u_weights.empty();
    std::vector<Entry> entries;
    for (size_t vertex = 0; vertex < stencils->vertex_count(); ++vertex) {
        const uint32_t begin = stencils->offsets[vertex], end = stencils->offsets[vertex + 1];
        entries.clear();
        for (uint32_t k = begin; k < end; ++k) {
            const float u = has_tangents ? stencils->u_weights[k] : 0.0f, v = has_tangents ? stencils->v_weights[k] : 0.0f;
            const bool is_filling = k > begin && stencils->indices[k] == stencils->indices[k - 1];
            entries.push_back({is_filling, stencils->indices[k], stencils->weights[k], u, v});
        }
        std::stable_sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
            return a.is_filling != b.is_filling ? b.is_filling : rank[a.index] < rank[b.index];
        });
        for (uint32_t k = begin; k < end; ++k) {
            const Entry& entry = entries[k - begin];
            stencils->indices[k] = entry.index;
            stencils->weights[k] = entry.weight;
            if (!has_tangents) continue;
            stencils->u_weights[k] = entry.u;
            stencils->v_weights[k] = entry.v;
        }
    }
}

void evaluate(const StencilTable& stencils, std::span<const glm::vec3> cage_positions, std::span<glm::vec3> positions,
              std::span<glm::vec3> normals) {
    assert(positions.size() == stencils.vertex_count());
    if (positions.empty()) return;
    assert(!cage_positions.empty());
    assert(normals.empty() || (normals.size() == positions.size() && stencils.u_weights.size() == stencils.weights.size()));
    const Source source(cage_positions);
    parallel_for(0, positions.size(), kGrain, [&](size_t begin, size_t end) {
        if (normals.empty())
            evaluate_positions(stencils, source, begin, end, positions.data());
        else
            evaluate_both(stencils, source, begin, end, positions.data(), normals.data());
    });
}

}  // namespace zoe
