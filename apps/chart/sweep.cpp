#include "apps/chart/sweep.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <span>

#include <fmt/format.h>

#include "apps/bench/machine.h"
#include "apps/bench/peer_embree.h"
#include "apps/chart/measure.h"
#include "apps/chart/style.h"
#include "apps/common/progress.h"
#include "apps/common/write_file.h"
#include "engine/bvh/hash.h"

namespace zoe::chart {
namespace {

constexpr const char* kInOrigin = "origin ";

bool is_of_step(const Row& row, const Step& step) {
    return row.step == step.name;
}

/// Tells builds apart that have the same version, such as two of a working copy.
std::string hash_of_program() {
    std::ifstream in("/proc/self/exe", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    return to_hex(hash_bytes({std::as_bytes(std::span(bytes))}));
}

void add(const Row& row, Chart* chart) {
    style_of(row.series);
    std::vector<Series>& series = chart->panel(row.panel).series;
    auto found = std::ranges::find(series, row.series, &Series::name);
    if (found == series.end()) found = series.insert(series.end(), Series{.name = row.series, .points = {}});
    found->points.push_back(row.point);
}

/// Points of a series follow one another by x; where that is a price, which is measured, as they were made: by their
/// setting.
void sort_points(Chart* chart) {
    for (Panel& panel : chart->panels) {
        if (panel.is_trade) continue;
        for (Series& series : panel.series)
            std::ranges::stable_sort(series.points, {}, [](const Point& point) { return point.x.median; });
    }
}

}  // namespace

Sweep::Sweep(const Settings& settings, std::filesystem::path folder, std::vector<std::pair<std::string, std::string>> origin)
    : settings_(settings), folder_(std::move(folder)), origin_(std::move(origin)) {}

std::vector<Row> Sweep::rows_from_before(const Chart& chart) const {
    if (folder_.empty()) return {};
    std::optional<Table> table;
    try {
        table = read_csv(folder_ / (chart.name + ".csv"));
    } catch (const std::runtime_error& error) {
        fmt::print(stderr, "zoetrope-chart: warning: {}: all is measured anew\n", error.what());
    }
    if (!table) return {};
    for (const auto& [name, text] : origin_) {
        if (table->note(kInOrigin + name) == text) continue;
        fmt::print(stderr, "zoetrope-chart: {}.csv holds points of another {} ({}): all is measured anew\n", chart.name,
                   name, table->note(kInOrigin + name));
        return {};
    }
    return std::move(table->rows);
}

void Sweep::keep(const Chart& chart, std::vector<std::pair<std::string, std::string>> notes) const {
    if (folder_.empty()) return;
    Table table{.notes = std::move(notes), .rows = rows_};
    for (const auto& [name, text] : origin_) table.notes.emplace_back(kInOrigin + name, text);
    write_file(folder_ / (chart.name + ".csv"), to_csv(table));
}

void Sweep::finish(const Chart& chart, const std::string& command) const {
    keep(chart, {{"chart", chart.name}, {"question", chart.question}, {"caption", chart.caption}, {"command", command}});
}

void Sweep::run(const std::vector<Step>& steps, Chart* chart) {
    const std::vector<Row> before = rows_from_before(*chart);
    double share_sum = 0.0, done = 0.0;
    for (const Step& step : steps) share_sum += step.share;
    Progress progress(chart->name, share_sum);
    rows_.clear();
    for (const Step& step : steps) {
        stop_if_interrupted();
        progress.update(done, step.name);
        const size_t first = rows_.size();
        std::ranges::copy_if(before, std::back_inserter(rows_), [&](const Row& row) { return is_of_step(row, step); });
        if (rows_.size() > first) {
            ++kept_count_;
        } else {
            for (Row& row : step.measure()) {
                row.step = step.name;
                rows_.push_back(std::move(row));
            }
            ++measured_count_;
            keep(*chart, {{"chart", chart->name}, {"question", chart->question}});
        }
        done += step.share;
    }
    for (const Row& row : rows_) add(row, chart);
    sort_points(chart);
}

std::vector<std::pair<std::string, std::string>> describe_origin(const Settings& settings) {
    std::vector<std::pair<std::string, std::string>> origin = describe_machine();
    origin.emplace_back("program", hash_of_program());
    origin.emplace_back("size", settings.pick("tiny", "quick", "full"));
    origin.emplace_back("peer", settings.has_peer ? EmbreePeer::version() : "none");
    return origin;
}

}  // namespace zoe::chart
