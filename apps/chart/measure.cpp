#include "apps/chart/measure.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "apps/common/interrupt.h"
#include "apps/common/lone_blas.h"
#include "engine/math/rng.h"

namespace zoe::chart {

void stop_if_interrupted() {
    if (is_interrupted()) throw Interrupted("interrupted; the same command goes on from here");
}

std::vector<std::vector<double>> measure_in_turn(std::span<const std::function<double()>> works, int rounds) {
    std::vector<std::vector<double>> results(works.size());
    for (const auto& work : works) work();
    for (int round = 0; round < rounds; ++round) {
        stop_if_interrupted();
        for (size_t k = 0; k < works.size(); ++k) {
            const size_t turn = (k + static_cast<size_t>(round)) % works.size();
            results[turn].push_back(works[turn]());
        }
    }
    return results;
}

Work work_of_rays(const TwoLevels& levels, std::span<const Ray> rays) {
    if (rays.empty()) return {};
    double nodes = 0.0, triangles = 0.0;
    uint64_t hits_hash = 0;
    for (const Ray& ray : rays) {
        TraverseCounts counts;
        RawHit hit;
        closest_hits(levels, {&ray, 1}, &hit, &counts);
        nodes += counts.nodes;
        triangles += counts.triangles;
        hits_hash = mix_bits(hits_hash ^ std::bit_cast<uint32_t>(hit.t) ^ uint64_t{hit.id} << 32);
        hits_hash = mix_bits(hits_hash ^ hit.primitive);
    }
    const auto count = static_cast<double>(rays.size());
    return {nodes / count, triangles / count, hits_hash};
}

Work work_of_rays(const Blas& blas, std::span<const Ray> rays) {
    return work_of_rays(LoneBlas(blas).levels(), rays);
}

std::string short_number(double number) {
    if (number == 0.0) return "0";
    const double size = std::abs(number);
    if (size >= 1e12 || size < 1e-4) return fmt::format("{:.2e}", number);
    if (size >= 1e9) return short_number(number / 1e9) + " billion";
    if (size >= 1e6) return short_number(number / 1e6) + " million";
    if (size >= 1000.0) {
        const std::string digits = fmt::format("{:.0f}", size);
        std::string grouped = number < 0.0 ? "-" : "";
        for (size_t k = 0; k < digits.size(); ++k) {
            if (k > 0 && (digits.size() - k) % 3 == 0) grouped += ',';
            grouped += digits[k];
        }
        return grouped;
    }
    const int decimals = std::max(0, 2 - static_cast<int>(std::floor(std::log10(size))));
    return fmt::format("{:.{}f}", number, decimals);
}

}  // namespace zoe::chart
