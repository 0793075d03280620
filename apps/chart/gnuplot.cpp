#include "apps/chart/gnuplot.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "apps/chart/labels.h"
#include "apps/chart/layout.h"
#include "apps/chart/style.h"
#include "apps/common/program_pipe.h"
#include "apps/common/write_file.h"

namespace zoe::chart {
namespace {

/// In single quotes, in which gnuplot replaces nothing.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) {
        if (c == '\'') result += '\'';
        result += c;
    }
    return result + "'";
}

std::string joined(const std::vector<std::string>& parts, const std::string& between) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : between) + part;
    return text;
}

constexpr const char* kNextPlot = ", \\\n     ";
constexpr const char* kFrontLook = "lw 4 lc rgb '#d0d0d0'";
constexpr const char* kDefaultLook = "pt 6 ps 2.6 lw 1.5 lc rgb '#000000'";

std::string block_name(size_t panel, size_t series) {
    return fmt::format("$panel{}_{}", panel, series);
}

/// x, its spread, y, its spread, label: labels in double quotes, which a table of points needs.
std::string block(const std::string& name, const std::vector<Point>& points) {
    std::string text = fmt::format("{} << EOD\n", name);
    for (const Point& point : points) {
        std::string label = point.label;
        std::ranges::replace(label, '"', '\'');
        text += fmt::format("{} {} {} {} {} {} \"{}\"\n", point.x.median, point.x.low, point.x.high, point.y.median,
                            point.y.low, point.y.high, label);
    }
    return text + "EOD\n";
}

std::string look_of(const Style& style) {
    return fmt::format("lc rgb '#{:06x}'", style.colour);
}

std::vector<Point> defaults_of(const Panel& panel) {
    std::vector<Point> points;
    for (const Series& series : panel.series)
        std::ranges::copy_if(series.points, std::back_inserter(points), &Point::is_default);
    return points;
}

bool has_default(const Panel& panel) {
    return !defaults_of(panel).empty();
}

std::string axis(char letter, const Axis& axis, const Scale& scale) {
    std::vector<std::string> ticks;
    for (const Tick& tick : scale.ticks) ticks.push_back(fmt::format("{} {}", quoted(tick.text), tick.at));
    return fmt::format("{0} logscale {1}\nset {1}label {2}\nset {1}range [{3}:{4}]\nset {1}tics ({5})\n",
                       axis.is_log ? "set" : "unset", letter, quoted(axis.title()), scale.begin, scale.end,
                       joined(ticks, ", "));
}

std::string labels_of(const Panel& panel, const Scale& x, const Scale& y, double width, double height) {
    std::string text;
    for (const PlacedLabel& label : place_labels(panel, x, y, width, height)) {
        if (label.has_line) {
            text += fmt::format(
                "set arrow from graph {:.4f},{:.4f} to graph {:.4f},{:.4f} nohead back lw 0.6 lc rgb '#{:06x}'\n",
                label.line_x[0], label.line_y[0], label.line_x[1], label.line_y[1], label.colour);
        }
        text += fmt::format("set label {} at graph {:.4f},{:.4f} center font ',8' tc rgb '#{:06x}'\n", quoted(label.text),
                            label.x, label.y, label.colour);
    }
    return text;
}

std::string place(const Layout::Box& box) {
    return fmt::format("set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\n", box.left, box.right) +
           fmt::format("set bmargin at screen {:.4f}\nset tmargin at screen {:.4f}\n", box.bottom, box.top);
}

/// All points, as tables with names.
std::string data_program(const Chart& chart) {
    std::string text;
    for (size_t p = 0; p < chart.panels.size(); ++p) {
        const Panel& panel = chart.panels[p];
        text += fmt::format("\n# {}; a line a point: x, its quartiles, y, its quartiles, label\n", panel.name);
        for (size_t k = 0; k < panel.series.size(); ++k)
            text += fmt::format("# {}\n", panel.series[k].name) + block(block_name(p, k), panel.series[k].points);
        if (panel.is_trade) text += block(fmt::format("$front{}", p), pareto_front(panel));
        if (has_default(panel)) text += block(fmt::format("$default{}", p), defaults_of(panel));
    }
    return text;
}

std::string panel_program(const Chart& chart, size_t index, const Layout& layout) {
    const Panel& panel = chart.panels[index];
    std::vector<std::string> plots;
    if (panel.is_trade) plots.push_back(fmt::format("$front{} using 1:4 with steps {} notitle", index, kFrontLook));
    for (size_t k = 0; k < panel.series.size(); ++k) {
        const Style& style = style_of(panel.series[k].name);
        const std::string name = block_name(index, k), look = look_of(style);
        if (style.is_joined && !panel.is_trade)
            plots.push_back(fmt::format("{} using 1:4 with lines lw 1.5 {} notitle", name, look));
        plots.push_back(fmt::format("{} using 1:4:2:3:5:6 with xyerrorbars pt 0 lw 1 {} notitle", name, look));
        plots.push_back(fmt::format("{} using 1:4 with points pt {} ps 1.3 {} notitle", name, style.shape, look));
    }
    if (has_default(panel)) plots.push_back(fmt::format("$default{} using 1:4 with points {} notitle", index, kDefaultLook));
    const int tick_font = chart.columns < 3 ? 10 : 8;
    std::string text = fmt::format("\n# {}\nset title {} offset 0,-0.6\n", panel.name, quoted(panel.name));
    text += fmt::format("set tics font ',{}'\n", tick_font);
    const Layout::Box box = layout.panel(index);
    const double width = layout.width_pixels(box), height = layout.height_pixels(box);
    const double in_ticks = 8.0 / tick_font;
    const Scale x = x_scale(panel, in_ticks * width), y = y_scale(panel, in_ticks * height);
    text += axis('x', panel.x, x) + axis('y', panel.y, y) + place(box);
    if (panel.has_labels) text += labels_of(panel, x, y, width, height);
    return text + "plot " + joined(plots, kNextPlot) + "\n";
}

