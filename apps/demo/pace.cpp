#include "apps/demo/pace.h"

#include <algorithm>

namespace zoe {
namespace {

constexpr double kBudgetMs = 1000.0 / 24.0;  // as films have it
constexpr double kLeastMs = 12.0;            // for pixels, however long the rest takes
constexpr double kSurfaces = 0.5;            // share of the pixels' time; chart `upsample`
constexpr double kEarly = 0.9;               // of the time that there is
constexpr int kPatience = 12;                // pictures in a row that might have been larger, before one is
constexpr double kNew = 0.3;                 // share of the latest picture in the mean
constexpr int kMaxDivisor = 12;
constexpr int kMemory = 240;  // pictures without surfaces of their own, before these are tried again

double room_beside(double other_ms) {
    return std::max(kBudgetMs - other_ms, kLeastMs);
}

}  // namespace

int Pace::Size::choose(double whole_ms, double room_ms) {
    if (!(whole_ms > 0.0)) return divisor;
    const auto takes_ms = [&](int d) { return whole_ms / (double(d) * d); };
    while (divisor < kMaxDivisor && takes_ms(divisor) > room_ms) {
        ++divisor;
        early_count = 0;
    }
    const auto may_grow = [&] { return divisor > 1 && takes_ms(divisor - 1) < kEarly * room_ms; };
    early_count = may_grow() ? early_count + 1 : 0;
    if (early_count < kPatience) return divisor;
    while (may_grow()) --divisor;
    early_count = 0;
    return divisor;
}

PlaySizes Pace::choose(double pixel_count, double other_ms) {
    const double room_ms = room_beside(other_ms), light_ms = light_ms_ * pixel_count, surface_ms = surface_ms_ * pixel_count;
    const int lone = lone_light_.choose(light_ms, room_ms), surfaces = surfaces_.choose(surface_ms, kSurfaces * room_ms);
    const int light = light_.choose(light_ms, room_ms - surface_ms / (double(surfaces) * surfaces));
    if (lone <= surfaces) {
        if (++lone_count_ == kMemory) {  // What is known of surfaces is old, and may be of a moment when all was slow.
            surface_ms_ = 0.0;
            surfaces_ = {std::max(1, lone / 2)};
        }
        return {lone, lone};
    }
    lone_count_ = 0;
    return {std::max(light, surfaces), surfaces};
}

int Pace::choose_unlit(double pixel_count, double other_ms) {
    return lone_surfaces_.choose(surface_ms_ * pixel_count, room_beside(other_ms));
}

void Pace::note(double pixel_count, double ms, double* ms_a_pixel) {
    const double latest = ms / pixel_count;
    *ms_a_pixel = *ms_a_pixel > 0.0 ? (1.0 - kNew) * *ms_a_pixel + kNew * latest : latest;
}

}  // namespace zoe
