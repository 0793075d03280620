#pragma once

#include <string>
#include <vector>

#include "apps/chart/chart.h"

namespace zoe::chart {

/// Where things stand in a chart's picture: the question, the panels row by row, what colours mean, the caption.
class Layout {
public:
    static constexpr int kWidth = 960;  ///< Pixels.

    /// In shares of the picture, from its lower left.
    struct Box {
        double left, right, bottom, top;
    };

    explicit Layout(const Chart& chart);

    int height() const { return height_; }
    Box panel(size_t index) const;
    double width_pixels(const Box& box) const { return (box.right - box.left) * kWidth; }
    double height_pixels(const Box& box) const { return (box.top - box.bottom) * height_; }
    Box legend() const;
    int legend_rows() const { return legend_rows_; }
    const std::vector<std::string>& series() const { return series_; }  ///< All that occur, each once.
    const std::vector<std::string>& caption_lines() const { return caption_lines_; }
    double question_y() const;
    double caption_y(size_t line) const;

private:
    double share(double pixels_from_top) const { return 1.0 - pixels_from_top / height_; }

    int columns_, rows_, height_, legend_rows_, panel_height_;
    std::vector<std::string> series_, caption_lines_;
};

struct Tick {
    double at;
    std::string text;
};

/// What an axis shows.
struct Scale {
    double begin, end;
    bool is_log;
    std::vector<Tick> ticks;

    /// Where a number stands, from 0 to 1.
    double share(double number) const;
};
/// Around all points of a panel and their spreads, with some room. Ticks are as many as do not touch.
/// pixels     that the axis is long where ticks are written in 8 points.
Scale x_scale(const Panel& panel, double pixels);
Scale y_scale(const Panel& panel, double pixels);

/// Breaks a text between words into lines of at most `width` characters; longer words stay whole.
std::vector<std::string> wrap(const std::string& text, size_t width);

}  // namespace zoe::chart
