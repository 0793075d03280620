#include "apps/demo/pace.h"

#include <algorithm>

namespace zoe {
namespace {

constexpr double kBudgetMs = 1000.0 / 24.0;  // as films have it
constexpr double kLeastMs = 12.0;            // for pixels, however long the rest takes
constexpr double kEarly = 0.9;               // of the time that there is
constexpr int kPatience = 12;                // pictures in a row that might have been larger, before one is
constexpr double kNew = 0.3;                 // share of the latest picture in the mean
constexpr int kMaxDivisor = 12;

}  // namespace

int Pace::choose_divisor(double pixel_count, double other_ms) {
    if (!(ms_a_pixel_ > 0.0)) return divisor_;
    const double room_ms = std::max(kBudgetMs - other_ms, kLeastMs);
    const auto takes_ms = [&](int divisor) { return ms_a_pixel_ * pixel_count / (double(divisor) * divisor); };
    while (divisor_ < kMaxDivisor && takes_ms(divisor_) > room_ms) {
        ++divisor_;
        early_count_ = 0;
    }
    const auto may_grow = [&] { return divisor_ > 1 && takes_ms(divisor_ - 1) < kEarly * room_ms; };
    early_count_ = may_grow() ? early_count_ + 1 : 0;
    if (early_count_ < kPatience) return divisor_;
    while (may_grow()) --divisor_;
    early_count_ = 0;
    return divisor_;
}

void Pace::note(double pixel_count, double ms) {
    const double latest = ms / pixel_count;
    ms_a_pixel_ = ms_a_pixel_ > 0.0 ? (1.0 - kNew) * ms_a_pixel_ + kNew * latest : latest;
}

}  // namespace zoe
