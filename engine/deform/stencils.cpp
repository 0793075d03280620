#include "engine/deform/stencils.h"

#include <algorithm>
#include <cassert>

#include "engine/deform/stencil_kernels.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 2048;  // A multiple of the widest vector: only the last range has a part of one.

// Isolation keeps a thread that waits for others from taking up another evaluation: its memory stays as it is.
const PaddedPoint* pad(std::span<const glm::vec3> points) {
    thread_local std::vector<PaddedPoint> padded;
    padded.resize(points.size());
    for (size_t k = 0; k < points.size(); ++k) padded[k] = {points[k].x, points[k].y, points[k].z, 0.0f};
    return padded.data();
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
    const StencilWork work{.stencils = &stencils,
                           .cage = pad(cage_positions),
                           .positions = positions.data(),
                           .normals = normals.empty() ? nullptr : normals.data()};
    parallel_for(0, positions.size(), kGrain, [&](size_t begin, size_t end) { sum_stencils(work, begin, end); });
}

}  // namespace zoe
