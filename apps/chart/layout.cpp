#include "apps/chart/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace zoe::chart {
namespace {

// Pixels.
constexpr int kQuestion = 40, kLegendRow = 20, kCaptionLine = 17, kMargin = 14;
constexpr int kPanelLeft = 88, kPanelRight = 18, kPanelTop = 28, kPanelBottom = 52;
constexpr int kLegendEntry = 150;
constexpr size_t kCaptionWidth = 136;  // Characters.

int ceiling(int count, int by) {
    return (count + by - 1) / by;
}

/// 1, 2 and 5 times powers of ten; those alone where there are many, every other one where there are very many.
std::vector<double> log_ticks(double begin, double end) {
    std::vector<double> ticks;
    const double decades = std::log10(end / begin);
    const int first = static_cast<int>(std::floor(std::log10(begin))), step = decades > 5.0 ? 2 : 1;
    for (int exponent = first - (first & 1); exponent <= std::log10(end); exponent += step) {
        for (const double digit : {1.0, 2.0, 5.0}) {
            const double tick = digit * std::pow(10.0, exponent);
            if (tick >= begin && tick <= end && (digit == 1.0 || decades <= 2.0)) ticks.push_back(tick);
        }
    }
    return ticks;
}

Scale scale(const Panel& panel, const Axis& axis, Spread Point::*of_point, double room_share) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Series& series : panel.series) {
        for (const Point& point : series.points) {
            low = std::min(low, (point.*of_point).low);
            high = std::max(high, (point.*of_point).high);
        }
    }
    if (low > high) return {.begin = 1.0, .end = 10.0, .ticks = {}};
    if (axis.is_log) {
        const double room = std::max(std::pow(high / low, room_share), 1.1);
        return {.begin = low / room, .end = high * room, .ticks = log_ticks(low / room, high * room)};
    }
    const double room = std::max(room_share * (high - low), 1e-3 * std::max(std::abs(low), std::abs(high)));
    // What cannot be negative does not look as if it could.
    return {.begin = low >= 0.0 ? std::max(0.0, low - room) : low - room, .end = high + std::max(room, 1e-9), .ticks = {}};
}

}  // namespace

Scale x_scale(const Panel& panel) {
    return scale(panel, panel.x, &Point::x, panel.has_labels ? 0.35 : 0.07);
}
Scale y_scale(const Panel& panel) {
    return scale(panel, panel.y, &Point::y, panel.has_labels ? 0.12 : 0.07);
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
