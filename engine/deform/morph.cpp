#include "engine/deform/morph.h"

#include <algorithm>
#include <cassert>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

using Offsets = std::vector<glm::vec3> MorphTarget::*;

constexpr size_t kGrain = 2048;       // What is summed stays in the nearest cache.
constexpr uint32_t kShortestGap = 8;  // Fewer vertices than this are sooner moved by 0 than left out.

// out[v] += weight * offsets[v]
void add(const std::vector<glm::vec3>& offsets, float weight, size_t begin, size_t end, std::span<glm::vec3> out) {
    // Float by float, which compilers make vectors of.
    const float* const from = &offsets[begin].x;
    float* const to = &out[begin].x;
    for (size_t k = 0; k < 3 * (end - begin); ++k) to[k] += weight * from[k];
}

void morph(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, Offsets offsets,
           std::span<const float> weights, std::span<glm::vec3> out) {
    assert(out.size() == base.size());
    parallel_for(0, base.size(), kGrain, [&](size_t begin, size_t end) {
        std::copy(base.begin() + begin, base.begin() + end, out.begin() + begin);
        for (size_t k = 0; k < std::min(targets.size(), weights.size()); ++k) {
            const std::vector<glm::vec3>& offset = targets[k].*offsets;
            if (weights[k] != 0.0f && !offset.empty()) add(offset, weights[k], begin, end, out);
        }
    });
}

// Calls `body` on what [begin, end) has in common with each of the ranges.
template <typename Body>
void for_each_common(const std::vector<VertexRange>& ranges, size_t begin, size_t end, Body&& body) {
    auto range = std::partition_point(ranges.begin(), ranges.end(), [&](const VertexRange& r) { return r.end <= begin; });
    for (; range != ranges.end() && range->begin < end; ++range) {
        body(std::max<size_t>(range->begin, begin), std::min<size_t>(range->end, end));
    }
}

void morph(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, Offsets offsets,
           const MorphReach::Moved& moved, std::span<const float> weights, std::span<glm::vec3> out) {
    assert(out.size() == base.size() && moved.by_target.size() == targets.size());
    if (base.empty() || moved.by_any.empty()) return;
    parallel_for(moved.by_any.front().begin, moved.by_any.back().end, kGrain, [&](size_t begin, size_t end) {
        for_each_common(moved.by_any, begin, end, [&](size_t first, size_t last) {
            std::copy(base.begin() + first, base.begin() + last, out.begin() + first);
        });
        for (size_t k = 0; k < std::min(targets.size(), weights.size()); ++k) {
            if (weights[k] == 0.0f) continue;
            for_each_common(moved.by_target[k], begin, end,
                            [&](size_t first, size_t last) { add(targets[k].*offsets, weights[k], first, last, out); });
        }
    });
}

void mark(const std::vector<glm::vec3>& offsets, std::vector<uint8_t>* is_moved) {
    if (is_moved->size() < offsets.size()) is_moved->resize(offsets.size(), 0);
    for (size_t v = 0; v < offsets.size(); ++v) {
        if (offsets[v] != glm::vec3(0.0f)) (*is_moved)[v] = 1;  // NaN, too.
    }
}

std::vector<VertexRange> ranges_of(const std::vector<uint8_t>& is_moved) {
    std::vector<VertexRange> ranges;
    for (uint32_t v = 0; v < is_moved.size(); ++v) {
        if (!is_moved[v]) continue;
        if (ranges.empty() || v - ranges.back().end >= kShortestGap) ranges.push_back({v, v});
        ranges.back().end = v + 1;
    }
    return ranges;
}

MorphReach::Moved find_moved(std::span<const MorphTarget> targets, Offsets offsets) {
    MorphReach::Moved moved;
    std::vector<uint8_t> by_any, by_one;
    for (const MorphTarget& target : targets) {
        by_one.clear();
        mark(target.*offsets, &by_one);
        mark(target.*offsets, &by_any);
        moved.by_target.push_back(ranges_of(by_one));
        // Gaps that this target moves by 0 must hold the base, too.
        for (const VertexRange& range : moved.by_target.back()) {
            std::fill(by_any.begin() + range.begin, by_any.begin() + range.end, uint8_t{1});
        }
    }
    moved.by_any = ranges_of(by_any);
    return moved;
}

}  // namespace

MorphReach find_reach(std::span<const MorphTarget> targets) {
    return {find_moved(targets, &MorphTarget::positions), find_moved(targets, &MorphTarget::normals)};
}

void morph_positions(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, std::span<const float> weights,
                     std::span<glm::vec3> out) {
    morph(base, targets, &MorphTarget::positions, weights, out);
}

void morph_normals(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, std::span<const float> weights,
                   std::span<glm::vec3> out) {
    morph(base, targets, &MorphTarget::normals, weights, out);
}

void morph_positions(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, const MorphReach& reach,
                     std::span<const float> weights, std::span<glm::vec3> out) {
    morph(base, targets, &MorphTarget::positions, reach.positions, weights, out);
}

void morph_normals(std::span<const glm::vec3> base, std::span<const MorphTarget> targets, const MorphReach& reach,
                   std::span<const float> weights, std::span<glm::vec3> out) {
    morph(base, targets, &MorphTarget::normals, reach.normals, weights, out);
}

}  // namespace zoe
