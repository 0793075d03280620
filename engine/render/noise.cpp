#include "engine/render/noise.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/render/luminance.h"

namespace zoe {

namespace {

constexpr size_t kBlockSide = 8;
constexpr uint32_t kAllSamples = std::numeric_limits<uint32_t>::max();
/// Of a neighbouring block's variance, what counts as one's own.
constexpr double kNeighbourShare = 0.25;
constexpr int kSamplesAPass = 4;  ///< Between two looks at the clock.

/// Which of the two kinds of squares a pixel is on.
size_t square(size_t x, size_t y) {
    return (x + y) & 1;
}

/// The samples that a pixel is to have after `count`, where one sample has this relative variance: a quarter, a half, three
/// quarters more, or all of twice as many and to be judged again.
uint32_t samples_needed(double variance, double target, uint32_t count) {
    const double needed = variance / (target * target);
    if (!(needed < 2.0 * count)) return kAllSamples;
    if (needed <= count) return count;
    const uint32_t step = std::max(count / 4, 1u);
    return count + step * static_cast<uint32_t>(std::ceil((needed - count) / step));
}

}  // namespace

bool NoiseLimit::expose(const NoiseConfig& config, int most_samples, Exposure* exposure,
                        const std::function<bool()>& may_go_on, const std::function<void(double)>& report) {
    assert(config.target >= 0.0f && config.least_samples >= 2 && config.least_luminance > 0.0f);
    Film& film = exposure->film();
    assert(film.sample_count == 0);
    const bool is_judged = config.target > 0.0f;
    const int pass = may_go_on ? kSamplesAPass : most_samples;
    half_luminance_.assign(film.sum.size(), 0.0f);
    variance_.assign(film.sum.size(), 0.0f);
    int last = most_samples;
    int goal = is_judged ? std::min(config.least_samples / 2, most_samples) : most_samples;
    while (true) {
        while (film.sample_count < goal) {
            const int done = film.sample_count, count = std::min(pass, goal - done);
            const auto report_part = [&](double share) {
                if (report) report((done + share * count) / most_samples);
            };
            if (!exposure->add(count, std::cref(report_part))) return false;
            if (may_go_on && !may_go_on()) return true;
        }
        if (goal == last) return true;
        uint32_t most_needed = kAllSamples;
        if (film.sample_count >= config.least_samples) {
            measure(config, film);
            most_needed = judge(config, &film);
            if (most_needed <= static_cast<uint32_t>(goal)) return true;
        }
        for (size_t k = 0; k < film.sum.size(); ++k) half_luminance_[k] = luminance(glm::vec3(film.sum[k]));
        if (most_needed < static_cast<uint32_t>(2 * goal)) last = std::min(last, static_cast<int>(most_needed));
        goal = std::min(2 * goal, last);
    }
}

void NoiseLimit::measure(const NoiseConfig& config, const Film& film) {
    const uint32_t count = static_cast<uint32_t>(film.sample_count);
    for (size_t k = 0; k < film.sum.size(); ++k) {
        if (film.samples_of(k) < count) continue;  // What was known when it stopped stays.
        const float whole = luminance(glm::vec3(film.sum[k])), first = half_luminance_[k];
        // The means of the halves differ by twice the error of theirs: (2 first - 2 (whole - first)) / count.
        const float error = std::abs(2.0f * first - whole), least = config.least_luminance * static_cast<float>(count);
        const float relative = error / std::max(whole, least);
        variance_[k] = relative * relative * static_cast<float>(count);
    }
}

uint32_t NoiseLimit::judge(const NoiseConfig& config, Film* film) {
    const size_t width = static_cast<size_t>(film->width), height = static_cast<size_t>(film->height);
    const size_t across = (width + kBlockSide - 1) / kBlockSide, down = (height + kBlockSide - 1) / kBlockSide;
    blocks_.assign(across * down, {});
    for (size_t y = 0; y < height; ++y) {
        for (size_t x = 0; x < width; ++x) {
            Sum& sum = blocks_[y / kBlockSide * across + x / kBlockSide].on[square(x, y)];
            sum.variances += variance_[y * width + x];
            ++sum.pixel_count;
        }
    }
    const auto variance_by = [&](size_t judges, size_t column, size_t row) {
        const Sum& own = blocks_[row * across + column].on[judges];
        double worst = own.pixel_count > 0 ? own.mean() : std::numeric_limits<double>::infinity();
        for (size_t r = row > 0 ? row - 1 : 0; r < std::min(row + 2, down); ++r) {
            for (size_t c = column > 0 ? column - 1 : 0; c < std::min(column + 2, across); ++c)
                worst = std::max(worst, kNeighbourShare * blocks_[r * across + c].on[judges].mean());
        }
        return worst;
    };
    const uint32_t count = static_cast<uint32_t>(film->sample_count);
    needed_.resize(blocks_.size());
    for (size_t row = 0; row < down; ++row) {
        for (size_t column = 0; column < across; ++column) {
            for (const size_t judged : {0, 1}) {
                needed_[row * across + column][judged] =
                    samples_needed(variance_by(1 - judged, column, row), config.target, count);
            }
        }
    }
    if (film->enough.empty()) film->enough.assign(film->sum.size(), kAllSamples);
    uint32_t most = 0;
    for (size_t y = 0; y < height; ++y) {
        for (size_t x = 0; x < width; ++x) {
            uint32_t& enough = film->enough[y * width + x];
            if (enough > count) enough = needed_[y / kBlockSide * across + x / kBlockSide][square(x, y)];
            most = std::max(most, enough);
        }
    }
    return most;
}

double mean_samples(const Film& film) {
    double sum = 0.0;
    for (size_t k = 0; k < film.sum.size(); ++k) sum += film.samples_of(k);
    return film.sum.empty() ? 0.0 : sum / static_cast<double>(film.sum.size());
}

}  // namespace zoe
