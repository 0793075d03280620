#include "engine/render/shutter.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "engine/math/rng.h"
#include "engine/render/geometry.h"

namespace zoe {

namespace {

/// Samples between two reports, where there are no slices.
constexpr int kSamplesAPart = 4;

}  // namespace

double slice_time(const Shutter& shutter, uint32_t slice) {
    Rng rng(mix_bits(shutter.seed) + slice);
    const double within = rng.uniform();
    return shutter.opens_s + shutter.open_s * ((slice + within) / shutter.slices);
}

Exposure::Exposure(const Take& take, const Shutter& shutter, const RenderConfig& config, Film* film, FrameStats* stats)
    : take_(take),
      shutter_(shutter),
      config_(config),
      film_(film),
      stats_(stats),
      tlas_(&take.advance(shutter.opens_s, stats)),
      view_(take.view()) {
    assert(shutter.open_s >= 0.0 && std::has_single_bit(shutter.slices) && film != nullptr && stats != nullptr);
    film->clear();
    if (is_sliced()) see_geometry(take.scene, *tlas_, view_, film, config.layers);
}

bool Exposure::add(int sample_count, const std::function<void(double)>& report) {
    const auto tell = [&](double share) {
        if (report) report(share);
    };
    if (!is_sliced()) {
        for (int done = 0; done < sample_count;) {
            const int part = std::min(kSamplesAPart, sample_count - done);
            if (!render(take_.scene, *tlas_, view_, config_, part, film_, stats_)) return false;
            done += part;
            tell(static_cast<double>(done) / sample_count);
        }
        return true;
    }
    for (uint32_t slice = 0; slice < shutter_.slices; ++slice) {
        const Tlas& tlas = take_.advance(slice_time(shutter_, slice), stats_);
        config_.slice = Slice{slice, shutter_.slices};
        const uint64_t rays_before = stats_->rays;
        if (!render(take_.scene, tlas, take_.view(), config_, sample_count, film_, stats_)) return false;
        report_rays(take_.scene, stats_->rays - rays_before);
        tell((slice + 1.0) / shutter_.slices);
    }
    return true;
}

}  // namespace zoe
