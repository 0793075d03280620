#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/chart/chart.h"

namespace zoe::chart {

/// A point, and where in its chart it belongs.
struct Row {
    std::string step;  ///< What was measured together.
    std::string panel, series;
    Point point;
    friend bool operator==(const Row&, const Row&) = default;
};

/// A chart as a file: notes, `# name: text` a line, then a heading, then a line a point.
struct Table {
    std::vector<std::pair<std::string, std::string>> notes;
    std::vector<Row> rows;

    /// Empty where there is no such note.
    std::string note(const std::string& name) const;
};

/// Numbers have as many digits as it takes to read the same ones back.
std::string to_csv(const Table& table);

/// name       of the file, for messages.
/// Throws     std::runtime_error with the file, the line and the reason.
Table parse_csv(const std::string& text, const std::string& name);

/// Returns    nothing where there is no such file.
/// Throws     std::runtime_error as `parse_csv` does, and where the file cannot be read.
std::optional<Table> read_csv(const std::filesystem::path& file);

}  // namespace zoe::chart
