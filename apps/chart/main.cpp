#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <thread>

#include <fmt/format.h>

#include "apps/chart/chart_options.h"
#include "apps/chart/charts.h"
#include "apps/chart/gnuplot.h"
#include "apps/chart/page.h"
#include "apps/chart/sweep.h"
#include "apps/common/interrupt.h"
#include "apps/common/open_scene.h"
#include "apps/common/usage_error.h"
#include "apps/common/write_file.h"
#include "engine/math/parallel.h"

namespace zoe::chart {
namespace {

constexpr const char* kProgram = "zoetrope-chart";

int fail(int exit_code, const std::string& message) {
    std::fputs(fmt::format("{}: {}\n", kProgram, one_line(message)).c_str(), stderr);  // fmt::print throws on a full disk
    return exit_code;
}

/// Each once, in the order of the list.
std::vector<const ChartInfo*> chosen(const Options& options) {
    std::vector<const ChartInfo*> result;
    for (const ChartInfo& info : charts()) {
        if (options.charts.empty() || std::ranges::find(options.charts, info.name) != options.charts.end())
            result.push_back(&info);
    }
    return result;
}

std::vector<std::string> all_names() {
    std::vector<std::string> names;
    for (const ChartInfo& info : charts()) names.emplace_back(info.name);
    return names;
}

/// Returns    false where there is no picture, having said why.
bool draw_or_say(const std::filesystem::path& program) {
    try {
        draw(program);
        return true;
    } catch (const std::runtime_error& error) {
        fail(1, error.what());
    }
    // A picture of other points would be taken for one of these.
    std::error_code ignored;
    for (const char* const form : {".svg", ".png"})
        std::filesystem::remove(std::filesystem::path(program).replace_extension(form), ignored);
    return false;
}

/// Returns the exit code.
int run(const Options& options) {
    set_thread_count(options.threads);
    const int core_count = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    if (options.has_peer && thread_count() > core_count) {
        throw UsageError(
            fmt::format("--threads {}: beside Embree at most {}: it runs no more threads than cores; or add "
                        "--peer none",
                        thread_count(), core_count));
    }
    const std::filesystem::path folder = options.out;
    make_folder(folder);
    catch_interrupts();
    const Settings settings{.size = options.is_quick ? Size::kQuick : Size::kFull, .has_peer = options.has_peer};
    Sweep sweep(settings, folder, describe_origin(settings));
    bool are_all_drawn = true;
    for (const ChartInfo* info : chosen(options)) {
        const Chart chart = info->make(sweep);
        sweep.finish(chart, options.command(chart.name));
        const std::filesystem::path program = folder / (chart.name + ".gp");
        write_file(program, gnuplot_program(chart));
        are_all_drawn &= draw_or_say(program);
        write_page(folder, all_names());
        fmt::print("{}: {}\n  {}\n", chart.name, chart.question, chart.caption);
        std::fflush(stdout);
    }
    fmt::print("{}; {} steps measured, {} kept from before\n", (folder / "index.html").native(), sweep.measured_count(),
               sweep.kept_count());
    return are_all_drawn ? 0 : 1;
}

}  // namespace
}  // namespace zoe::chart

int main(int argc, char** argv) {
    using namespace zoe;
    using namespace zoe::chart;
    try {
        const std::optional<chart::Options> options = chart::parse_options(argc, argv);
        if (!options) return 0;
        if (options->is_list) {
            fmt::print("{}", list_charts());
            return 0;
        }
        return run(*options);
    } catch (const UsageError& error) {
        return fail(2, error.what());
    } catch (const Interrupted& error) {
        return fail(kInterruptedCode, error.what());
    } catch (const std::bad_alloc&) {
        return fail(1, "out of memory");
    } catch (const std::exception& error) {
        return fail(1, error.what());
    }
}
