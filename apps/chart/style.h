#pragma once

#include <span>
#include <string>

namespace zoe::chart {

/// How a method looks in every chart: colours that the colour-blind tell apart, and shapes for those who see none.
struct Style {
    const char* name;
    unsigned colour;  ///< 0xRRGGBB.
    int shape;        ///< gnuplot's point type.
    bool is_joined;   ///< Its points lie on a line.
    bool is_peer = false;
};

std::span<const Style> styles();

/// Throws     std::logic_error for a name without one.
const Style& style_of(const std::string& series);

}  // namespace zoe::chart
