#include "apps/chart/page.h"

#include <optional>

#include <fmt/format.h>

#include "apps/common/open_scene.h"
#include "apps/common/write_file.h"

namespace zoe::chart {
namespace {

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Zoetrope: speed against accuracy</title>
<style>
body { font-family: sans-serif; line-height: 1.4; max-width: 60em; margin: 2em auto; padding: 0 1em; color: #222; }
section { margin: 3em 0; }
img { max-width: 100%; height: auto; }
code { background: #f2f2f2; padding: 0.1em 0.3em; }
small { color: #555; }
</style>
<h1>Speed against accuracy</h1>
<p>Medians with their quartiles, unless an axis or a caption says otherwise. A ring marks what the engine does unless told otherwise.</p>
)";

std::string machine_of(const Table& table) {
    return fmt::format("{}, {} threads of {} cores, {}; {}; version {}, {}; peer: {}", table.note("origin processor"),
                       table.note("origin threads"), table.note("origin cores"), table.note("origin simd"),
                       table.note("origin compiler"), table.note("origin version"), table.note("origin commit"),
                       table.note("origin peer"));
}

}  // namespace

std::string page(const std::vector<Table>& tables, const std::vector<bool>& has_picture) {
    std::string text = kHead;
    text += "<ul>\n";
    for (const Table& table : tables) {
        text += fmt::format("<li><a href=\"#{0}\">{0}</a>: {1}</li>\n", escaped(table.note("chart")),
                            escaped(table.note("question")));
    }
    text += "</ul>\n";
    for (size_t k = 0; k < tables.size(); ++k) {
        const std::string name = escaped(tables[k].note("chart")), caption = escaped(tables[k].note("caption"));
        text += fmt::format("<section id=\"{0}\">\n<h2>{0}</h2>\n<p>{1}</p>\n", name, escaped(tables[k].note("question")));
        text += has_picture[k] ? fmt::format("<p><img src=\"{0}.svg\" alt=\"{1}\"></p>\n", name, caption)
                               : fmt::format("<p>Not drawn: run <code>gnuplot {}.gp</code>.</p>\n", name);
        text += fmt::format("<p>{}</p>\n<p><code>{}</code></p>\n", caption, escaped(tables[k].note("command")));
        text += fmt::format("<p><small><a href=\"{0}.csv\">{0}.csv</a>, <a href=\"{0}.gp\">{0}.gp</a>{1}. {2}</small></p>\n",
                            name, has_picture[k] ? fmt::format(", <a href=\"{0}.png\">{0}.png</a>", name) : "",
                            escaped(machine_of(tables[k])));
        text += "</section>\n";
    }
    return text + "</html>\n";
}

void write_page(const std::filesystem::path& folder, const std::vector<std::string>& names) {
    std::vector<Table> tables;
    std::vector<bool> has_picture;
    for (const std::string& name : names) {
        std::optional<Table> table;
        try {
            table = read_csv(folder / (name + ".csv"));
        } catch (const std::exception& error) {
            fmt::print(stderr, "zoetrope-chart: warning: left out of index.html: {}\n", one_line(error.what()));
        }
        if (!table || table->note("command").empty()) continue;  // not made, or not to its end
        tables.push_back(std::move(*table));
        has_picture.push_back(std::filesystem::exists(folder / (name + ".svg")));
    }
    write_file(folder / "index.html", page(tables, has_picture));
}

}  // namespace zoe::chart