/// What the colours and shapes mean, under all panels.
std::string legend_program(const Chart& chart, const Layout& layout) {
    std::vector<std::string> plots;
    for (const std::string& name : layout.series()) {
        const Style& style = style_of(name);
        plots.push_back(fmt::format("NaN with {} pt {} ps 1.3 {} title {}", style.is_joined ? "linespoints" : "points",
                                    style.shape, look_of(style), quoted(name)));
    }
    if (std::ranges::any_of(chart.panels, has_default))
        plots.push_back(fmt::format("NaN with points {} title 'the default'", kDefaultLook));
    if (std::ranges::any_of(chart.panels, &Panel::is_trade))
        plots.push_back(fmt::format("NaN with lines {} title 'Pareto front of ours'", kFrontLook));
    const Layout::Box box = layout.legend();
    std::string text = "\n# What is what\nset title\nunset border\nunset tics\nunset xlabel\nunset ylabel\nunset grid\n";
    text += "unset logscale\nset xrange [0:1]\nset yrange [0:1]\n";
    text += place(box);
    text += fmt::format("set key at screen 0.5,{:.4f} center top horizontal maxrows {} samplen 2 width 1\n", box.top,
                        layout.legend_rows());
    return text + "plot " + joined(plots, kNextPlot) + "\n";
}

std::string labels_program(const Chart& chart, const Layout& layout) {
    std::string text =
        fmt::format("set label 1 {} at screen 0.02,{:.4f} left font ',14'\n", quoted(chart.question), layout.question_y());
    int label = 2;
    for (size_t line = 0; line < layout.caption_lines().size(); ++line)
        text += fmt::format("set label {} {} at screen 0.02,{:.4f} left\n", label++, quoted(layout.caption_lines()[line]),
                            layout.caption_y(line));
    return text;
}

}  // namespace

std::string gnuplot_program(const Chart& chart) {
    const Layout layout(chart);
    std::string text = fmt::format("# {0}: {1}\n# {2}\n# Made by zoetrope-chart; `gnuplot {0}.gp` draws it again.\n",
                                   chart.name, chart.question, chart.caption);
    text += fmt::format("if (!exists(\"svg\")) svg = '{0}.svg'\nif (!exists(\"png\")) png = '{0}.png'\n", chart.name);
    text += "set encoding utf8\n" + data_program(chart);
    const std::string look =
        fmt::format("size {},{} noenhanced font 'sans,10' background rgb 'white'", Layout::kWidth, layout.height());
    text += fmt::format(
        "\ndo for [form in \"svg png\"] {{\nreset\nif (form eq \"svg\") {{\n    set terminal svg {0}\n"
        "    set output svg\n}} else {{\n    set terminal pngcairo {0}\n    set output png\n}}\n",
        look);
    text += "set format '%g'\nset grid xtics ytics lc rgb '#d8d8d8' lw 0.7\nunset key\n";
    text += labels_program(chart, layout) + "set multiplot\n";
    for (size_t k = 0; k < chart.panels.size(); ++k) {
        text += panel_program(chart, k, layout);
        text += "unset label\nunset arrow\n";  // they are drawn with every plot
    }
    return text + legend_program(chart, layout) + "unset multiplot\nunset output\n}\n";
}

void draw(const std::filesystem::path& program) {
    const std::filesystem::path svg = std::filesystem::path(program).replace_extension(".svg");
    const std::filesystem::path png = std::filesystem::path(program).replace_extension(".png");
    const std::filesystem::path new_svg = temporary_name(svg), new_png = temporary_name(png);
    ProgramPipe gnuplot({"gnuplot", "-e",
                         fmt::format("svg = {}; png = {}", quoted(new_svg.native()), quoted(new_png.native())),
                         program.native()});
    const bool is_installed = gnuplot.start_error() != ENOENT;
    std::string problem = gnuplot.close();
    std::error_code error;
    if (problem.empty()) {
        std::filesystem::rename(new_svg, svg, error);
        if (!error) std::filesystem::rename(new_png, png, error);
        if (error) problem = fmt::format("wrote no picture: {}", error.message());
    }
    if (problem.empty()) return;
    std::filesystem::remove(new_svg, error);
    std::filesystem::remove(new_png, error);
    if (!is_installed)
        throw std::runtime_error(
            fmt::format("{}: gnuplot is not installed (Debian: apt-get install gnuplot-nox)", program.native()));
    throw std::runtime_error(
        fmt::format("{}: gnuplot {}; run `gnuplot {}` to see why", program.native(), problem, program.native()));
}

}  // namespace zoe::chart
