// The method, pixel by pixel in double precision as its header describes it, over all samples of the light.

#include "engine/render/upsample.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "engine/math/rng.h"
#include "tests/render/upsample_frames.h"

namespace zoe::test {
namespace {

class PlainUpsampler {
public:
    struct Result {
        glm::dvec3 radiance;
        double brightest = 0.0;  ///< What of the light beside it would show.
        double weight = 1.0;     ///< Of all samples that count.
        bool is_tight = false;   ///< Rounding may decide otherwise.
    };
    PlainUpsampler(const Guides& from_guides, const Film& from) : guides_(from_guides) {
        glm::dvec3 sum(0.0);
        for (size_t k = 0; k < from.sum.size(); ++k) {
            const glm::dvec3 light =
                (glm::dvec3(from.sum[k]) / double(from.sample_count) - glm::dvec3(guides_.unfiltered[k])) /
                divisor(guides_.albedo[k]);
            const bool is_known = guides_.node[k] != kNoNode && guides_.normal[k] != glm::vec3(0.0f) &&
                                  std::isfinite(light.r + light.g + light.b);
            is_known_.push_back(is_known);
            light_.push_back(is_known ? glm::clamp(light, 0.0, 1e15) : glm::dvec3(0.0));
            sum += light_.back();
        }
        const auto known_count = std::ranges::count(is_known_, true);
        if (known_count > 0) mean_ = sum / double(known_count);
    }

    Result at(const Guides& guides, int x, int y) const {
        const size_t k = size_t{1} * y * guides.width + x;
        if (guides.node[k] == kNoNode || guides.normal[k] == glm::vec3(0.0f)) return {guides.unfiltered[k]};
        Place here{.x = place(x, guides.width, guides_.width),
                   .y = place(y, guides.height, guides_.height),
                   .slope_x = slope(guides, x, y, 1, 0) * guides.width / guides_.width,
                   .slope_y = slope(guides, x, y, 0, 1) * guides.height / guides_.height,
                   .guides = guides,
                   .k = k};
        Result result;
        const glm::dvec3 light = light_at(here, &result), by = divisor(guides.albedo[k]);
        glm::dvec3 most = mean_;
        for (size_t q = 0; q < light_.size(); ++q) {
            if (is_near(here, q, 2.0 + kTight)) most = glm::max(most, light_[q]);
        }
        result.brightest = std::max({by.r * most.r, by.g * most.g, by.b * most.b});
        result.radiance = glm::dvec3(guides.unfiltered[k]) + by * light;
        return result;
    }

private:
    static constexpr double kTight = 1e-4;
    struct Place {
        double x, y, slope_x, slope_y;
        const Guides& guides;
        size_t k;
    };
    double dx(const Place& here, size_t q) const { return std::abs(double(q % size_t(guides_.width)) - here.x); }
    double dy(const Place& here, size_t q) const { return std::abs(double(q / size_t(guides_.width)) - here.y); }
    bool is_near(const Place& here, size_t q, double reach) const {
        return is_known_[q] && dx(here, q) < reach && dy(here, q) < reach;
    }

    /// At the border that of the pixel beside it.
    static double slope(const Guides& guides, int x, int y, int right, int down) {
        if (guides.width > 2 && right == 1) x = std::clamp(x, 1, guides.width - 2);
        if (guides.height > 2 && down == 1) y = std::clamp(y, 1, guides.height - 2);
        const auto index_of = [&](int i, int j) { return size_t{1} * j * guides.width + i; };
        double least = INFINITY;
        for (const int side : {-1, 1}) {
            const int i = x + side * right, j = y + side * down;
            if (i < 0 || j < 0 || i >= guides.width || j >= guides.height) continue;
            if (guides.node[index_of(i, j)] != guides.node[index_of(x, y)]) continue;
            least = std::min(least, std::abs(double(guides.depth[index_of(i, j)]) - guides.depth[index_of(x, y)]));
        }
        return std::isfinite(least) ? least : 0.0;
    }
    double unlike_normals(const Place& here, size_t q) const {
        return 1.0 - glm::dot(glm::dvec3(here.guides.normal[here.k]), glm::dvec3(guides_.normal[q]));
    }

