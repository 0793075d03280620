#include "engine/render/glow.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "engine/math/parallel.h"
#include "engine/render/direction.h"
#include "engine/render/texture.h"

namespace zoe {

namespace {

constexpr size_t kGrain = 4096;  // triangles

/// The mean of a texture's light, where it has levels.
glm::vec3 mean_color(const Scene& scene, const TextureRef& ref) {
    if (!has_pixels(scene.images, ref)) return glm::vec3(1.0f);
    return glm::vec3(mean_texel(scene.images[index(ref.image)], Texels::kLight));
}

float brightness_of(const Scene& scene, const Material& material) {
    if (material.emission == glm::vec3(0.0f)) return 0.0f;
    const float brightness = largest(material.emission * mean_color(scene, material.emission_texture));
    return std::isfinite(brightness) ? brightness : 0.0f;
}

/// In the world; 0 where it is not finite.
float area_of(const Instance& instance, const glm::uvec3& corner) {
    const glm::vec3& a = instance.positions[corner.x];
    const glm::vec3 ab = instance.world_from_local.vector(instance.positions[corner.y] - a);
    const glm::vec3 ac = instance.world_from_local.vector(instance.positions[corner.z] - a);
    const float area = static_cast<float>(0.5 * glm::length(glm::cross(glm::dvec3(ab), glm::dvec3(ac))));
    return std::isfinite(area) ? area : 0.0f;
}

}  // namespace

void Glow::gather(const Scene& scene, const Tlas& tlas) {
    brightness_.clear();
    for (const Material& material : scene.materials) brightness_.push_back(brightness_of(scene, material));
    list_pieces(tlas);
    const size_t count = pieces_.empty() ? 0 : pieces_.back().end;
    places_.resize(count);
    power_.resize(count);
    parallel_for(0, count, kGrain, [&](size_t begin, size_t end) { weigh(begin, end); });
    if (power_ == built_for_) return;  // The table knows of powers only.
    table_.build(power_);
    std::swap(power_, built_for_);
}

void Glow::list_pieces(const Tlas& tlas) {
    pieces_.clear();
    size_t count = 0;
    for (const Instance& instance : tlas.instances) {
        for (const MaterialRange& range : instance.mesh->materials) {
            if (range.material == kNone<MaterialId> || !(brightness_[index(range.material)] > 0.0f)) continue;
            const size_t begin = count;
            count += range.end - range.begin;
            pieces_.push_back({&instance, &range, begin, count});
        }
    }
}

/// Of the triangles [begin, end) that glow. What has no finite power has none.
void Glow::weigh(size_t begin, size_t end) {
    const auto is_before = [](size_t place, const Piece& piece) { return place < piece.end; };
    auto piece = std::upper_bound(pieces_.begin(), pieces_.end(), begin, is_before);
    for (size_t i = begin; i < end; ++i) {
        while (i >= piece->end) ++piece;
        const uint32_t primitive = piece->range->begin + static_cast<uint32_t>(i - piece->begin);
        const Instance& instance = *piece->instance;
        const float power =
            area_of(instance, instance.mesh->corners[primitive]) * brightness_[index(piece->range->material)];
        places_[i] = {instance.node, primitive};
        power_[i] = std::isfinite(power) ? power : 0.0f;
    }
}

Hit Glow::sample(float pick, const glm::vec2& u) const {
    const Place& place = places_[table_.pick(pick)];
    const float root = std::sqrt(u.x);
    return {.t = 0.0f, .u = root * (1.0f - u.y), .v = root * u.y, .node = place.node, .primitive = place.primitive};
}

float Glow::density(MaterialId material) const {
    if (material == kNone<MaterialId> || is_dark()) return 0.0f;
    return static_cast<float>(static_cast<double>(brightness_[index(material)]) / table_.total());
}

}  // namespace zoe
