#include <algorithm>
#include <array>

#include "engine/frame/refine.h"

namespace zoe {

LevelChoice make_level_choice(const Mesh& mesh) {
    const SubdivisionSurface& surface = *mesh.surface;
    LevelChoice choice{.bends = find_bends(surface.cage, mesh.positions.size()),
                       .max_level = std::min(surface.max_level, finest_level(surface.cage, mesh.positions.size()))};
    for (int level = 0; level <= kMaxSubdivisionLevel; ++level)
        choice.triangle_counts[level] = count_triangles(surface.cage, level);
    return choice;
}

int choose_level(const LevelChoice& choice, std::span<const glm::vec3> cage_positions, const Seen& seen, float pixels,
                 float hysteresis, int last, bool* is_capped) {
    std::array<float, kMaxSubdivisionLevel + 1> errors;
    estimate_errors(choice.bends, cage_positions, seen, errors);
    const auto coarsest = [&](float allowed) {
        int level = 1;
        while (level < choice.max_level && !(errors[level] <= allowed)) ++level;
        return level;
    };
    const int needed = coarsest(pixels);
    *is_capped = !(errors[needed] <= pixels);
    if (last == 0) return needed;
    return std::clamp(last, needed, coarsest(pixels * (1.0f - std::clamp(hysteresis, 0.0f, 1.0f))));
}

}  // namespace zoe
