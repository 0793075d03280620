#include "apps/chart/chart.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "apps/chart/style.h"

namespace zoe::chart {
namespace {

/// Between neighbours where the place is none of theirs.
double at_share(const std::vector<double>& sorted, double share) {
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto before = static_cast<size_t>(place);
    const size_t after = std::min(before + 1, sorted.size() - 1);
    return std::lerp(sorted[before], sorted[after], place - static_cast<double>(before));
}

}  // namespace

Spread spread_of(std::vector<double> numbers) {
    assert(!numbers.empty() && std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }));
    std::ranges::sort(numbers);
    return {at_share(numbers, 0.5), at_share(numbers, 0.25), at_share(numbers, 0.75)};
}

const Series* Panel::find(const std::string& series_name) const {
    const auto found = std::ranges::find(series, series_name, &Series::name);
    return found == series.end() ? nullptr : &*found;
}

const Panel& Chart::panel(const std::string& panel_name) const {
    const auto found = std::ranges::find(panels, panel_name, &Panel::name);
    if (found == panels.end()) throw std::logic_error(name + ": no panel '" + panel_name + "'");
    return *found;
}

Panel& Chart::panel(const std::string& panel_name) {
    return const_cast<Panel&>(std::as_const(*this).panel(panel_name));
}

const Point& Chart::point(const std::string& panel_name, const std::string& series_name, double x) const {
    if (const Series* const found = panel(panel_name).find(series_name)) {
        for (const Point& point : found->points)
            if (point.x.median == x) return point;
    }
    throw std::logic_error(name + ": no such point of '" + series_name + "'");
}

std::vector<Point> pareto_front(const Panel& panel) {
    std::vector<Point> points;
    for (const Series& series : panel.series) {
        if (!style_of(series.name).is_peer) points.insert(points.end(), series.points.begin(), series.points.end());
    }
    const double sign = panel.y.is_more_better ? -1.0 : 1.0;
    std::ranges::stable_sort(points, [&](const Point& a, const Point& b) {
        return a.x.median != b.x.median ? a.x.median < b.x.median : sign * a.y.median < sign * b.y.median;
    });
    std::vector<Point> front;
    for (const Point& point : points) {
        if (front.empty() || sign * point.y.median < sign * front.back().y.median) front.push_back(point);
    }
    return front;
}

std::string names_on_front(const Panel& panel) {
    const std::vector<Point> front = pareto_front(panel);
    std::string names;
    for (const Series& series : panel.series) {
        const bool is_on =
            std::ranges::any_of(series.points, [&](const Point& p) { return std::ranges::find(front, p) != front.end(); });
        if (is_on && !style_of(series.name).is_peer) names += (names.empty() ? "" : ", ") + series.name;
    }
    return names;
}

}  // namespace zoe::chart
