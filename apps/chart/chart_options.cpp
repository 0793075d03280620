#include "apps/chart/chart_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "apps/bench/peer_embree.h"
#include "apps/chart/charts.h"
#include "apps/common/parse_command_line.h"
#include "apps/common/usage_error.h"

namespace zoe::chart {
namespace {

std::string footer() {
    return "Charts:\n" + list_charts() +
           "\nDIR gets of each chart: NAME.csv (the points), NAME.gp (the picture as a gnuplot program that holds them),\n"
           "NAME.svg and NAME.png; and index.html, which shows all that DIR holds, with the command that made each.\n"
           "Points are medians with quartiles. Interrupted, the same command goes on where it was: points that DIR holds\n"
           "of the same program, machine and settings are not measured again.\n\n"
           "Examples:\n"
           "  zoetrope-chart --quick            every chart, in about five minutes on two cores, into out/charts\n"
           "  zoetrope-chart tlas far --out c   two of them, at full size, into c\n"
           "  zoetrope-chart --peer none        without Embree's points\n"
           "  gnuplot tlas.gp                   draws a chart again where it is run, as after a change by hand\n\n"
           "Exit codes: 0 done, 1 a file or gnuplot is at fault, 2 the command line is, 130 interrupted.";
}

}  // namespace

std::string Options::command(const std::string& chart) const {
    std::string text = "zoetrope-chart " + chart;
    if (is_quick) text += " --quick";
    if (threads != 0) text += fmt::format(" --threads {}", threads);
    if (!has_peer) text += " --peer none";
    return text;
}

std::optional<Options> parse_options(int argc, char** argv) {
    CLI::App app("Draws what each method costs, in speed and in accuracy, and marks what the engine does by default.",
                 "zoetrope-chart");
    Options options;
    std::string peer;
    app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    app.add_option("CHART", options.charts, "Charts of the list below (all, unless told)")
        ->type_name("")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    app.add_flag("--list", options.is_list, "Names the charts and what they ask");
    app.add_flag("--quick", options.is_quick, "Smaller scenes, fewer repeats");
    app.add_option("--out", options.out, "Where files go")->type_name("DIR")->capture_default_str();
    app.add_option("--threads", options.threads, "Threads to use (all)")->type_name("N");
    app.add_option("--peer", peer, "Embree's points, too (where this program was built with it), or not")
        ->type_name("embree|none");
    app.set_help_flag("-h,--help", "This text");
    app.footer(footer());
    app.get_formatter()->column_width(34);
    if (!parse_command_line(app, argc, argv)) return std::nullopt;
    if (app.count("--threads") && (options.threads < 1 || options.threads > 1024))
        throw UsageError("--threads: a number from 1 to 1024");
    if (app.count("--peer") && peer != "embree" && peer != "none")
        throw UsageError(fmt::format("--peer {}: embree or none", peer));
    if (peer == "embree" && !is_embree_available())
        throw UsageError("--peer embree: this program was built without Embree (Debian: apt-get install libembree-dev)");
    options.has_peer = peer != "none" && is_embree_available();
    for (const std::string& chart : options.charts) find_chart(chart);
    return options;
}

}  // namespace zoe::chart
