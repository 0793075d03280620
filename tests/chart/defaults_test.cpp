// Every default that trades one price for another has a chart, or a measurement that is named here; where a chart sweeps it,
// it is within 5 % of the best that the chart shows. In work that is counted: the same on every machine.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "apps/chart/builder_knobs.h"
#include "apps/chart/builders.h"
#include "apps/chart/charts.h"
#include "apps/common/choose_view.h"
#include "apps/common/open_scene.h"
#include "engine/render/path.h"

namespace zoe::chart {
namespace {

namespace fs = std::filesystem;

constexpr double kMost = 1.05;

/// What a default costs beside the least that its chart shows.
using Above = std::function<double(const Chart& chart)>;

/// Logarithms of ratios; their mean is that of the ratios.
class Mean {
public:
    void add(double ratio) {
        sum_ += std::log(ratio);
        ++count_;
    }
    double value() const { return count_ == 0 ? std::nan("") : std::exp(sum_ / count_); }

private:
    double sum_ = 0.0;
    int count_ = 0;
};

double least_of(const std::vector<Point>& points) {
    return std::ranges::min_element(points, {}, [](const Point& p) { return p.y.median; })->y.median;
}

/// Where points of a series are values of the setting: in the mean over the panels that begin so, and their series.
/// series     all, where it is empty.
Above along(const std::string& panel_begin, const std::string& series_name = "") {
    return [=](const Chart& chart) {
        Mean mean;
        for (const Panel& panel : chart.panels) {
            if (!panel.name.starts_with(panel_begin)) continue;
            for (const Series& series : panel.series) {
                if (!series_name.empty() && series.name != series_name) continue;
                const auto found = std::ranges::find_if(series.points, &Point::is_default);
                if (found == series.points.end()) return std::nan("");
                mean.add(found->y.median / least_of(series.points));
            }
        }
        return mean.value();
    };
}

/// Where values of the setting are series: in the mean over the panels that begin so, and their x.
Above across(const std::string& panel_begin, const std::vector<std::string>& names) {
    return [=](const Chart& chart) {
        Mean mean;
        for (const Panel& panel : chart.panels) {
            if (!panel.name.starts_with(panel_begin)) continue;
            std::map<double, std::vector<Point>> by_x;
            for (const Series& series : panel.series) {
                if (std::ranges::find(names, series.name) == names.end()) continue;
                for (const Point& point : series.points) by_x[point.x.median].push_back(point);
            }
            for (const auto& [x, points] : by_x) {
                const auto found = std::ranges::find_if(points, &Point::is_default);
                if (found == points.end()) return std::nan("");
                mean.add(found->y.median / least_of(points));
            }
        }
        return mean.value();
    };
}

/// Light that more bounces would bring, beside that of the default.
double light_above(const Chart&) {
    Content content = open_scene("default", 24.0);
    const Tlas& tlas = advance(content, 1.0, nullptr);
    constexpr int kWidth = 40, kHeight = 24;
    const View view =
        ViewChoice{.camera = camera_nodes(content.scene).front()}.view(content.scene, float(kWidth) / float(kHeight));
    const auto light = [&](int bounce_count) {
        Film film(kWidth, kHeight);
        RenderConfig config;
        config.max_bounces = bounce_count;
        render(content.scene, tlas, view, config, 64, &film, nullptr);
        double sum = 0.0;
        for (const auto& pixel : film.sum) sum += pixel.x + pixel.y + pixel.z;
        return sum;
    };
    return light(16) / light(RenderConfig{}.max_bounces);
}

/// After the most samples, beside the least of all series.
double last_above(const Chart& chart) {
    double least = std::numeric_limits<double>::infinity(), ours = std::nan("");
    for (const Series& series : chart.panels[0].series) {
        const Point& last = series.points.back();
        least = std::min(least, last.y.median);
        if (last.is_default) ours = last.y.median;
    }
    return ours / least;
}

/// Samples that being judged late costs, where the least noise is asked for.
double least_samples_above(const Chart& chart) {
    double ours = std::nan(""), least = std::numeric_limits<double>::infinity();
    for (const Series& series : chart.panels[0].series) {
        if (!series.name.ends_with("at least")) continue;
        const Point& finest = series.points.back();
        if (finest.is_default) ours = finest.x.median;
        least = std::min(least, finest.x.median);
    }
    return ours / least;
}

/// A setting as it stands in the engine's headers, and why its default is what it is.
struct Default {
    const char* knob;
    const char* chart;     ///< That draws it; null: none.
    Above above = {};      ///< None: the chart draws it, and sweeps it not.
    const char* why = "";  ///< Where it has no chart: by what it was measured, or that it is none's trade.
};

const std::vector<Default>& defaults() {
    static const std::vector<Default> all = {
        {"BinnedConfig::bin_count", "bins", along("SAH")},
        {"BinnedConfig::max_leaf_size", "knobs", along("Binned", "leaf size")},
        {"BinnedConfig::node_cost", "knobs", along("Binned", "node cost")},
        {"SweepConfig::max_leaf_size", "knobs", along("Sweep", "leaf size")},
        {"SweepConfig::node_cost", "knobs", along("Sweep", "node cost")},
        {"ReinsertConfig::max_rounds", "knobs", along("Sweep", "rounds")},
        {"ReinsertConfig::candidate_share", "knobs", along("Sweep", "share of nodes")},
        {"ReinsertConfig::max_visits", "knobs", along("Sweep", "visits a search")},
        // Of a few hundred triangles, one tree tells nothing: see bvh/Reinsert.
        {"ReinsertConfig::min_gain", "knobs", along("Sweep", "least gain")},
        {"SbvhConfig::max_reference_growth", "knobs", along("Spatial", "references")},
        {"SbvhConfig::min_overlap", "knobs", along("Spatial", "overlap")},
        {"SbvhConfig::bin_count", "knobs", along("Spatial", "spatial bins")},
        {"SbvhConfig::max_leaf_size", "knobs", along("Spatial", "leaf size")},
        {"SbvhConfig::node_cost", "knobs", along("Spatial", "node cost")},
        {"CollapseConfig::max_leaf_blocks", "knobs", along("Wide", "leaf blocks")},
        {"CollapseConfig::block_cost", "knobs", along("Wide", "block cost")},
        {"ClusterConfig::exact_up_to", "tlas", across("Nodes", {"exact", "fast (radius 8)"})},
        {"ClusterConfig::search_radius", "tlas",
         across("Nodes", {"fast (radius 2)", "fast (radius 8)", "fast (radius 32)"})},
        {"PlocConfig::search_radius", "tlas", across("Nodes", {"fast (radius 2)", "fast (radius 8)", "fast (radius 32)"})},
        {"PlocConfig::top_count", "tlas", across("Nodes", {"fast (top of 1)", "fast (radius 8)", "fast (top of 2048)"})},
        {"RebuildConfig::triangle_work", "policy", along("", "by the sensor")},
        {"Scene::clip_poses", "clip", along("Work")},
        {"RenderConfig::max_bounces", "picture", light_above},
        {"Shutter::slices", "shutter", across("Samples", {"4 slices", "16 slices", "64 slices"})},
        {"NoiseConfig::least_samples", "noise", least_samples_above},
        {"NoiseConfig::target", nullptr, {}, "what is asked for: no trade"},
        {"NoiseConfig::least_luminance",
         nullptr,
         {},
         "a tenth of white: where an error of a hundredth is less than a step of 8 bits"},
        {"RenderConfig::search", "lights", last_above},
        {"DenoiseConfig::most_frames", "denoise", along("RMSE on a screen by", "frames that a mean looks back on")},
        {"DenoiseConfig::rounds", "denoise", along("RMSE on a screen by", "rounds of the filter")},
        {"DenoiseConfig::strength", "denoise", along("RMSE on a screen by", "strength of the filter")},
        {"AutoConfig::rays", "pays-off"},
        {"AutoConfig::budget_s", "pays-off"},
        {"SubdivisionOptions::level", "subdivision"},
        {"RebuildConfig::most_share", nullptr, {}, "bounds a frame's time, not a clip's work: frame/Rebuild's tests"},
        {"RebuildConfig::frame_rays", nullptr, {}, "a picture of a million rays; programs report their own number"},
        {"RebuildConfig::share",
         nullptr,
         {},
         "0.07 to 0.2 over the sequences of frame/RebuildBound, at all their numbers of rays"},
        {"PlacingConfig::most_parts", "placing"},
        {"PlacingConfig::least_share", nullptr, {}, "bounds what is looked at: most_parts ends the opening before it does"},
        {"PosesConfig::bin_count", nullptr, {}, "as BinnedConfig's, twice: built once, at loading"},
        {"PosesConfig::max_leaf_size", nullptr, {}, "as SweepConfig's, whose trees it stands in for"},
        {"PosesConfig::node_cost", nullptr, {}, "as SweepConfig's"},
        {"*::block_size", nullptr, {}, "what the kernels test at once: no trade"},
        {"RenderConfig::first_number", nullptr, {}, "which random numbers: no trade"},
        {"RenderConfig::sun_strength", nullptr, {}, "how the scene is lit: no trade"},
        {"RenderConfig::sky_strength", nullptr, {}, "how the scene is lit: no trade"},
    };
    return all;
}

std::string read(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

/// The numbers with a default of every `...Config` of the engine.
std::map<std::string, std::string> settings_of_the_engine() {
    std::map<std::string, std::string> text_of;
    const std::regex begin(R"((?:^///.*\n)*^struct (\w+) \{\n)", std::regex::multiline),
        field(R"(^    (?:int|uint32_t|float|double) (\w+) = )", std::regex::multiline);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(ZOETROPE_SOURCE_DIR) / "engine")) {
        if (entry.path().extension() != ".h") continue;
        const std::string header = read(entry.path());
        for (std::sregex_iterator it(header.begin(), header.end(), begin), end; it != end; ++it) {
            const std::string owner = (*it)[1];
            if (!owner.ends_with("Config")) continue;
            const auto at = static_cast<size_t>(it->position());
            const std::string text = header.substr(at, header.find("\n};", at) - at);
            for (std::sregex_iterator f(text.begin(), text.end(), field); f != end; ++f)
                text_of[owner + "::" + (*f)[1].str()] = text;
        }
    }
    return text_of;
}

bool is_about(const Default& row, const std::string& setting) {
    const std::string knob = row.knob;
    return knob.starts_with("*") ? setting.ends_with(knob.substr(1)) : setting == knob;
}

TEST(Defaults, EverySettingOfTheEngineIsInTheTable) {
    const std::map<std::string, std::string> settings = settings_of_the_engine();
    ASSERT_GT(settings.size(), 25u);
    for (const auto& [setting, text] : settings) {
        const auto rows = std::ranges::count_if(defaults(), [&](const Default& row) { return is_about(row, setting); });
        EXPECT_EQ(rows, 1) << setting << ": name its chart, or what it was measured by, in the table above";
    }
}

TEST(Defaults, EachNamesItsChartWhereItIsDeclared) {
    std::map<std::string, std::string> settings = settings_of_the_engine();
    const fs::path engine = fs::path(ZOETROPE_SOURCE_DIR) / "engine";
    settings["Scene::clip_poses"] = read(engine / "scene/scene.h");
    settings["RenderConfig::search"] = settings["RenderConfig::max_bounces"];
    settings["Shutter::slices"] = read(engine / "render/shutter.h");
    settings["SubdivisionOptions::level"] = read(engine / "deform/subdivide.h");
    for (const Default& row : defaults()) {
        SCOPED_TRACE(row.knob);
        EXPECT_NE(row.chart != nullptr, *row.why != '\0') << "a chart, or a reason";
        EXPECT_TRUE(std::ranges::any_of(settings, [&](const auto& setting) { return is_about(row, setting.first); }));
        if (row.chart == nullptr) continue;
        EXPECT_NO_THROW(find_chart(row.chart));
        const std::string text = settings[row.knob], name = std::string("hart `") + row.chart + '`';
        EXPECT_NE(text.find(name), std::string::npos) << "its docstring names another chart than " << row.chart;
    }
}

TEST(Defaults, AreWithinFivePercentOfTheBestThatTheirChartsShow) {
    std::map<std::string, Chart> charts;
    for (const Default& row : defaults()) {
        if (!row.above) continue;
        if (!charts.contains(row.chart)) {
            const Settings settings{.size = Size::kTiny};
            Sweep sweep(settings, {}, {});
            charts.emplace(row.chart, find_chart(row.chart).make(sweep));
        }
        const double above = row.above(charts.at(row.chart));
        std::printf("%-32s %-8s %.3f times the least\n", row.knob, row.chart, above);
        EXPECT_LE(above, kMost) << row.knob << ", chart " << row.chart;
    }
}

/// What the chart calls the default builds what the engine builds.
TEST(Defaults, OfTheChartOfSettingsAreTheEnginesOwn) {
    const std::map<std::string, BlasBuilder> builder_of = {{"Sweep and reinsertion", BlasBuilder::kReinserted},
                                                           {"Spatial splits and reinsertion", BlasBuilder::kSbvh},
                                                           {"Binned", BlasBuilder::kBinned},
                                                           {"Wide nodes of binned trees", BlasBuilder::kBinned}};
    const MeshSample sample = sample_mesh(mesh_subjects({.size = Size::kTiny})[0]);
    int compared = 0;
    for (const Knob& knob : builder_knobs()) {
        if (!knob.is_default) continue;
        SCOPED_TRACE(knob.panel + ", " + knob.series);
        Blas ours, engines;
        BlasScratch scratch;
        knob.build(sample.mesh, &ours, &scratch);
        build_blas(sample.mesh.positions(), sample.mesh.corners(), builder_of.at(knob.panel), &engines, &scratch);
        const auto &a = ours.tree.nodes, &b = engines.tree.nodes;
        ASSERT_EQ(a.size(), b.size());
        EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(WideNode)), 0);
        ++compared;
    }
    EXPECT_EQ(compared, 15);
}

}  // namespace
}  // namespace zoe::chart
