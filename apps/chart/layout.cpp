#include "apps/chart/layout.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <sstream>

#include <fmt/format.h>

namespace zoe::chart {
namespace {

// Pixels.
constexpr int kQuestion = 40, kLegendRow = 20, kCaptionLine = 17, kMargin = 14;
constexpr int kPanelLeft = 88, kPanelRight = 18, kPanelTop = 28, kPanelBottom = 52;
constexpr int kLegendEntry = 150;
constexpr double kTickCharacter = 5.6, kTickGap = 8.0, kTickHeight = 20.0;
constexpr size_t kCaptionWidth = 136;  // Characters.

int ceiling(int count, int by) {
    return (count + by - 1) / by;
}

/// "0.001", "1,000", "1e7".
std::string tick_text(double number) {
    if (number == 0.0) return "0";
    const double size = std::abs(number);
    const std::string sign = number < 0.0 ? "-" : "";
    if (size >= 1e6 || size < 1e-3) {
        const int exponent = static_cast<int>(std::floor(std::log10(size) + 1e-9));
        return fmt::format("{}{:g}e{}", sign, size / std::pow(10.0, exponent), exponent);
    }
    std::string digits = fmt::format("{:.6g}", size);
    const size_t whole = std::min(digits.find('.'), digits.size());
    if (whole > 3) digits.insert(whole - 3, ",");
    return sign + digits;
}

using Ticks = std::vector<Tick>;

/// Multiples of a step, which is a whole number.
Ticks multiples(double begin, double end, double digit, int exponent) {
    // A power of ten that is exact divides: 3 * 0.1 is not 0.3.
    const double whole = std::pow(10.0, std::abs(exponent));
    Ticks ticks;
    const auto at = [&](double count) { return exponent < 0 ? count * digit / whole : count * digit * whole; };
    const double step = at(1.0);
    for (double count = std::ceil(begin / step - 1e-9); at(count) <= end + 1e-9 * step; ++count)
        ticks.push_back({at(count), tick_text(at(count))});
    return ticks;
}

/// Some digits times every so many powers of ten.
Ticks powers(double begin, double end, std::initializer_list<double> digits, int step) {
    Ticks ticks;
    const int last = static_cast<int>(std::ceil(std::log10(end)));
    for (int exponent = static_cast<int>(std::floor(std::log10(begin))); exponent <= last; ++exponent) {
        if (exponent % step != 0) continue;
        for (const double digit : digits) {
            const double tick = exponent < 0 ? digit / std::pow(10.0, -exponent) : digit * std::pow(10.0, exponent);
            if (tick >= begin && tick <= end) ticks.push_back({tick, tick_text(tick)});
        }
    }
    return ticks;
}

bool do_fit(const Ticks& ticks, const Scale& scale, double pixels, bool is_across) {
    for (size_t k = 1; k < ticks.size(); ++k) {
        const double gap = pixels * (scale.share(ticks[k].at) - scale.share(ticks[k - 1].at));
        const auto characters = static_cast<double>(ticks[k].text.size() + ticks[k - 1].text.size());
        if (gap < (is_across ? kTickGap + 0.5 * kTickCharacter * characters : kTickHeight)) return false;
    }
    return true;
}

/// The densest that fit, of even steps where the range is not wide, else of powers of ten.
Ticks make_ticks(const Scale& scale, bool is_whole, double pixels, bool is_across) {
    if (!scale.is_log || scale.end < 10.0 * scale.begin) {
        const int first = static_cast<int>(std::floor(std::log10(scale.end - scale.begin))) - 2;
        for (int exponent = is_whole ? std::max(first, 0) : first;; ++exponent) {
            for (const double digit : {1.0, 2.0, 5.0}) {
                // More than pixels are not looked at one by one.
                if (scale.end - scale.begin > pixels * digit * std::pow(10.0, exponent)) continue;
                Ticks ticks = multiples(scale.begin, scale.end, digit, exponent);
                if (do_fit(ticks, scale, pixels, is_across)) return ticks;
            }
        }
    }
    Ticks ticks = powers(scale.begin, scale.end, {1.0, 2.0, 5.0}, 1);
    for (int step = 1; !do_fit(ticks, scale, pixels, is_across); ++step) ticks = powers(scale.begin, scale.end, {1.0}, step);
    return ticks;
}

Scale make_scale(const Panel& panel, const Axis& axis, Spread Point::*of_point, double room_share) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Series& series : panel.series) {
        for (const Point& point : series.points) {
            low = std::min(low, (point.*of_point).low);
            high = std::max(high, (point.*of_point).high);
        }
    }
    if (low > high) return {.begin = 1.0, .end = 10.0, .is_log = axis.is_log, .ticks = {}};
    if (axis.is_log) {
        const double room = std::max(std::pow(high / low, room_share), 1.1);
        return {.begin = low / room, .end = high * room, .is_log = true, .ticks = {}};
    }
    const double room = std::max(room_share * (high - low), 1e-3 * std::max(std::abs(low), std::abs(high)));
    // What cannot be negative does not look as if it could.
    return {.begin = low >= 0.0 ? std::max(0.0, low - room) : low - room,
            .end = high + std::max(room, 1e-9),
            .is_log = false,
            .ticks = {}};
}

}  // namespace

