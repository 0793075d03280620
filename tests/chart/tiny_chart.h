#pragma once

#include "apps/chart/charts.h"
#include "apps/chart/sweep.h"

namespace zoe::chart {

/// The chart of that name at the size that tests have time for.
inline Chart make_tiny(const char* name) {
    const Settings settings{.size = Size::kTiny};
    Sweep sweep(settings, {}, {});
    return find_chart(name).make(sweep);
}

/// The only point of a series.
inline double y_of(const Chart& chart, const char* panel, const char* series) {
    return chart.panel(panel).find(series)->points.front().y.median;
}

}  // namespace zoe::chart
