#pragma once

#include <span>
#include <string>

#include "apps/chart/chart.h"
#include "apps/chart/sweep.h"

namespace zoe::chart {

/// Each in a file of its own, chart_NAME.cpp: sweeps over the engine and says what it finds.
/// Throws     Interrupted; what the engine throws.
Chart tlas(Sweep& sweep);
Chart placing(Sweep& sweep);
Chart builders(Sweep& sweep);
Chart bins(Sweep& sweep);
Chart knobs(Sweep& sweep);
Chart pays_off(Sweep& sweep);
Chart triangle(Sweep& sweep);
Chart far(Sweep& sweep);
Chart degradation(Sweep& sweep);
Chart clip(Sweep& sweep);
Chart picture(Sweep& sweep);
Chart lights(Sweep& sweep);
Chart filtering(Sweep& sweep);
Chart shutter(Sweep& sweep);
Chart noise(Sweep& sweep);
Chart denoise(Sweep& sweep);
Chart upsample(Sweep& sweep);
Chart skinning(Sweep& sweep);
Chart subdivision(Sweep& sweep);
Chart policy(Sweep& sweep);
Chart threads(Sweep& sweep);

struct ChartInfo {
    const char* name;
    const char* question;
    Chart (*make)(Sweep& sweep);
};

/// All there are.
std::span<const ChartInfo> charts();

/// Throws     UsageError that lists the names.
const ChartInfo& find_chart(const std::string& name);

/// A line each, for `--list`.
std::string list_charts();

}  // namespace zoe::chart
