// The filter, pixel by pixel in double precision as its header describes it, beside the kernels that work on vectors.

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "content/content.h"
#include "engine/frame/frame.h"
#include "engine/math/rng.h"
#include "engine/render/denoise.h"
#include "engine/render/past_frame.h"
#include "engine/render/path.h"
#include "tests/bvh/each_target.h"

namespace zoe::test {
namespace {

using Color = glm::dvec3;

double bright(const Color& color) {
    return 0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b;
}

Color divisor(const glm::vec3& albedo) {
    return 0.04 + 0.96 * Color(albedo);
}

class PlainDenoiser {
public:
    void filter(const Guides& guides, const DenoiseConfig& config, Film* film) {
        width_ = film->width;
        height_ = film->height;
        guides_ = &guides;
        take_in(*film);
        std::vector<Pixel> pixels(film->sum.size());
        for (int y = 0; y < height_; ++y) {
            for (int x = 0; x < width_; ++x) pixels[at(x, y)] = follow(x, y, config);
        }
        past_ = pixels;
        past_guides_ = guides;
        for (int round = 0; round < config.rounds; ++round) {
            const std::vector<Pixel> from = pixels;
            for (int y = 0; y < height_; ++y) {
                for (int x = 0; x < width_; ++x) smooth(from, x, y, 1 << round, config.strength, &pixels[at(x, y)]);
            }
        }
        for (size_t k = 0; k < pixels.size(); ++k) {
            if (guides.node[k] == 0xffffffffu) continue;
            const Color radiance =
                double(film->sample_count) * (Color(guides.unfiltered[k]) + divisor(guides.albedo[k]) * pixels[k].light);
            film->sum[k] = glm::vec4(radiance, film->sum[k].a);
        }
    }

private:
    struct Pixel {
        Color light{0.0};
        double variance = 0.0, mean = 0.0, square = 0.0, frames = 0.0;
    };

    size_t at(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x); }
    bool is_in(int x, int y) const { return x >= 0 && x < width_ && y >= 0 && y < height_; }
    double depth(int x, int y) const { return std::min(double(guides_->depth[at(x, y)]), 1e30); }

    void take_in(const Film& film) {
        sample_.assign(film.sum.size(), Color(0.0));
        is_known_.assign(film.sum.size(), false);
        for (size_t k = 0; k < film.sum.size(); ++k) {
            const Color light = (Color(glm::vec3(film.sum[k])) / double(film.sample_count) - Color(guides_->unfiltered[k])) /
                                divisor(guides_->albedo[k]);
            is_known_[k] = guides_->node[k] != 0xffffffffu && std::isfinite(light.r + light.g + light.b);
            if (is_known_[k]) sample_[k] = glm::clamp(light, 0.0, 1e15);
        }
    }

    /// The smaller of the steps to both sides that there are.
    double slope(int x, int y, int dx, int dy) const {
        double least = INFINITY;
        for (const int side : {-1, 1}) {
            if (is_in(x + side * dx, y + side * dy))
                least = std::min(least, std::abs(depth(x + side * dx, y + side * dy) - depth(x, y)));
        }
        return std::isfinite(least) ? least : 0.0;
    }
    double slope(int x, int y) const { return std::max(slope(x, y, 1, 0), slope(x, y, 0, 1)); }