double Scale::share(double number) const {
    return is_log ? std::log(number / begin) / std::log(end / begin) : (number - begin) / (end - begin);
}

Scale x_scale(const Panel& panel, double pixels) {
    Scale scale = make_scale(panel, panel.x, &Point::x, panel.has_labels ? 0.2 : 0.07);
    scale.ticks = make_ticks(scale, panel.x.is_whole, pixels, true);
    return scale;
}
Scale y_scale(const Panel& panel, double pixels) {
    Scale scale = make_scale(panel, panel.y, &Point::y, panel.has_labels ? 0.15 : 0.07);
    scale.ticks = make_ticks(scale, panel.y.is_whole, pixels, false);
    return scale;
}

std::vector<std::string> wrap(const std::string& text, size_t width) {
    std::vector<std::string> lines;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (!lines.empty() && lines.back().size() + 1 + word.size() <= width) {
            lines.back() += ' ' + word;
        } else {
            lines.push_back(word);
        }
    }
    return lines;
}

Layout::Layout(const Chart& chart)
    : columns_(std::max(1, std::min(chart.columns, static_cast<int>(chart.panels.size())))),
      rows_(ceiling(static_cast<int>(chart.panels.size()), columns_)),
      caption_lines_(wrap(chart.caption, kCaptionWidth)) {
    for (const Panel& panel : chart.panels) {
        for (const Series& series : panel.series)
            if (std::ranges::find(series_, series.name) == series_.end()) series_.push_back(series.name);
    }
    // Two entries more: the default and the Pareto front.
    legend_rows_ = ceiling(static_cast<int>(series_.size()) + 2, kWidth / kLegendEntry);
    panel_height_ = columns_ == 1 ? 400 : columns_ == 2 ? 340 : 280;
    height_ = kQuestion + rows_ * panel_height_ + legend_rows_ * kLegendRow +
              static_cast<int>(caption_lines_.size()) * kCaptionLine + 2 * kMargin;
}

Layout::Box Layout::panel(size_t index) const {
    const int row = static_cast<int>(index) / columns_, column = static_cast<int>(index) % columns_;
    const double width = double(kWidth) / columns_, left = column * width, top = kQuestion + row * panel_height_;
    return {.left = (left + kPanelLeft) / kWidth,
            .right = (left + width - kPanelRight) / kWidth,
            .bottom = share(top + panel_height_ - kPanelBottom),
            .top = share(top + kPanelTop)};
}

Layout::Box Layout::legend() const {
    const double top = kQuestion + rows_ * panel_height_;
    return {.left = 0.02, .right = 0.98, .bottom = share(top + legend_rows_ * kLegendRow), .top = share(top)};
}

double Layout::question_y() const {
    return share(0.5 * kQuestion);
}

double Layout::caption_y(size_t line) const {
    const double top = kQuestion + rows_ * panel_height_ + legend_rows_ * kLegendRow + kMargin;
    return share(top + (static_cast<double>(line) + 0.5) * kCaptionLine);
}

}  // namespace zoe::chart
