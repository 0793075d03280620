#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "apps/bench/frame_run.h"
#include "apps/bench/stopwatch.h"
#include "apps/chart/charts.h"
#include "apps/chart/measure.h"
#include "apps/chart/scattered.h"
#include "apps/common/open_scene.h"
#include "engine/bvh/build_binned.h"
#include "engine/bvh/build_clusters.h"
#include "engine/math/parallel.h"

namespace zoe::chart {
namespace {

constexpr const char* kBuild = "Build, with the tree's wide form";
constexpr const char* kStage = "build_tlas, whole";

/// Instances of a kind.
struct Family {
    const char* name;
    bool is_rows;  ///< The content's scene: equal copies in rows that move. Else scattered copies of all sizes.

    std::string nodes_panel() const { return fmt::format("Nodes a ray visits: {}", name); }
    std::string trade_panel(int count) const { return fmt::format("{}, {}", name, short_number(count)); }
};
constexpr Family kRows{"rows", true}, kScattered{"scattered", false};

/// Those whose trade of build and rays is shown.
std::vector<std::pair<Family, int>> trades(const Settings& settings) {
    const int count = settings.pick(300, 10'000, 10'000), most = settings.pick(10, 100'000, 100'000);
    return {{kRows, count}, {kScattered, count}, {kRows, most}};
}

bool is_trade(const Family& family, int count, const Settings& settings) {
    return std::ranges::any_of(trades(settings),
                               [&](const auto& trade) { return trade.first.name == family.name && trade.second == count; });
}

/// A tree over a frame's instances by one method, in the memory of the one before.
class TopLevel {
public:
    using Build = std::function<Bvh(std::span<const Aabb> boxes, Bvh storage)>;
    TopLevel(std::string name, Build build) : name_(std::move(name)), build_(std::move(build)) {}

    const std::string& name() const { return name_; }

    /// Returns    ms.
    double build(std::span<const Aabb> boxes) {
        Stopwatch watch;
        bvh_ = build_(boxes, std::move(bvh_));
        collapse(bvh_, {.block_size = 1, .max_leaf_blocks = 1}, &tree_, &slots_, &scratch_);
        return watch.restart_ms();
    }