    Pixel find_past(int x, int y) const {
        const size_t k = at(x, y);
        const double at_x = guides_->was_at[k].x - 0.5, at_y = guides_->was_at[k].y - 0.5;
        Pixel sum;
        if (past_.empty() || !(at_x > -1.0 && at_x < width_ && at_y > -1.0 && at_y < height_)) return sum;
        double share = 0.0;
        for (int q_y = int(std::floor(at_y)); q_y <= int(std::floor(at_y)) + 1; ++q_y) {
            for (int q_x = int(std::floor(at_x)); q_x <= int(std::floor(at_x)) + 1; ++q_x) {
                if (!is_in(q_x, q_y)) continue;
                const size_t q = at(q_x, q_y);
                const double cosine = glm::dot(Color(past_guides_.normal[q]), Color(guides_->normal[k]));
                const double tolerance = 0.01 * std::abs(guides_->was_depth[k]) + 2.0 * slope(x, y);
                const bool is_near = std::abs(double(past_guides_.depth[q]) - guides_->was_depth[k]) <= tolerance;
                if (past_guides_.node[q] != guides_->node[k] || past_[q].frames <= 0.0 || !is_near || cosine <= 15.0 / 16.0)
                    continue;
                const double weight = (1.0 - std::abs(at_x - q_x)) * (1.0 - std::abs(at_y - q_y));
                share += weight;
                sum.light += weight * past_[q].light;
                sum.mean += weight * past_[q].mean;
                sum.square += weight * past_[q].square;
                sum.frames += weight * past_[q].frames * std::min(1.0 - 16.0 * (1.0 - cosine), 1.0);
            }
        }
        if (share < 0.05) return {};
        return {sum.light / share, 0.0, sum.mean / share, sum.square / share, sum.frames / share};
    }

    Pixel follow(int x, int y, const DenoiseConfig& config) const {
        const size_t k = at(x, y);
        double mean = 0.0, square = 0.0, count = 0.0;
        for (int dy = -4; dy <= 4; dy += 2) {
            for (int dx = -4; dx <= 4; dx += 2) {
                if (!is_in(x + dx, y + dy) || !is_known_[at(x + dx, y + dy)]) continue;
                const size_t q = at(x + dx, y + dy);
                const double weight = guides_->node[q] == guides_->node[k] ? 1.0 : 1.0 / 32.0;
                mean += weight * bright(sample_[q]);
                square += weight * bright(sample_[q]) * bright(sample_[q]);
                count += weight;
            }
        }
        if (count > 0.0) mean /= count, square /= count;
        const Pixel past = find_past(x, y);
        Pixel pixel = past;
        if (is_known_[k]) {
            pixel.frames = std::min(past.frames + 1.0, double(config.most_frames));
            const double share = 1.0 / pixel.frames, now = bright(sample_[k]);
            pixel.light += share * (sample_[k] - past.light);
            pixel.mean += share * (now - past.mean);
            pixel.square += share * (now * now - past.square);
        } else if (past.frames <= 0.0) {
            pixel.light = Color(mean);
        }
        const double variance = pixel.frames < 3.5 ? square - mean * mean : pixel.square - pixel.mean * pixel.mean;
        pixel.variance = std::max(variance, 0.0) / std::max(pixel.frames, 1.0);
        return pixel;
    }

    void smooth(const std::vector<Pixel>& from, int x, int y, int step, double strength, Pixel* result) const {
        constexpr double kShares[] = {0.25, 0.125, 0.0625};  // by how many of both directions a neighbour lies in
        const size_t k = at(x, y);
        double variance = 0.0;
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                const size_t q = at(std::clamp(x + dx, 0, width_ - 1), std::clamp(y + dy, 0, height_ - 1));
                variance += kShares[std::abs(dx) + std::abs(dy)] * from[q].variance;
            }
        }
        const double explained = strength * std::sqrt(variance) + 0.005 * bright(from[k].light) + 1e-12;
        const double slanted = 2.0 * step * slope(x, y) + 0.002 * std::abs(depth(x, y));
        Pixel sum;
        double weights = 0.0;
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                if (!is_in(x + dx * step, y + dy * step)) continue;
                const size_t q = at(x + dx * step, y + dy * step);
                const double turned =
                    32.0 * std::max(1.0 - glm::dot(Color(guides_->normal[k]), Color(guides_->normal[q])), 0.0);
                const double deeper = std::abs(depth(x, y) - depth(x + dx * step, y + dy * step)) / slanted;
                const double brighter = std::abs(bright(from[k].light) - bright(from[q].light)) / explained;
                const double like = k == q ? 1.0 : std::max(1.0 - 0.25 * (turned + deeper + brighter), 0.0);
                const double weight = kShares[std::abs(dx) + std::abs(dy)] * std::pow(like, 4.0);
                sum.light += weight * from[q].light;
                sum.variance += weight * weight * from[q].variance;
                weights += weight;
            }
        }
        result->light = sum.light / weights;
        result->variance = sum.variance / (weights * weights);
    }

    int width_ = 0, height_ = 0;
    const Guides* guides_ = nullptr;
    std::vector<Color> sample_;
    std::vector<bool> is_known_;
    std::vector<Pixel> past_;
    Guides past_guides_;
};

