#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/bench/frame_run.h"
#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/common/open_scene.h"
#include "engine/math/parallel.h"

namespace zoe::chart {
namespace {

/// Stages that take less on one thread have nothing to share.
constexpr double kWorthMeasuring_ms = 0.05;

struct Stage {
    const char* name;
    double FrameStats::*ms;
};
constexpr std::array kStages = {Stage{"animate", &FrameStats::animate_ms}, Stage{"deform", &FrameStats::deform_ms},
                                Stage{"update_blas", &FrameStats::update_blas_ms},
                                Stage{"build_tlas", &FrameStats::build_tlas_ms}, Stage{"trace", &FrameStats::trace_ms}};

/// Puts back what was set.
class ThreadCount {
public:
    ~ThreadCount() { set_thread_count(before_); }

private:
    int before_ = thread_count();
};

/// 1, 2, 4, ... and as many as are used.
std::vector<int> thread_counts() {
    std::vector<int> counts;
    for (int count = 1; count < thread_count(); count *= 2) counts.push_back(count);
    counts.push_back(thread_count());
    return counts;
}

/// A scene that is played by a number of threads.
struct Player {
    Content content;
    std::unique_ptr<FrameRun> frame_run;
    int threads = 1;
    std::array<std::vector<double>, kStages.size()> ms;
};

std::vector<Row> measure(const std::string& name, const Settings& settings) {
    const ThreadCount before;
    const int side = settings.pick(32, 128, 512), frame_count = settings.pick(2, 9, 24);
    const BenchScene scene{.name = name, .scene = name, .frame_count = frame_count, .size = {side, side}, .description = ""};
    std::vector<std::unique_ptr<Player>> players;
    for (const int count : thread_counts()) {
        players.push_back(std::make_unique<Player>());
        Player& player = *players.back();
        player.content = open_scene(name, kBenchFps);
        player.frame_run = std::make_unique<FrameRun>(player.content, choose_view(player.content, scene), scene.size);
        player.threads = count;
    }
    // The same frames for all, in turn; the first builds and makes room.
    for (int frame = 0; frame <= frame_count; ++frame) {
        stop_if_interrupted();
        std::optional<uint64_t> hits_hash;
        for (size_t k = 0; k < players.size(); ++k) {
            Player& player = *players[(k + static_cast<size_t>(frame)) % players.size()];
            set_thread_count(player.threads);
            player.frame_run->run(2 * frame, nullptr, false);  // threads that were just started are slow to come
            const FrameRecord record = player.frame_run->run(2 * frame + 1, nullptr, false);
            if (hits_hash.value_or(record.stats.hits_hash) != record.stats.hits_hash)
                throw std::runtime_error(fmt::format("{}: {} threads give other hits", name, player.threads));
            hits_hash = record.stats.hits_hash;
            for (size_t stage = 0; stage < kStages.size() && frame > 0; ++stage)
                player.ms[stage].push_back(record.stats.*kStages[stage].ms);
        }
    }
    std::vector<Row> rows;
    for (const auto& player : players) {
        const Spread x = Spread::exactly(player->threads);
        rows.push_back({.panel = name, .series = "ideal", .point = {.x = x, .y = x}});
        for (size_t stage = 0; stage < kStages.size(); ++stage) {
            const std::vector<double>&one = players.front()->ms[stage], &many = player->ms[stage];
            if (spread_of(one).median < kWorthMeasuring_ms) continue;
            std::vector<double> speed_ups;
            for (size_t k = 0; k < one.size(); ++k) speed_ups.push_back(one[k] / many[k]);
            rows.push_back({.panel = name, .series = kStages[stage].name, .point = {.x = x, .y = spread_of(speed_ups)}});
        }
    }
    return rows;
}

std::string caption(const Chart& chart) {
    std::string text = fmt::format(
        "Frame by frame, beside one thread. Stages that take less than {} ms on one are left out.", kWorthMeasuring_ms);
    for (const Panel& panel : chart.panels) {
        text += fmt::format(" {} on {} threads:", panel.name, panel.find("ideal")->points.back().x.median);
        for (const Series& series : panel.series)
            if (series.name != "ideal")
                text += fmt::format(" {} {},", series.name, short_number(series.points.back().y.median));
        text.back() = '.';
    }
    return text + " Default: as many threads as there are cores.";
}

}  // namespace

Chart threads(Sweep& sweep) {
    Chart chart{.name = "threads", .question = find_chart("threads").question, .columns = 3};
    const Settings& settings = sweep.settings();
    std::vector<Step> steps;
    for (const std::string name :
         {settings.pick("mixed-1", "mixed-4", "mixed-20"), settings.pick("skinned-2", "skinned-50", "skinned-100"),
          settings.pick("instances-300", "instances-10000", "instances-100000")}) {
        chart.panels.push_back({.name = name,
                                .x = {.name = "threads", .unit = "", .is_whole = true},
                                .y = {.name = "times as fast", .unit = "", .is_more_better = true}});
        steps.push_back({.name = name, .measure = [=, &sweep] { return measure(name, sweep.settings()); }});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart);
    return chart;
}

}  // namespace zoe::chart
