#include "engine/deform/morph.h"

#include <algorithm>
#include <cassert>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 8192;

void morph(std::span<const glm::vec3> base, std::span<const MorphTarget> targets,
           std::vector<glm::vec3> MorphTarget::*offsets, std::span<const float> weights, std::span<glm::vec3> out) {
    assert(out.size() == base.size());
    parallel_for(0, base.size(), kGrain, [&](size_t begin, size_t end) {
        std::copy(base.begin() + begin, base.begin() + end, out.begin() + begin);
        for (size_t k = 0; k < std::min(targets.size(), weights.size()); ++k) {
            const std::vector<glm::vec3>& offset = targets[k].*offsets;
            if (weights[k] == 0.0f || offset.empty()) continue;
            for (size_t v = begin; v < end; ++v) out[v] += weights[k] * offset[v];
        }
    });
}

}  // namespace

void morph_positions(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, std::span<const float> weights,
                     std::span<glm::vec3> out) {
    morph(base, targets, &MorphTarget::positions, weights, out);
}

void morph_normals(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, std::span<const float> weights,
                   std::span<glm::vec3> out) {
    morph(base, targets, &MorphTarget::normals, weights, out);
}

}  // namespace zoe