struct Take {
    std::vector<Film> films;
    std::vector<Guides> guides;
};

/// Frames of the default scene, seen by the camera that swings; some samples are not finite.
Take take(int width, int height, int count) {
    Content content = make_content("default");
    NodeId camera = kNone<NodeId>;
    for (uint32_t i = 0; i < content.scene.nodes.size(); ++i) {
        if (content.scene.nodes[i].name == "swing") camera = NodeId{i};
    }
    Take result;
    PastFrame past;
    Rng rng(13);
    for (int frame = 0; frame < count; ++frame) {
        const Tlas& tlas = advance(content.scene, (30 + frame) / 24.0);
        const View view = view_from_camera(content.scene, camera, float(width) / float(height));
        Guides guides;
        guides.past = &past;
        RenderConfig config;
        config.is_jittered = false;
        config.max_bounces = 2;
        config.first_number = static_cast<uint32_t>(frame);
        config.guides = &guides;
        Film film(width, height);
        render(content.scene, tlas, view, config, 1, &film, nullptr);
        past.keep(tlas, view);
        guides.past = nullptr;
        for (int i = 0; i < 20; ++i) film.sum[rng.below(film.sum.size())].x = NAN;
        result.films.push_back(film);
        result.guides.push_back(guides);
    }
    return result;
}

TEST(DenoisePlain, VectorsGiveTheSamePicturesButForRounding) {
    constexpr int kFrames = 7;
    for (const auto& [width, height] : {std::pair(101, 57), {9, 40}, {64, 3}}) {
        const Take frames = take(width, height, kFrames);
        Denoiser denoiser;
        PlainDenoiser plain;
        size_t far_count = 0, count = 0;
        for (int frame = 0; frame < kFrames; ++frame) {
            Film fast = frames.films[frame], slow = frames.films[frame];
            denoiser.filter(frames.guides[frame], {}, &fast);
            plain.filter(frames.guides[frame], {}, &slow);
            for (size_t k = 0; k < fast.sum.size(); ++k) {
                if (frames.guides[frame].node[k] == 0xffffffffu) continue;
                ++count;
                for (int c = 0; c < 3; ++c) {
                    ASSERT_TRUE(std::isfinite(fast.sum[k][c]));
                    if (!(std::abs(fast.sum[k][c] - slow.sum[k][c]) <= 1e-4f * slow.sum[k][c] + 1e-7f)) {
                        ++far_count;
                        break;
                    }
                }
            }
        }
        // Whether a past depth is near enough may be decided otherwise by rounding: that is for a pixel and those around it.
        EXPECT_LE(far_count, count / 2000) << width << "x" << height << ", of " << count;
        EXPECT_GT(count, 500u);
    }
}

TEST(DenoisePlain, AllInstructionSetsGiveTheSameBits) {
    const Take frames = take(83, 31, 6);
    std::vector<Film> first;
    on_each_target([&] {
        std::vector<Film> films = frames.films;
        Denoiser denoiser;
        for (size_t frame = 0; frame < films.size(); ++frame)
            denoiser.filter(frames.guides[frame], {.rounds = 9}, &films[frame]);
        if (first.empty()) first = films;
        for (size_t frame = 0; frame < films.size(); ++frame) {
            const std::vector<glm::vec4>&sums = films[frame].sum, &others = first[frame].sum;
            EXPECT_EQ(std::memcmp(sums.data(), others.data(), sums.size() * sizeof(glm::vec4)), 0) << "frame " << frame;
        }
    });
}

}  // namespace
}  // namespace zoe::test