    double likeness(const Place& here, size_t q, bool* is_tight) const {
        if (guides_.node[q] != here.guides.node[here.k]) return 0.0;
        const double depth = here.guides.depth[here.k];
        const double rise = 2.0 * (here.slope_x * dx(here, q) + here.slope_y * dy(here, q)) + 0.01 * std::abs(depth);
        const double deeper = 2.0 - 2.0 * std::abs(guides_.depth[q] - depth) / rise;
        const double turned = 1.0 - 4.0 * unlike_normals(here, q);
        if (std::abs(std::min(deeper, turned)) < kTight) *is_tight = true;
        return std::max(0.0, std::min(deeper, 1.0)) * std::max(0.0, std::min(turned, 1.0));
    }

    glm::dvec3 light_at(const Place& here, Result* result) const {
        for (const double reach : {1.0, 2.0}) {
            glm::dvec3 sum(0.0);
            double weights = 0.0, most_alike = 0.0;
            for (size_t q = 0; q < light_.size(); ++q) {
                if (!is_near(here, q, reach + kTight)) continue;
                const double like = likeness(here, q, &result->is_tight);
                const double weight = like * std::max(reach - dx(here, q), 0.0) * std::max(reach - dy(here, q), 0.0);
                most_alike = std::max(most_alike, like);
                sum += weight * light_[q];
                weights += weight;
            }
            if (most_alike > 0.0 && weights < kTight) result->is_tight = true;
            result->weight = weights;
            if (weights > 0.0) return sum / weights;
        }
        result->weight = 1.0;
        double least = INFINITY;
        glm::dvec3 light = mean_;
        for (size_t q = 0; q < light_.size(); ++q) {
            if (!is_near(here, q, 2.0 + kTight)) continue;
            if (dx(here, q) > 2.0 - kTight || dy(here, q) > 2.0 - kTight) result->is_tight = true;
            const double depth = here.guides.depth[here.k], other = guides_.depth[q];
            const double difference = (guides_.node[q] != here.guides.node[here.k] ? 1.0 : 0.0) +
                                      std::abs(other - depth) / (std::abs(other) + std::abs(depth)) +
                                      unlike_normals(here, q) + (dx(here, q) + dy(here, q)) / 16.0;
            if (std::abs(difference - least) < kTight) result->is_tight = true;
            if (difference < least) {
                least = difference;
                light = light_[q];
            }
        }
        return light;
    }

    const Guides& guides_;
    std::vector<glm::dvec3> light_;
    std::vector<bool> is_known_;
    glm::dvec3 mean_{0.0};
};

TEST(UpsamplePlain, IsWhatItsHeaderSaysButForRounding) {
    Frames frames;
    frames.advance_to(1.5);
    Rng rng(3);
    size_t compared = 0, tight = 0;
    for (const auto& [small, large] : {std::pair(Size{32, 18}, Size{128, 72}),
                                       {Size{33, 19}, Size{101, 57}},
                                       {Size{16, 9}, Size{80, 90}},
                                       {Size{40, 30}, Size{40, 30}}}) {
        Guides from_guides, guides;
        Film from = frames.sample(small, true, &from_guides);
        Film film = frames.sample(large, false, &guides);
        for (int i = 0; i < 10; ++i) from.sum[rng.below(from.sum.size())].y = NAN;
        const PlainUpsampler plain(from_guides, from);
        Upsampler().light(from_guides, from, guides, &film);
        for (int y = 0; y < large.height; ++y) {
            for (int x = 0; x < large.width; ++x) {
                const PlainUpsampler::Result expected = plain.at(guides, x, y);
                if (expected.is_tight) {
                    ++tight;
                    continue;
                }
                // Of a place's rounding, weights have a share that grows as their sum falls.
                const double tolerance = 1e-4 * expected.brightest / std::min(expected.weight, 1.0) + 1e-6;
                const glm::vec4& sum = film.sum[size_t{1} * y * large.width + x];
                for (int c = 0; c < 3; ++c)
                    ASSERT_NEAR(sum[c], expected.radiance[c], tolerance + 1e-6 * expected.radiance[c]) << x << ' ' << y;
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 15'000u);
    EXPECT_LT(tight, compared / 20);
}

}  // namespace
}  // namespace zoe::test
