#pragma once

#include <string>
#include <vector>

namespace zoe::chart {

/// A median and the quartiles around it. All three are one number where nothing was measured more than once.
struct Spread {
    double median = 0.0, low = 0.0, high = 0.0;

    static Spread exactly(double value) { return {value, value, value}; }
    friend bool operator==(const Spread&, const Spread&) = default;
};

/// Requires   at least one number, all finite.
Spread spread_of(std::vector<double> numbers);

struct Axis {
    std::string name;
    std::string unit;  ///< Empty: a plain number.
    bool is_log = false;
    bool is_more_better = false;
    bool is_whole = false;  ///< Of whole numbers, few enough to have a tick each.

    std::string title() const { return unit.empty() ? name : name + " [" + unit + "]"; }
};

struct Point {
    Spread x, y;
    std::string label = "";   ///< Written beside it where its panel shows labels.
    bool is_default = false;  ///< What the engine does unless told otherwise.
    friend bool operator==(const Point&, const Point&) = default;
};

/// What one method does: drawn as `style_of` its name has it.
struct Series {
    std::string name;
    std::vector<Point> points;  ///< In the order of x.
};

/// One pair of axes.
struct Panel {
    std::string name;
    Axis x, y;
    bool is_trade = false;  ///< Both axes are prices: the Pareto front of our own methods is drawn.
    bool has_labels = false;
    std::vector<Series> series = {};

    /// Null where there is none.
    const Series* find(const std::string& series_name) const;
};

/// A question, and its answer as a picture.
struct Chart {
    std::string name, question;
    int columns = 1;  ///< Panels side by side.
    std::vector<Panel> panels = {};
    std::string caption = "";  ///< The finding and the default, worked out from the points.

    /// Throws     std::logic_error for a name that is none; so does `point`.
    Panel& panel(const std::string& panel_name);
    const Panel& panel(const std::string& panel_name) const;
    /// The one of that x.
    const Point& point(const std::string& panel_name, const std::string& series_name, double x) const;
};

/// The points that no other beats on one axis without losing on the other, in the order of x. Less of x is better; what is
/// better of y, its axis says. Peers' series are left out.
std::vector<Point> pareto_front(const Panel& panel);

/// "binned, exact": the series that have a point on it.
std::string names_on_front(const Panel& panel);

}  // namespace zoe::chart