    Work work(const Tlas& tlas, std::span<const Ray> rays) {
        placed_.clear();
        bounds_.clear();
        for (const uint32_t slot : slots_) {
            placed_.push_back(tlas.placed[slot]);
            bounds_.push_back(tlas.bounds_placed[slot]);
        }
        return work_of_rays({.top = &tree_,
                             .instances = placed_.data(),
                             .bounds = bounds_.data(),
                             .stack_size = tlas.stack_size - tlas.tree.stack_size() + tree_.stack_size(),
                             .slack = tlas.slack},
                            rays);
    }

private:
    std::string name_;
    Build build_;
    Bvh bvh_;
    WideBvh tree_;
    std::vector<uint32_t> slots_;
    std::vector<PlacedBlas> placed_;
    std::vector<Aabb> bounds_;
    CollapseScratch scratch_;
};

std::string fast_name(uint32_t radius) {
    return fmt::format("fast (radius {})", radius);
}

std::string top_name(uint32_t count) {
    return fmt::format("fast (top of {})", count);
}

std::vector<TopLevel> all_methods() {
    std::vector<TopLevel> methods;
    methods.emplace_back(
        "exact", [](std::span<const Aabb> boxes, Bvh storage) { return build_agglomerative(boxes, std::move(storage)); });
    const auto add_fast = [&](const std::string& name, const PlocConfig& config) {
        methods.emplace_back(name,
                             [config, scratch = std::make_shared<PlocScratch>()](std::span<const Aabb> boxes, Bvh storage) {
                                 return build_ploc(boxes, config, std::move(storage), scratch.get());
                             });
    };
    for (const uint32_t radius : {2u, ClusterConfig{}.search_radius, 32u})
        add_fast(fast_name(radius), {.search_radius = radius});
    for (const uint32_t count : {1u, 2048u}) add_fast(top_name(count), {.top_count = count});
    methods.emplace_back("binned", [](std::span<const Aabb> boxes, Bvh storage) {
        return build_binned(boxes, {.max_leaf_size = 1}, std::move(storage));
    });
    return methods;
}

/// What the engine takes for so many instances.
std::string default_name(int count) {
    const ClusterConfig config;
    return static_cast<uint32_t>(count) <= config.exact_up_to ? "exact" : fast_name(config.search_radius);
}

/// What one method took, frame by frame.
struct Taken {
    std::vector<double> build_ms, nodes;
};

std::vector<double> ratios(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> result;
    for (size_t k = 0; k < a.size(); ++k) result.push_back(a[k] / b[k]);
    return result;
}

std::vector<double> scaled(std::vector<double> numbers, double factor) {
    for (double& number : numbers) number *= factor;
    return numbers;
}

/// The whole stage in the frames of a scene, ours and Embree's.
class Peers {
public:
    explicit Peers(bool has_peer) {
        if (!has_peer) return;
        for (const bool is_medium : {false, true}) {
            peers_.push_back(std::make_unique<EmbreePeer>(EmbreeConfig{.is_top_medium = is_medium}, thread_count()));
        }
        build_ms_.resize(peers_.size());
    }
    void update(const Scene& scene, const Tlas& tlas, bool is_counted) {
        for (size_t k = 0; k < peers_.size(); ++k) {
            const double ms = peers_[k]->update(scene, tlas).build_tlas_ms;
            if (is_counted) build_ms_[k].push_back(ms);
        }
    }
    void add_rows(double count, std::vector<Row>* rows) const {
        for (size_t k = 0; k < peers_.size(); ++k) {
            rows->push_back({.panel = kBuild,
                             .series = k == 0 ? "Embree LOW" : "Embree MEDIUM",
                             .point = {.x = Spread::exactly(count), .y = spread_of(scaled(build_ms_[k], 1e6 / count))}});
        }
    }

private:
    std::vector<std::unique_ptr<EmbreePeer>> peers_;
    std::vector<std::vector<double>> build_ms_;
};

std::vector<Row> measure(const Family& family, int count, const Settings& settings) {
    const std::string name = fmt::format("instances-{}", count);
    const int frame_count = settings.pick(2, 5, 9), side = settings.pick(16, 64, 128);
    // Short ones are built more often: a frame's time is their median.
    const int repeats = std::clamp(20'000 / count, 1, 25);
    const BenchScene scene{.name = name, .scene = name, .frame_count = frame_count, .size = {side, side}, .description = ""};
    Content content = family.is_rows ? open_scene(name, kBenchFps) : make_scattered(count);
    FrameRun frame_run(content, choose_view(content, scene), scene.size);
    std::vector<TopLevel> methods = all_methods();
    std::vector<Taken> taken(methods.size());
    std::vector<double> stage_ms;
    Peers peers(settings.has_peer && family.is_rows);
    for (int frame = 0; frame <= frame_count; ++frame) {
        stop_if_interrupted();
        const bool is_counted = frame > 0;  // the first one makes room
        const FrameRecord record = frame_run.run(frame, nullptr, false);
        const Tlas& tlas = frame_run.tlas();
        peers.update(content.scene, tlas, is_counted);
        if (!is_counted) continue;
        stage_ms.push_back(record.stats.build_tlas_ms);
        std::vector<Aabb> boxes;
        for (const uint32_t part : tlas.slots) boxes.push_back(tlas.boxes[part]);
        std::vector<Ray> rays;
        for (const RayKind kind : {RayKind::kPrimary, RayKind::kDiffuse})
            rays.insert(rays.end(), frame_run.rays(kind).begin(), frame_run.rays(kind).end());
        const uint64_t hits_hash = work_of_rays(tlas.levels(), rays).hits_hash;
        std::vector<std::function<double()>> works;
        for (TopLevel& method : methods) works.emplace_back([&] { return method.build(boxes); });
        const std::vector<std::vector<double>> times_ms = measure_in_turn(works, repeats);
        for (size_t k = 0; k < methods.size(); ++k) {
            taken[k].build_ms.push_back(spread_of(times_ms[k]).median);
            const Work work = methods[k].work(tlas, rays);
            taken[k].nodes.push_back(work.nodes);
            if (work.hits_hash != hits_hash)
                throw std::runtime_error(fmt::format("{}: the tree by {} gives other hits", name, methods[k].name()));
        }
    }
    std::vector<Row> rows;
    const Spread n = Spread::exactly(count);
    for (size_t k = 0; k < methods.size(); ++k) {
        const bool is_default = methods[k].name() == default_name(count);
        const auto add = [&](const std::string& panel, const Spread& x, const std::vector<double>& y) {
            rows.push_back({.panel = panel,
                            .series = methods[k].name(),
                            .point = {.x = x, .y = spread_of(y), .is_default = is_default}});
        };
        if (family.is_rows) add(kBuild, n, scaled(taken[k].build_ms, 1e6 / n.median));
        add(family.nodes_panel(), n, ratios(taken[k].nodes, taken[0].nodes));
        if (is_trade(family, count, settings))
            add(family.trade_panel(count), spread_of(scaled(taken[k].build_ms, 1e6 / n.median)), taken[k].nodes);
    }
    if (family.is_rows)
        rows.push_back(
            {.panel = kBuild, .series = kStage, .point = {.x = n, .y = spread_of(scaled(stage_ms, 1e6 / n.median))}});
    peers.add_rows(count, &rows);
    return rows;
}

std::string caption(const Chart& chart, int most, const Settings& settings) {
    const ClusterConfig config;
    const std::string fast = fast_name(config.search_radius);
    const auto build_ms = [&](const std::string& series) {
        return 1e-6 * most * chart.point(kBuild, series, most).y.median;
    };
    std::string text = fmt::format(
        "Rows: equal copies that move; scattered: copies of sizes 1 to 1,000. Default: {}fast clustering with radius {}. "
        "Over {} instances that takes {} ms, exact clustering {} times as long, binned SAH {} times.",
        config.exact_up_to == 0 ? "" : fmt::format("exact clustering up to {} instances, beyond them ", config.exact_up_to),
        config.search_radius, short_number(most), short_number(build_ms(fast)),
        short_number(build_ms("exact") / build_ms(fast)), short_number(build_ms("binned") / build_ms(fast)));
    for (const Family& family : {kRows, kScattered}) {
        const std::string panel = family.nodes_panel();
        const double x = chart.panel(panel).find("exact")->points.back().x.median;
        const auto nodes = [&](const std::string& series) { return chart.point(panel, series, x).y.median; };
        text += fmt::format(
            " Over {} instances ({}) rays visit {} times as many nodes of the default's trees as of exact ones, and of "
            "binned ones {} times as many as of the default's.",
            short_number(x), family.name, short_number(nodes(default_name(static_cast<int>(x)))),
            short_number(nodes("binned") / nodes(default_name(static_cast<int>(x)))));
    }
    for (const auto& [family, count] : trades(settings)) {
        const std::string panel = family.trade_panel(count);
        text += fmt::format(" On the front of {}: {}.", panel, names_on_front(chart.panel(panel)));
    }
    if (chart.panel(kBuild).find("Embree LOW")) {
        text += fmt::format(
            " The whole stage, matrices included, takes {} ms over {} instances; Embree's {} (LOW) and {} (MEDIUM).",
            short_number(build_ms(kStage)), short_number(most), short_number(build_ms("Embree LOW")),
            short_number(build_ms("Embree MEDIUM")));
    }
    return text;
}

}  // namespace

Chart tlas(Sweep& sweep) {
    const Settings settings = sweep.settings();
    const Axis instances{.name = "instances", .unit = "", .is_log = true};
    Chart chart{.name = "tlas", .question = find_chart("tlas").question, .columns = 3};
    chart.panels = {{.name = kBuild, .x = instances, .y = {.name = "time", .unit = "ns an instance", .is_log = true}}};
    for (const Family& family : {kRows, kScattered})
        chart.panels.push_back(
            {.name = family.nodes_panel(), .x = instances, .y = {.name = "nodes / nodes of exact", .unit = ""}});
    for (const auto& [family, count] : trades(settings)) {
        chart.panels.push_back({.name = family.trade_panel(count),
                                .x = {.name = "build", .unit = "ns an instance", .is_log = true},
                                .y = {.name = "nodes a ray visits", .unit = ""},
                                .is_trade = true});
    }
    std::vector<Step> steps;
    const auto add_steps = [&](const Family& family, const std::vector<int>& counts) {
        for (const int count : counts) {
            steps.push_back({.name = fmt::format("{}: {}", family.name, count), .share = 1000.0 + count, .measure = [=] {
                                 return measure(family, count, settings);
                             }});
        }
    };
    using Counts = std::vector<int>;
    const auto in_rows = settings.pick<Counts>({10, 300}, {10, 100, 1000, 10'000, 100'000},
                                               {10, 30, 100, 300, 1000, 3000, 10'000, 30'000, 100'000});
    add_steps(kRows, in_rows);
    add_steps(kScattered,
              settings.pick<Counts>({10, 300}, {10, 100, 1000, 10'000}, {10, 30, 100, 300, 1000, 3000, 10'000, 30'000}));
    sweep.run(steps, &chart);
    chart.caption = caption(chart, in_rows.back(), settings);
    return chart;
}

}  // namespace zoe::chart
