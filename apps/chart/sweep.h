#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/chart/chart.h"
#include "apps/chart/csv.h"

namespace zoe::chart {

/// How large scenes are and how often they are measured: for tests, in minutes for all charts together, or as one likes to
/// have it.
enum class Size : uint8_t { kTiny, kQuick, kFull };

/// What a chart is asked for.
struct Settings {
    Size size = Size::kFull;
    bool has_peer = false;  ///< Embree's points, too.

    template <typename T>
    T pick(T tiny, T quick, T full) const {
        return size == Size::kTiny ? tiny : size == Size::kQuick ? quick : full;
    }
};

/// What is measured together: whole or not at all.
struct Step {
    std::string name;    ///< Tells it from the chart's others.
    double share = 1.0;  ///< Of the time that the chart takes, about, beside its other steps.
    std::function<std::vector<Row>()> measure;
};

/// What the steps of a chart share, such as the picture that all are compared with: made by the first that is measured.
template <typename T>
class Shared {
public:
    explicit Shared(const Settings& settings) : settings_(settings) {}

    T& operator()() const {
        if (!*made_) made_->emplace(settings_);
        return **made_;
    }

private:
    Settings settings_;
    std::shared_ptr<std::optional<T>> made_ = std::make_shared<std::optional<T>>();  ///< Steps hold copies.
};

/// Runs the steps of a chart, and keeps what they measured. What a folder holds from before, of the same program and
/// settings, is not measured again.
class Sweep {
public:
    /// folder     where NAME.csv is kept after every step; empty: nowhere.
    /// origin     what points depend on beside the code of the chart: points of another origin are measured anew.
    Sweep(const Settings& settings, std::filesystem::path folder, std::vector<std::pair<std::string, std::string>> origin);

    const Settings& settings() const { return settings_; }

    /// Fills the chart's panels, series in the order of their first point.
    /// Requires   rows that name panels of the chart, and series that have a style.
    /// Throws     Interrupted between two steps; what the steps throw.
    void run(const std::vector<Step>& steps, Chart* chart);

    /// Writes the CSV once more, with what the chart says.
    /// command    that made it.
    /// Requires   that `run` was the last call, with this chart.
    void finish(const Chart& chart, const std::string& command) const;

    int measured_count() const { return measured_count_; }  ///< Steps, of all charts.
    int kept_count() const { return kept_count_; }          ///< Steps that had been measured before.

private:
    std::vector<Row> rows_from_before(const Chart& chart) const;
    void keep(const Chart& chart, std::vector<std::pair<std::string, std::string>> notes) const;

    Settings settings_;
    std::filesystem::path folder_;
    std::vector<std::pair<std::string, std::string>> origin_;
    std::vector<Row> rows_;  ///< Of the last chart, in the order of its steps.
    int measured_count_ = 0, kept_count_ = 0;
};

/// What the points of this program depend on: the machine, the build, and the settings.
std::vector<std::pair<std::string, std::string>> describe_origin(const Settings& settings);

}  // namespace zoe::chart
