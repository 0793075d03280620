#include "apps/chart/labels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/chart/style.h"

namespace zoe::chart {
namespace {

// Pixels.
constexpr double kCharacter = 6.0, kLine = 12.0, kPoint = 6.0, kRing = 11.0, kGap = 2.0, kFront = 3.0, kSame = 3.0;
/// Between a label's edge and its point's; a line is drawn where there is any.
constexpr double kAway[] = {0.0, 14.0, 28.0, 44.0, 62.0, 80.0};

struct Place {
    double x, y;
};
struct Rectangle {
    double left, right, bottom, top;

    bool meets(const Rectangle& other) const {
        return left < other.right && other.left < right && bottom < other.top && other.bottom < top;
    }
    bool is_within(const Rectangle& other) const {
        return left >= other.left && right <= other.right && bottom >= other.bottom && top <= other.top;
    }
};

Rectangle around(const Place& middle, double half_width, double half_height) {
    return {middle.x - half_width, middle.x + half_width, middle.y - half_height, middle.y + half_height};
}

struct Marked {
    const Point* point;
    unsigned colour;
    Place at;
    double radius;
};

class Placer {
public:
    Placer(const Panel& panel, const Scale& x, const Scale& y, double width, double height)
        : panel_box_{0.0, width, 0.0, height} {
        for (const Series& series : panel.series) {
            const unsigned colour = style_of(series.name).colour;
            for (const Point& point : series.points) {
                const Place at{x.share(point.x.median) * width, y.share(point.y.median) * height};
                const double radius = point.is_default ? kRing : kPoint;
                marked_.push_back({&point, colour, at, radius});
                taken_.push_back(around(at, radius, radius));
                taken_.push_back({x.share(point.x.low) * width, x.share(point.x.high) * width, at.y - 1.0, at.y + 1.0});
                taken_.push_back({at.x - 1.0, at.x + 1.0, y.share(point.y.low) * height, y.share(point.y.high) * height});
            }
        }
    }

    /// Keeps free the steps of a line through these points.
    void avoid(const std::vector<Point>& front, const Scale& x, const Scale& y) {
        for (size_t k = 1; k < front.size(); ++k) {
            const double left = x.share(front[k - 1].x.median) * panel_box_.right,
                         right = x.share(front[k].x.median) * panel_box_.right,
                         before = y.share(front[k - 1].y.median) * panel_box_.top,
                         after = y.share(front[k].y.median) * panel_box_.top;
            taken_.push_back({left, right, before - kFront, before + kFront});
            taken_.push_back({right - kFront, right + kFront, std::min(before, after), std::max(before, after)});
        }
    }

    std::vector<PlacedLabel> place() {
        std::vector<PlacedLabel> labels;
        // Those that stand alone first: they have a place beside them, and no line goes there.
        std::vector<const Marked*> order;
        for (const Marked& marked : marked_)
            if (!marked.point->label.empty() && !is_one_default_of_many(marked)) order.push_back(&marked);
        std::ranges::stable_sort(order, {}, [&](const Marked* marked) { return neighbour_count(*marked); });
        for (const Marked* marked : order) {
            const double half_width = 0.5 * kCharacter * static_cast<double>(marked->point->label.size()) + kGap;
            for (const double away : kAway)
                if (place(*marked, half_width, away, &labels)) break;
        }
        return labels;
    }

private:
    static double distance(const Place& a, const Place& b) { return std::hypot(a.x - b.x, a.y - b.y); }

    bool is_one_default_of_many(const Marked& marked) const {
        return marked.point->is_default && std::ranges::any_of(marked_, [&](const Marked& other) {
                   return &other != &marked && other.point->is_default && distance(other.at, marked.at) < kSame;
               });
    }
    ptrdiff_t neighbour_count(const Marked& marked) const {
        return std::ranges::count_if(marked_, [&](const Marked& other) { return distance(other.at, marked.at) < 40.0; });
    }

    bool place(const Marked& marked, double half_width, double away, std::vector<PlacedLabel>* labels) {
        // Above and below, to the sides, then between.
        constexpr int kBeside[] = {2, 6, 0, 4, 1, 3, 5, 7};
        const bool has_line = away > 0.0;
        const int directions = has_line ? 24 : 8;
        for (int k = 0; k < directions; ++k) {
            const double angle = 2.0 * std::numbers::pi * (has_line ? k : kBeside[k]) / directions;
            const double dx = std::cos(angle), dy = std::sin(angle), out = marked.radius + kGap + away;
            const Place middle{marked.at.x + dx * (out + half_width), marked.at.y + dy * (out + 0.5 * kLine)};
            const Rectangle box = around(middle, half_width, 0.5 * kLine);
            const Place end{std::clamp(marked.at.x, box.left, box.right), std::clamp(marked.at.y, box.bottom, box.top)};
            std::vector<Rectangle> line;
            if (has_line) line = steps(marked.at, end);
            if (!box.is_within(panel_box_) || is_any_taken(box, taken_)) continue;
            if (std::ranges::any_of(line, [&](const Rectangle& step) { return is_any_taken(step, written_); })) continue;
            taken_.push_back(box);
            taken_.insert(taken_.end(), line.begin(), line.end());
            written_.push_back(box);
            labels->push_back({.text = marked.point->label,
                               .colour = marked.colour,
                               .x = middle.x / panel_box_.right,
                               .y = middle.y / panel_box_.top,
                               .has_line = has_line,
                               .line_x = {marked.at.x / panel_box_.right, end.x / panel_box_.right},
                               .line_y = {marked.at.y / panel_box_.top, end.y / panel_box_.top}});
            return true;
        }
        return false;
    }

    static bool is_any_taken(const Rectangle& box, const std::vector<Rectangle>& taken) {
        return std::ranges::any_of(taken, [&](const Rectangle& other) { return box.meets(other); });
    }

    /// Along a line.
    static std::vector<Rectangle> steps(const Place& from, const Place& to) {
        const int count = 1 + static_cast<int>(distance(from, to) / kSame);
        std::vector<Rectangle> result;
        for (int k = 0; k < count; ++k)
            result.push_back(
                around({std::lerp(from.x, to.x, double(k) / count), std::lerp(from.y, to.y, double(k) / count)}, 1.0, 1.0));
        return result;
    }

    Rectangle panel_box_;
    std::vector<Marked> marked_;
    std::vector<Rectangle> taken_;    ///< By points, labels and lines;
    std::vector<Rectangle> written_;  ///< by labels.
};

}  // namespace

std::vector<PlacedLabel> place_labels(const Panel& panel, const Scale& x, const Scale& y, double width, double height) {
    Placer placer(panel, x, y, width, height);
    if (panel.is_trade) placer.avoid(pareto_front(panel), x, y);
    return placer.place();
}

}  // namespace zoe::chart
