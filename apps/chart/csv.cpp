#include "apps/chart/csv.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "apps/common/open_scene.h"
#include "apps/common/parse.h"

namespace zoe::chart {
namespace {

constexpr std::string_view kHeading = "step,panel,series,x,x_low,x_high,y,y_low,y_high,label,default";
constexpr size_t kFieldCount = 11;

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : one_line(text)) {
        if (c == '"') result += '"';
        result += c;
    }
    return result + "\"";
}

/// What is wrong with one line.
struct LineError {
    std::string reason;
};

/// Fields are bare, or in quotes, where "" stands for one.
std::vector<std::string> fields_of(std::string_view line) {
    std::vector<std::string> fields(1);
    bool is_quoted = false;
    for (size_t k = 0; k < line.size(); ++k) {
        const char c = line[k];
        if (is_quoted && c == '"' && k + 1 < line.size() && line[k + 1] == '"') {
            fields.back() += '"';
            ++k;
        } else if (c == '"') {
            is_quoted = !is_quoted;
        } else if (c == ',' && !is_quoted) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    if (is_quoted) throw LineError{"a quote is not closed"};
    return fields;
}

Spread parse_spread(const std::string* fields) {
    double numbers[3];
    for (int k = 0; k < 3; ++k) {
        const std::optional<double> number = parse_number(fields[k]);
        if (!number) throw LineError{fmt::format("'{}' is not a finite number", fields[k])};
        numbers[k] = *number;
    }
    if (!(numbers[1] <= numbers[0] && numbers[0] <= numbers[2])) throw LineError{"a median lies outside of its spread"};
    return {numbers[0], numbers[1], numbers[2]};
}

Row parse_row(std::string_view line) {
    const std::vector<std::string> fields = fields_of(line);
    if (fields.size() != kFieldCount) throw LineError{fmt::format("{} fields in place of {}", fields.size(), kFieldCount)};
    if (fields[10] != "0" && fields[10] != "1") throw LineError{fmt::format("'{}' is neither 0 nor 1", fields[10])};
    return {.step = fields[0],
            .panel = fields[1],
            .series = fields[2],
            .point = {.x = parse_spread(&fields[3]),
                      .y = parse_spread(&fields[6]),
                      .label = fields[9],
                      .is_default = fields[10] == "1"}};
}

std::pair<std::string, std::string> parse_note(std::string_view line) {
    const size_t colon = line.find(": ");
    if (!line.starts_with("# ") || colon == line.npos) throw LineError{"not a note of the form '# name: text'"};
    return {std::string(line.substr(2, colon - 2)), std::string(line.substr(colon + 2))};
}

}  // namespace

std::string Table::note(const std::string& name) const {
    for (const auto& [note_name, text] : notes) {
        if (note_name == name) return text;
    }
    return "";
}

std::string to_csv(const Table& table) {
    std::string text;
    for (const auto& [name, note] : table.notes) text += fmt::format("# {}: {}\n", name, one_line(note));
    text += fmt::format("{}\n", kHeading);
    for (const Row& row : table.rows) {
        const Point& p = row.point;
        text +=
            fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", quoted(row.step), quoted(row.panel), quoted(row.series),
                        p.x.median, p.x.low, p.x.high, p.y.median, p.y.low, p.y.high, quoted(p.label), p.is_default ? 1 : 0);
    }
    return text;
}

Table parse_csv(const std::string& text, const std::string& name) {
    Table table;
    std::istringstream lines(text);
    bool has_heading = false;
    int number = 0;
    try {
        for (std::string line; std::getline(lines, line);) {
            ++number;
            if (has_heading) {
                table.rows.push_back(parse_row(line));
            } else if (line == kHeading) {
                has_heading = true;
            } else {
                table.notes.push_back(parse_note(line));
            }
        }
        if (!has_heading) throw LineError{"the heading is missing"};
    } catch (const LineError& error) {
        throw std::runtime_error(fmt::format("{}:{}: {}", name, number, error.reason));
    }
    return table;
}

std::optional<Table> read_csv(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error) && !error) return std::nullopt;
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    if (in) text << in.rdbuf();
    if (!in) throw std::runtime_error(fmt::format("{}: cannot be read: {}", file.native(), std::strerror(errno)));
    return parse_csv(text.str(), file.native());
}

}  // namespace zoe::chart
