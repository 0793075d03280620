#include "content/body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "content/polygonise.h"

namespace zoe {
namespace {

float distance_to(const BodyPiece& piece, const glm::vec3& p) {
    const glm::vec3 along = piece.b - piece.a;
    const float u = glm::clamp(glm::dot(p - piece.a, along) / glm::dot(along, along), 0.0f, 1.0f);
    return glm::distance(p, piece.a + u * along) - glm::mix(piece.radius_a, piece.radius_b, u);
}

void bind(Mesh& mesh, std::span<const BodyPiece> pieces, int joint_count, float softness) {
    mesh.binding.influence_count = 4;
    std::vector<std::pair<float, uint16_t>> shares;
    for (const glm::vec3& p : mesh.positions) {
        shares.assign(static_cast<size_t>(std::max(joint_count, 4)), {0.0f, uint16_t{0}});
        for (size_t j = 0; j < static_cast<size_t>(joint_count); ++j) shares[j].second = static_cast<uint16_t>(j);
        for (const BodyPiece& piece : pieces) {
            shares[static_cast<size_t>(piece.joint)].first +=
                std::exp(-std::max(distance_to(piece, p), -softness) / softness);
        }
        std::stable_sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
        float sum = 0.0f;
        for (size_t k = 0; k < 4; ++k)
            sum += shares[k].first = shares[k].first > 0.001f * shares[0].first ? shares[k].first : 0.0f;
        for (size_t k = 0; k < 4; ++k) {
            mesh.binding.joints.push_back(shares[k].first > 0.0f ? shares[k].second : uint16_t{0});
            mesh.binding.weights.push_back(shares[k].first / sum);
        }
    }
}

}  // namespace

Mesh make_body(std::span<const BodyPiece> pieces, int joint_count, float cell, float blend, float softness) {
    const auto field = [&](const glm::vec3& p) {
        float d = 1e3f;
        for (const BodyPiece& piece : pieces) {  // The polynomial smooth minimum: round where two pieces meet.
            const float own = distance_to(piece, p), h = std::max(blend - std::abs(d - own), 0.0f) / blend;
            d = std::min(d, own) - 0.25f * h * h * blend;
        }
        return d;
    };
    Aabb box;
    for (const BodyPiece& piece : pieces) {
        const float margin = std::max(piece.radius_a, piece.radius_b) + 0.3f * blend + 2.0f * cell;
        for (const glm::vec3& end : {piece.a, piece.b}) {
            box.extend(end - margin);
            box.extend(end + margin);
        }
    }
    Mesh mesh = polygonise(field, box, cell);
    bind(mesh, pieces, joint_count, softness);
    return mesh;
}

}  // namespace zoe
