#pragma once

#include <string>
#include <vector>

#include "apps/chart/chart.h"
#include "apps/chart/layout.h"

namespace zoe::chart {

/// A point's label where nothing is in its way. Places are shares of the panel, from its lower left.
struct PlacedLabel {
    std::string text;
    unsigned colour;              ///< 0xRRGGBB.
    double x, y;                  ///< Its middle.
    bool has_line;                ///< It stands apart from its point.
    double line_x[2], line_y[2];  ///< From the point to the label's edge.
};

/// Beside their points or, where it is crowded, a little way off, within the panel: none covers another, or a point. Labels
/// that find no place within reach are left out, as are those of defaults that coincide.
/// width      of the panel in pixels; so height.
std::vector<PlacedLabel> place_labels(const Panel& panel, const Scale& x, const Scale& y, double width, double height);

}  // namespace zoe::chart
