#include "engine/render/albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>

#include "engine/render/microfacet.h"

namespace zoe {

namespace {

constexpr int kSize = 32;                             // entries of cosine and of roughness
constexpr int kFacets = 1024;                         // that an entry is the mean of
constexpr int kSheenHeights = 64, kSheenAngles = 32;  // directions
constexpr int kMeanSteps = 256;

/// Entries over the root of the cosine, which is where curves bend, and over roughness.
template <typename T>
struct Table {
    std::array<std::array<T, kSize>, kSize> at{};  // [roughness][root of the cosine]
};

float cosine_of(int i) {
    const float root = static_cast<float>(i) / (kSize - 1);
    return std::max(root * root, 1e-4f);
}

float roughness_of(int i) {
    return static_cast<float>(i) / (kSize - 1);
}

/// Where a value in [0, 1] is between two entries.
struct Between {
    size_t first;
    float rest;
};

Between between(float x) {
    const float scaled = std::clamp(x, 0.0f, 1.0f) * (kSize - 1);
    const int first = std::min(static_cast<int>(scaled), kSize - 2);
    return {static_cast<size_t>(first), scaled - static_cast<float>(first)};
}

Albedo mix_albedo(const Albedo& a, const Albedo& b, float t) {
    return {glm::mix(a.all, b.all, t), glm::mix(a.edge, b.edge, t)};
}

/// Between two rows, and between two entries of each.
template <typename T, typename Mix>
T look_up(const T* low, const T* high, float rest, float cosine, Mix&& mix) {
    const Between c = between(std::sqrt(std::max(cosine, 0.0f)));
    return mix(mix(low[c.first], low[c.first + 1], c.rest), mix(high[c.first], high[c.first + 1], c.rest), rest);
}

glm::vec3 direction_of(float cosine) {
    return {std::sqrt(1.0f - cosine * cosine), 0.0f, cosine};
}

/// Over facets as they are seen, on a lattice: where they cease to reflect upwards is then met at as many heights. The other
/// half of the angles mirrors the first.
Albedo measure_ggx(float cosine, float roughness) {
    constexpr double kGoldenRatio = 0.6180339887498949;
    const glm::vec3 viewer = direction_of(cosine);
    const float alpha = alpha_of(roughness);
    double all = 0.0, edge = 0.0;
    for (int i = 0; i < kFacets; ++i) {
        const double turn = (i + 0.5) * kGoldenRatio;
        const glm::vec2 u(0.5f * static_cast<float>(turn - std::floor(turn)), (static_cast<float>(i) + 0.5f) / kFacets);
        const glm::vec3 facet = sample_seen_normal(viewer, alpha, u);
        const float along = glm::dot(viewer, facet);
        const glm::vec3 light = 2.0f * along * facet - viewer;
        if (!(light.z > 0.0f)) continue;
        const double share = static_cast<double>(ggx_seen_by_both(viewer, light, alpha) / ggx_seen(viewer, alpha));
        all += share;
        edge += share * static_cast<double>(schlick_share(along));
    }
    return {static_cast<float>(all / kFacets), static_cast<float>(edge / kFacets)};
}

/// Over directions, uniform in their solid angle.
float measure_sheen(float cosine, float roughness) {
    const glm::vec3 viewer = direction_of(cosine);
    double sum = 0.0;
    for (int i = 0; i < kSheenHeights; ++i) {
        const float z = (static_cast<float>(i) + 0.5f) / kSheenHeights;
        const float radius = std::sqrt(1.0f - z * z);
        for (int j = 0; j < kSheenAngles; ++j) {
            const float angle = (static_cast<float>(j) + 0.5f) * glm::pi<float>() / kSheenAngles;
            const glm::vec3 light(radius * std::cos(angle), radius * std::sin(angle), z);
            sum += static_cast<double>(sheen(viewer, light, sheen_alpha(roughness)));
        }
    }
    return static_cast<float>(sum * glm::two_pi<double>() / (kSheenHeights * kSheenAngles));
}

/// On the calling thread alone: it may be one of many that wait for the table.
template <typename T, typename Measure>
Table<T> make_table(Measure&& measure) {
    Table<T> table;
    for (int r = 0; r < kSize; ++r) {
        for (int c = 0; c < kSize; ++c) {
            table.at[static_cast<size_t>(r)][static_cast<size_t>(c)] = measure(cosine_of(c), roughness_of(r));
        }
    }
    return table;
}

struct GgxTables {
    Table<Albedo> albedo = make_table<Albedo>(&measure_ggx);
    std::array<Albedo, kSize> mean{};

    GgxTables() {
        for (int r = 0; r < kSize; ++r) {
            const Between rows = between(roughness_of(r));
            const Albedo *const low = albedo.at[rows.first].data(), *const high = albedo.at[rows.first + 1].data();
            double all = 0.0, edge = 0.0;
            for (int i = 0; i < kMeanSteps; ++i) {
                const float cosine = (static_cast<float>(i) + 0.5f) / kMeanSteps;
                const Albedo at = look_up(low, high, rows.rest, cosine, &mix_albedo);
                all += static_cast<double>(at.all * 2.0f * cosine);
                edge += static_cast<double>(at.edge * 2.0f * cosine);
            }
            mean[static_cast<size_t>(r)] = {static_cast<float>(all / kMeanSteps), static_cast<float>(edge / kMeanSteps)};
        }
    }
};

const GgxTables& ggx_tables() {
    static const GgxTables tables;
    return tables;
}

const Table<float>& sheen_table() {
    static const Table<float> table = make_table<float>(&measure_sheen);
    return table;
}

}  // namespace

GgxAlbedo::GgxAlbedo(float roughness) {
    const GgxTables& tables = ggx_tables();
    const Between r = between(roughness);
    smoother_ = tables.albedo.at[r.first].data();
    rougher_ = tables.albedo.at[r.first + 1].data();
    rest_ = r.rest;
    mean_ = mix_albedo(tables.mean[r.first], tables.mean[r.first + 1], r.rest);
}

Albedo GgxAlbedo::at(float cosine) const {
    return look_up(smoother_, rougher_, rest_, cosine, &mix_albedo);
}

float sheen_albedo(float cosine, float roughness) {
    const auto mix = [](float a, float b, float t) { return glm::mix(a, b, t); };
    const Between r = between(roughness);
    const float *const smoother = sheen_table().at[r.first].data(), *const rougher = sheen_table().at[r.first + 1].data();
    return std::min(look_up(smoother, rougher, r.rest, cosine, mix) * sheen_scale(roughness), 1.0f);
}

float sheen_scale(float roughness) {
    const Between r = between(roughness);
    const auto most = [](const auto& row) { return std::max(1.0f, *std::max_element(row.begin(), row.end())); };
    return 1.0f / std::max(most(sheen_table().at[r.first]), most(sheen_table().at[r.first + 1]));
}

}  // namespace zoe
