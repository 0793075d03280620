#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "apps/bench/frame_run.h"
#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/common/open_scene.h"

namespace zoe::chart {
namespace {

struct Way {
    const char* name;
    PlacingConfig config;
};

std::vector<Way> ways() {
    const PlacingConfig both;
    return {{"turned boxes", {.has_tight_boxes = false, .most_parts = 0}},
            {"tight boxes", {.has_tight_boxes = true, .most_parts = 0}},
            {"turned boxes, opened", {.has_tight_boxes = false, .most_parts = both.most_parts}},
            {"tight boxes, opened", both}};
}

bool is_default(const Way& way) {
    const PlacingConfig config;
    return way.config.has_tight_boxes == config.has_tight_boxes && way.config.most_parts == config.most_parts;
}

/// Scenes whose top level matters: many that turn, and things that stand in a room.
std::vector<std::string> scenes(const Settings& settings) {
    return {fmt::format("instances-{}", settings.pick(100, 10'000, 10'000)), "default",
            fmt::format("mixed-{}", settings.pick(1, 20, 50))};
}

std::string nodes_panel(const std::string& scene) {
    return scene + ": nodes";
}
std::string time_panel(const std::string& scene) {
    return scene + ": time";
}

/// A scene that is played one way.
class Play {
public:
    Play(const std::string& name, const Way& way, PictureSize size, int frame_count)
        : way_(way), content_(open_scene(name, kBenchFps)) {
        content_.scene.placing = way.config;
        const BenchScene scene{.name = name, .scene = name, .frame_count = frame_count, .size = size, .description = ""};
        run_ = std::make_unique<FrameRun>(content_, choose_view(content_, scene), size);
    }

    const Way& way() const { return way_; }

    void play(int frame, bool is_counted) {
        const FrameStats stats = run_->run(frame, nullptr, false).stats;
        if (!is_counted) return;
        build_ms_.push_back(stats.build_tlas_ms);
        double ms = 0.0, rays = 0.0;
        for (const RayKind kind : {RayKind::kPrimary, RayKind::kDiffuse, RayKind::kShadow}) {
            ms += kind_of(stats, kind).ms;
            rays += static_cast<double>(kind_of(stats, kind).rays);
        }
        ray_ns_.push_back(1e6 * ms / rays);
        Work work;
        for (const RayKind kind : {RayKind::kPrimary, RayKind::kDiffuse}) {
            const Work of_kind = work_of_rays(run_->tlas().levels(), run_->rays(kind));
            work.nodes += 0.5 * of_kind.nodes;
            hits_hash_ = 31 * hits_hash_ + of_kind.hits_hash;
        }
        nodes_.push_back(work.nodes);
    }

    uint64_t hits_hash() const { return hits_hash_; }
    Row row(const std::string& panel, const std::vector<double>& y) const {
        return {.panel = panel,
                .series = way_.name,
                .point = {.x = spread_of(build_ms_), .y = spread_of(y), .is_default = is_default(way_)}};
    }
    const std::vector<double>& nodes() const { return nodes_; }
    const std::vector<double>& ray_ns() const { return ray_ns_; }

private:
    Way way_;
    Content content_;
    std::unique_ptr<FrameRun> run_;
    std::vector<double> build_ms_, ray_ns_, nodes_;
    uint64_t hits_hash_ = 0;
};

std::vector<Row> measure(const std::string& scene, const Settings& settings) {
    const int frame_count = settings.pick(2, 6, 12), side = settings.pick(16, 128, 384);
    std::vector<std::unique_ptr<Play>> plays;
    for (const Way& way : ways()) plays.push_back(std::make_unique<Play>(scene, way, PictureSize{side, side}, frame_count));
    for (int frame = 0; frame <= frame_count; ++frame) {
        stop_if_interrupted();
        for (const auto& play : plays) play->play(frame, frame > 0);  // The first one builds all trees.
    }
    std::vector<Row> rows;
    for (const auto& play : plays) {
        if (play->hits_hash() != plays.front()->hits_hash())
            throw std::runtime_error(fmt::format("{}: '{}' gives other hits", scene, play->way().name));
        rows.push_back(play->row(nodes_panel(scene), play->nodes()));
        rows.push_back(play->row(time_panel(scene), play->ray_ns()));
    }
    return rows;
}

std::string caption(const Chart& chart, const Settings& settings) {
    const std::vector<Way> all = ways();
    const std::string plain = all.front().name, chosen = all.back().name;
    std::string text =
        "A turned mesh's box in the world is that of its turned box, or tight around what the mesh reaches; instances that "
        "need no transform may stand there as their largest parts. Default: both.";
    for (const std::string& scene : scenes(settings)) {
        const auto ratio = [&](const std::string& panel, const std::string& series) {
            const auto y = [&](const std::string& name) { return chart.panel(panel).find(name)->points.front().y.median; };
            return short_number(y(series) / y(plain));
        };
        text += fmt::format(" {}: {} times the nodes of plain boxes ({} by tight boxes, {} by parts), {} times the time.",
                            scene, ratio(nodes_panel(scene), chosen), ratio(nodes_panel(scene), all[1].name),
                            ratio(nodes_panel(scene), all[2].name), ratio(time_panel(scene), chosen));
    }
    return text;
}

}  // namespace

Chart placing(Sweep& sweep) {
    const Settings settings = sweep.settings();
    Chart chart{.name = "placing", .question = find_chart("placing").question, .columns = 3};
    std::vector<Step> steps;
    const Axis build{.name = "build_tlas", .unit = "ms"};
    for (const std::string& scene : scenes(settings)) {
        chart.panels.push_back(
            {.name = nodes_panel(scene), .x = build, .y = {.name = "nodes a ray visits", .unit = ""}, .is_trade = true});
        steps.push_back({.name = scene, .measure = [=] { return measure(scene, settings); }});
    }
    for (const std::string& scene : scenes(settings)) {
        chart.panels.push_back(
            {.name = time_panel(scene), .x = build, .y = {.name = "time a ray", .unit = "ns"}, .is_trade = true});
    }
    sweep.run(steps, &chart);
    chart.caption = caption(chart, settings);
    return chart;
}

}  // namespace zoe::chart
