#include "engine/render/bsdf.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "engine/render/microfacet.h"

namespace zoe {

namespace {

constexpr float kInvPi = glm::one_over_pi<float>();
constexpr float kLeastCosine = 1e-2f;  // shading normals are turned to the viewer until they are seen by so much
constexpr float kCoatF0 = 0.04f;       // KHR_materials_clearcoat: an index of refraction of 1.5

/// The shading normal, turned to the viewer as far as facets need to be seen at all.
glm::vec3 seen(const glm::vec3& normal, const glm::vec3& to_viewer) {
    const float along = glm::dot(normal, to_viewer);
    return along >= kLeastCosine ? normal : glm::normalize(normal + (kLeastCosine - along) * to_viewer);
}

float coat_albedo(float cosine, const GgxAlbedo& albedo) {
    const Albedo at = albedo.at(cosine);
    return kCoatF0 * (at.all - at.edge) + at.edge;
}

bool has_facets(const Surface& surface) {
    return surface.metallic > 0.0f || surface.specular > 0.0f || surface.is_frosted();
}

/// How wide an angle a density stands for.
float spread_of(float density) {
    return density > kInvPi ? std::sqrt(kInvPi / density) : 1.0f;
}

}  // namespace

Bsdf::Frame::Frame(const glm::vec3& normal, const glm::vec3& to_viewer) : z(normal) {
    make_frame(normal, &x, &y);
    viewer = to_local(to_viewer);
}

Bsdf::Bsdf(const Surface& surface, const glm::vec3& to_viewer)
    : surface_(surface),
      frame_(has_facets(surface) ? seen(surface.ns, to_viewer) : surface.ns, to_viewer),
      coat_frame_(surface.coat > 0.0f ? Frame(seen(surface.coat_ns, to_viewer), to_viewer) : frame_),
      alpha_(alpha_of(surface.roughness)),
      coat_alpha_(alpha_of(surface.coat_roughness)),
      has_facets_(has_facets(surface)) {
    const bool is_body = surface.is_body();
    if (is_body && surface.is_inside) {
        total_weight_ = 1.0f;
        return;
    }
    const float cosine = frame_.viewer.z;
    float reflected = 0.0f;
    if (has_facets_) {
        albedo_ = GgxAlbedo(surface.roughness);
        const Albedo at = albedo_.at(cosine), &mean = albedo_.mean();
        dielectric_ = Dielectric(surface, mean);
        hidden_ = ggx_hidden(frame_.viewer, alpha_);
        f0_ = dielectric_.f0;
        f90_ = dielectric_.f90;
        between_ = dielectric_.between;
        if (surface.metallic > 0.0f) {
            f0_ = glm::mix(f0_, surface.base_color, surface.metallic);
            f90_ = glm::mix(f90_, 1.0f, surface.metallic);
            between_ = glm::mix(between_, between_facets(surface.base_color, 1.0f, mean), surface.metallic);
        }
        lost_ = 1.0f - at.all;
        mean_lost_ = std::max(1.0f - mean.all, 1e-6f);
        under_ = dielectric_.goes_under(at);
        mean_under_ = std::max(dielectric_.goes_under(mean), 1e-6f);
        reflected = largest(f0_ * (at.all - at.edge) + f90_ * at.edge);
    }
    const glm::vec3 under = surface.base_color * (1.0f - surface.metallic);
    diffuse_ = under * (1.0f - surface.transmission);
    if (is_body || surface.is_frosted()) through_ = under * surface.transmission;
    if (largest(surface.sheen_color) > 0.0f) {
        sheen_ = largest(surface.sheen_color) * sheen_albedo(std::max(cosine, 0.0f), surface.sheen_roughness);
    }
    if (surface.coat > 0.0f) {
        coat_table_ = GgxAlbedo(surface.coat_roughness);
        coat_ = surface.coat * coat_albedo(coat_frame_.viewer.z, coat_table_);
    }

    const float left = 1.0f - coat_;
    share_[kDiffuse] = left * (largest(diffuse_) * under_ + largest(between_) * lost_ + sheen_);
    share_[kFacets] = left * reflected;
    share_[kCoat] = coat_;
    share_[kThrough] = left * (1.0f - sheen_) * largest(through_) * under_;
    for (const float share : share_) total_weight_ += share;
    if (is_black()) return;
    for (float& share : share_) share /= total_weight_;
}

/// What a layer leaves to those under it, for light between two directions.
float Bsdf::under_layers(float reflected, float also_reflected) const {
    return std::max(0.0f, 1.0f - std::max(reflected, also_reflected));
}

/// left, coat_left  what is kept of the value: of all under the coat, of the coat.
Bsdf::Value Bsdf::evaluate_unfolded(const glm::vec3& to_light, float left, float coat_left) const {
    Value result;
    const glm::vec3 light = frame_.to_local(to_light);
    if (light.z > 0.0f) {
        const float diffuse_density = light.z * kInvPi;
        result.density = share_[kDiffuse] * diffuse_density;
        glm::vec3 color = diffuse_;
        if (has_facets_) {
            const Albedo at = albedo_.at(light.z);
            color *= under_ * dielectric_.goes_under(at) / mean_under_;
            color += between_ * (lost_ * (1.0f - at.all) / mean_lost_);
        }
        result.value = color * diffuse_density;
        const glm::vec3 sum = frame_.viewer + light;
        const float length = glm::length(sum);
        if (has_facets_ && length > 0.0f) {
            const glm::vec3 half = sum / length;
            const float density = ggx_density(half, alpha_) / (4.0f * frame_.viewer.z);
            const glm::vec3 reflected = f0_ + (f90_ - f0_) * schlick_share(glm::dot(frame_.viewer, half));
            result.value += reflected * (density / (1.0f + hidden_ + ggx_hidden(light, alpha_)));
            result.density += share_[kFacets] * density / (1.0f + hidden_);
        }
        if (sheen_ > 0.0f && frame_.viewer.z > 0.0f) {
            const float also = largest(surface_.sheen_color) * sheen_albedo(light.z, surface_.sheen_roughness);
            result.value *= under_layers(sheen_, also);
            const float white = sheen(frame_.viewer, light, sheen_alpha(surface_.sheen_roughness));
            result.value += surface_.sheen_color * (white * sheen_scale(surface_.sheen_roughness));
        }
    }
    result.value *= left;
    if (surface_.coat > 0.0f) {
        const glm::vec3& viewer = coat_frame_.viewer;
        const glm::vec3 coat_light = coat_frame_.to_local(to_light);
        result.value *= under_layers(coat_, surface_.coat * coat_albedo(std::max(coat_light.z, 0.0f), coat_table_));
        if (coat_light.z > 0.0f) {
            const glm::vec3 half = glm::normalize(viewer + coat_light);
            const float density = ggx_density(half, coat_alpha_) / (4.0f * viewer.z);
            const float reflected = kCoatF0 + (1.0f - kCoatF0) * schlick_share(glm::dot(viewer, half));
            result.value +=
                coat_left * surface_.coat * reflected * density * ggx_seen_by_both(viewer, coat_light, coat_alpha_);
            result.density += share_[kCoat] * density * ggx_seen(viewer, coat_alpha_);
        }
    }
    return result;
}

/// What passes a frosted sheet: as its facets would reflect it, mirrored at the shading normal's plane, and none of it is
/// lost. So light from behind is that of the opposite normal, as it would be on the sheet's other side.
Bsdf::Value Bsdf::frosted_unfolded(const glm::vec3& to_light) const {
    glm::vec3 light = frame_.to_local(to_light);
    light.z = -light.z;
    const glm::vec3 sum = frame_.viewer + light;
    const float length = glm::length(sum);
    if (!(light.z > 0.0f) || !(length > 0.0f)) return {};
    const float density = ggx_density(sum / length, alpha_) / (4.0f * frame_.viewer.z);
    const float passes = under_ * (1.0f - sheen_) * (1.0f - coat_) / albedo_.at(frame_.viewer.z).all;
    return {through_ * (passes * density / (1.0f + hidden_ + ggx_hidden(light, alpha_))),
            share_[kThrough] * density / (1.0f + hidden_)};
}

Bsdf::Value Bsdf::evaluate(const glm::vec3& to_light) const {
    if (is_black() || (surface_.is_body() && surface_.is_inside)) return {};
    const bool is_above = glm::dot(surface_.ng, to_light) > 0.0f;
    if (!is_above && !surface_.is_frosted()) return {};
    const auto unfolded = [&](const glm::vec3& light) {
        return is_above ? evaluate_unfolded(light) : frosted_unfolded(light);
    };
    Value result = unfolded(to_light);
    if (surface_.ns == surface_.ng && frame_.z == surface_.ng && coat_frame_.z == surface_.ng) return result;
    const Value folded = unfolded(mirror(to_light, surface_.ng));
    result.value += folded.value;
    result.density += folded.density;
    return result;
}

glm::vec3 Bsdf::evaluate_sharp(const glm::vec3& to_light) const {
    if (is_black() || (surface_.is_body() && surface_.is_inside)) return glm::vec3(0.0f);
    const bool is_above = glm::dot(surface_.smooth, to_light) > 0.0f;
    if (!is_above && !surface_.is_frosted()) return glm::vec3(0.0f);
    const float left = past_terminator(surface_.smooth, surface_.ns, to_light);
    if (!is_above) return left * frosted_unfolded(to_light).value;
    return evaluate_unfolded(to_light, left, past_terminator(surface_.smooth, surface_.coat_ns, to_light)).value;
}

std::optional<Bsdf::Sample> Bsdf::sample(const glm::vec2& u, float pick) const {
    if (is_black()) return std::nullopt;
    if (surface_.is_body() && surface_.is_inside) return cross_from_inside(u, pick);
    int lobe = 0;
    // The last lobe with a share stands in for what rounding leaves over.
    for (int i = 0; i < kLobeCount; ++i) {
        if (share_[i] <= 0.0f) continue;
        lobe = i;
        if (pick < share_[i]) break;
        pick -= share_[i];
    }
    if (lobe == kThrough && surface_.is_body()) return refract(u);

    Sample sample;
    if (lobe == kDiffuse) {
        sample.direction = sample_cosine(frame_.z, u);
    } else {
        const Frame& frame = lobe == kCoat ? coat_frame_ : frame_;
        const glm::vec3 half = sample_seen_normal(frame.viewer, lobe == kCoat ? coat_alpha_ : alpha_, u);
        glm::vec3 local = 2.0f * glm::dot(frame.viewer, half) * half - frame.viewer;
        if (!(local.z > 0.0f)) return std::nullopt;
        if (lobe == kThrough) local.z = -local.z;
        sample.direction = glm::normalize(frame.to_world(local));
    }
    const bool is_under = glm::dot(surface_.ng, sample.direction) < 0.0f;
    if (is_under != (lobe == kThrough)) sample.direction = mirror(sample.direction, surface_.ng);
    const Value value = evaluate(sample.direction);
    if (!(value.density > 0.0f)) return std::nullopt;
    sample.weight = value.value / value.density;
    sample.density = value.density;
    sample.spread = spread_of(value.density);
    return sample;
}

/// Into a body, bent at a facet.
Bsdf::Sample Bsdf::refract(const glm::vec2& u) const {
    const glm::vec3 half = sample_seen_normal(frame_.viewer, alpha_, u);
    const float eta = 1.0f / surface_.ior;
    const float along = glm::dot(frame_.viewer, half);
    const float cosine = std::sqrt(std::max(0.0f, 1.0f - eta * eta * (1.0f - along * along)));
    Sample sample;
    sample.direction = glm::normalize(frame_.to_world((eta * along - cosine) * half - eta * frame_.viewer));
    if (glm::dot(surface_.ng, sample.direction) > 0.0f) sample.direction = mirror(sample.direction, surface_.ng);
    sample.weight = through_ * (under_ * (1.0f - sheen_) * (1.0f - coat_) / share_[kThrough]);
    sample.spread = std::min(1.0f, alpha_);
    return sample;
}

/// Within a body: out of it, bent at a facet, or back.
std::optional<Bsdf::Sample> Bsdf::cross_from_inside(const glm::vec2& u, float pick) const {
    const glm::vec3 half = sample_seen_normal(frame_.viewer, alpha_, u);
    const float eta = surface_.ior;
    const float along = glm::dot(frame_.viewer, half);
    const float cosine2 = 1.0f - eta * eta * (1.0f - along * along);  // of the direction outside; below 0: there is none
    const float cosine = std::sqrt(std::max(0.0f, cosine2));
    const float reflected = cosine2 > 0.0f ? surface_.f0 + (1.0f - surface_.f0) * schlick_share(cosine) : 1.0f;
    Sample sample;
    sample.weight = glm::vec3(1.0f);
    sample.spread = std::min(1.0f, alpha_);
    const bool is_back = pick < reflected;
    glm::vec3 local = is_back ? 2.0f * along * half - frame_.viewer : (eta * along - cosine) * half - eta * frame_.viewer;
    sample.direction = glm::normalize(frame_.to_world(local));
    if ((glm::dot(surface_.ng, sample.direction) > 0.0f) != is_back)
        sample.direction = mirror(sample.direction, surface_.ng);
    if (!is_back) sample.weight = surface_.base_color;
    return sample;
}

glm::vec3 passes_straight(const Surface& surface, const glm::vec3& to_viewer) {
    if (!(surface.transmission > 0.0f) || surface.is_body() || surface.is_frosted() || surface.is_unlit)
        return glm::vec3(0.0f);
    glm::vec3 passes = surface.base_color * ((1.0f - surface.metallic) * surface.transmission);
    const float cosine = std::max(glm::dot(surface.ns, to_viewer), kLeastCosine);
    if (has_facets(surface)) {
        const GgxAlbedo albedo(surface.roughness);
        passes *= Dielectric(surface, albedo.mean()).goes_under(albedo.at(cosine));
    }
    if (largest(surface.sheen_color) > 0.0f)
        passes *= 1.0f - largest(surface.sheen_color) * sheen_albedo(cosine, surface.sheen_roughness);
    if (surface.coat > 0.0f) {
        passes *= 1.0f - surface.coat * coat_albedo(std::max(glm::dot(surface.coat_ns, to_viewer), kLeastCosine),
                                                    GgxAlbedo(surface.coat_roughness));
    }
    return passes;
}

}  // namespace zoe
