#include "apps/bench/trees_report.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace zoe {
namespace {

using Json = nlohmann::ordered_json;

double mtriangles_per_s(const TreeComparison& comparison, const TreeRow& row) {
    return row.build_ms > 0.0 ? static_cast<double>(comparison.triangle_count) / row.build_ms / 1000.0 : 0.0;
}

double bytes_per_triangle(const TreeComparison& comparison, const TreeRow& row) {
    return comparison.triangle_count > 0
               ? static_cast<double>(row.byte_count) / static_cast<double>(comparison.triangle_count)
               : 0.0;
}

double single_mrays_per_s(const TreeComparison& comparison, const TreeRow& row) {
    return row.primary_single_ms > 0.0 ? static_cast<double>(comparison.ray_count[0]) / row.primary_single_ms / 1000.0 : 0.0;
}

/// What the columns of the summary compare: more is better.
struct Measure {
    const char* name;
    std::function<double(const TreeComparison&, const TreeRow&)> value;
};
std::span<const Measure> measures() {
    static const std::array list = {
        Measure{"build", mtriangles_per_s},
        Measure{"bytes", [](const auto& c, const auto& row) { return 1.0 / bytes_per_triangle(c, row); }},
        Measure{"primary", [](const auto& c, const auto& row) { return c.mrays_per_s(row, RayKind::kPrimary); }},
        Measure{"single", single_mrays_per_s},
        Measure{"diffuse", [](const auto& c, const auto& row) { return c.mrays_per_s(row, RayKind::kDiffuse); }},
        Measure{"shadow", [](const auto& c, const auto& row) { return c.mrays_per_s(row, RayKind::kShadow); }},
        Measure{"frame", [](const auto& c, const auto& row) { return 1.0 / c.frame_ms(row); }},
    };
    return list;
}

/// Geometric mean over the scenes of how many times more tree `ours` has of it than tree `peer`; scenes in which no such ray
/// was traced are left out.
double mean_ratio(const std::vector<TreeComparison>& comparisons, size_t ours, size_t peer, const Measure& measure) {
    double sum = 0.0;
    size_t count = 0;
    for (const TreeComparison& comparison : comparisons) {
        const double our_value = measure.value(comparison, comparison.rows[ours]);
        const double peer_value = measure.value(comparison, comparison.rows[peer]);
        if (!(our_value > 0.0 && peer_value > 0.0)) continue;
        sum += std::log(our_value / peer_value);
        ++count;
    }
    return count > 0 ? std::exp(sum / static_cast<double>(count)) : std::numeric_limits<double>::quiet_NaN();
}

/// Requires   that the comparison has a tree by this builder.
size_t row_by(const TreeComparison& comparison, BlasBuilder builder) {
    const auto row = std::ranges::find_if(comparison.rows, [&](const TreeRow& r) { return r.builder == builder; });
    assert(row != comparison.rows.end());
    return static_cast<size_t>(row - comparison.rows.begin());
}

/// What SAH is worth over a median split, and a full sweep over bins.
std::string claims(const std::vector<TreeComparison>& comparisons) {
    const TreeComparison& first = comparisons.front();
    const size_t median = row_by(first, BlasBuilder::kMedian), binned = row_by(first, BlasBuilder::kBinned),
                 sweep = row_by(first, BlasBuilder::kSweep);
    const auto ratio = [&](size_t a, size_t b, const Measure& measure) { return mean_ratio(comparisons, a, b, measure); };
    const auto speeds = [&](size_t a, size_t b) {
        std::string text;
        for (const RayKind kind : kRayKinds) {
            const Measure speed{name(kind), [=](const auto& c, const auto& row) { return c.mrays_per_s(row, kind); }};
            text += fmt::format("{}{:.2f}x {}", text.empty() ? "" : ", ", ratio(a, b, speed), speed.name);
        }
        return text;
    };
    const Measure nodes{"nodes", [](const auto&, const auto& row) { return row.nodes; }};
    const Measure triangles{"triangles", [](const auto&, const auto& row) { return row.triangles; }};
    const Measure build{"build", mtriangles_per_s};
    return fmt::format(
        "\nsweep against median split: a ray tests {:.2f}x the nodes and {:.2f}x the triangles; speed of rays: {}\n"
        "binned against sweep: the build is {:.1f}x as fast; speed of rays: {}\n",
        ratio(sweep, median, nodes), ratio(sweep, median, triangles), speeds(sweep, median), ratio(binned, sweep, build),
        speeds(binned, sweep));
}

/// "12: 11 either, 1 ours"
std::string verdicts_text(const TreeRow& row) {
    std::string text = fmt::format("{}", row.disagreements);
    const char* separator = ": ";
    const auto add = [&](uint64_t count, const char* what) {
        if (count == 0) return;
        text += fmt::format("{}{} {}", separator, count, what);
        separator = ", ";
    };
    for (size_t k = 0; k < kVerdictCount; ++k) add(row.verdicts[k], name(static_cast<Verdict>(k)));
    add(row.not_judged, "not judged");
    return text;
}

}  // namespace

std::string trees_table(const TreeComparison& comparison) {
    std::string text =
        fmt::format("\n{}: {} triangles; {} primary, {} diffuse, {} shadow rays\n", comparison.scene,
                    comparison.triangle_count, comparison.ray_count[0], comparison.ray_count[1], comparison.ray_count[2]);
    text += fmt::format("{:<18}{:>10}{:>8}{:>8}{:>8}{:>8}{:>8}{:>10}{:>8}{:>9}{:>8}{:>11}{}\n", "", "build ms", "Mtri/s",
                        "B/tri", "SAH", "nodes", "tris", "primary", "single", "diffuse", "shadow", "frame ms", "  disagree");
    for (const TreeRow& row : comparison.rows) {
        const std::string quality = row.is_peer()
                                        ? fmt::format("{:>8}{:>8}{:>8}", "-", "-", "-")
                                        : fmt::format("{:>8.2f}{:>8.2f}{:>8.2f}", row.sah, row.nodes, row.triangles);
        text += fmt::format("{:<18}{:>10.2f}{:>8.2f}{:>8.1f}{}{:>10.2f}{:>8.2f}{:>9.2f}{:>8.2f}{:>11.1f}  {}\n", row.name,
                            row.build_ms, mtriangles_per_s(comparison, row), bytes_per_triangle(comparison, row), quality,
                            comparison.mrays_per_s(row, RayKind::kPrimary), single_mrays_per_s(comparison, row),
                            comparison.mrays_per_s(row, RayKind::kDiffuse), comparison.mrays_per_s(row, RayKind::kShadow),
                            comparison.frame_ms(row), verdicts_text(row));
    }
    return text;
}

std::string trees_summary(const std::vector<TreeComparison>& comparisons) {
    std::string text =
        "\nSAH: of the tree that is traversed, 1 a node and 1 a block of triangles. nodes, tris: tested by a primary or "
        "diffuse ray.\nprimary to shadow: Mrays/s; single: primary rays, a call each. frame: the build, a million primary "
        "and "
        "a million diffuse rays.\n";
    if (comparisons.empty()) return text;
    text += claims(comparisons);
    if (!comparisons.front().rows.back().is_peer()) return text;
    text += fmt::format("\n{:<42}", fmt::format("geometric means over {} scenes", comparisons.size()));
    for (const Measure& measure : measures()) text += fmt::format("{:>9}", measure.name);
    text += "\n";
    const std::vector<TreeRow>& rows = comparisons.front().rows;
    for (size_t ours = 0; ours < rows.size(); ++ours) {
        for (size_t peer = 0; peer < rows.size(); ++peer) {
            if (rows[ours].is_peer() || !rows[peer].is_peer() || rows[ours].builder == BlasBuilder::kMedian) continue;
            text += fmt::format("{:<42}", fmt::format("{} against {}", rows[ours].name, rows[peer].name));
            for (const Measure& measure : measures())
                text += fmt::format("{:>8.2f}x", mean_ratio(comparisons, ours, peer, measure));
            text += "\n";
        }
    }
    return text;
}

std::string trees_json(const std::vector<TreeComparison>& comparisons,
                       const std::vector<std::pair<std::string, std::string>>& machine) {
    Json about = Json::object(), scenes = Json::array();
    for (const auto& [key, value] : machine) about[key] = value;
    for (const TreeComparison& comparison : comparisons) {
        Json rows = Json::array(), rays = Json::object();
        for (const RayKind kind : kRayKinds) rays[name(kind)] = comparison.ray_count[static_cast<size_t>(kind)];
        for (const TreeRow& row : comparison.rows) {
            Json json = {{"tree", row.name},
                         {"is_peer", row.is_peer()},
                         {"build_ms", row.build_ms},
                         {"bytes", row.byte_count},
                         {"bytes_per_triangle", bytes_per_triangle(comparison, row)}};
            if (!row.is_peer()) {
                json["sah"] = row.sah;
                json["depth"] = row.depth;
                json["binary"] = {{"sah", row.binary.sah},
                                  {"epo", row.epo.cost},
                                  {"epo_is_sampled", row.epo.is_sampled},
                                  {"depth", row.binary.depth},
                                  {"references", row.binary.reference_count},
                                  {"duplicates", row.binary.duplicate_count},
                                  {"bytes", row.binary.bytes}};
                json["nodes_per_ray"] = row.nodes;
                json["triangles_per_ray"] = row.triangles;
            }
            for (const RayKind kind : kRayKinds)
                json[fmt::format("{}_ms", name(kind))] = row.trace_ms[static_cast<size_t>(kind)];
            json["primary_single_ms"] = row.primary_single_ms;
            json["disagreements"] = row.disagreements;
            if (row.is_peer()) {
                json["verdicts"] = {{"ours_right", row.verdicts[static_cast<size_t>(Verdict::kOurs)]},
                                    {"peer_right", row.verdicts[static_cast<size_t>(Verdict::kPeers)]},
                                    {"either_right", row.verdicts[static_cast<size_t>(Verdict::kEither)]},
                                    {"neither_right", row.verdicts[static_cast<size_t>(Verdict::kNeither)]},
                                    {"not_judged", row.not_judged}};
            }
            rows.push_back(std::move(json));
        }
        scenes.push_back(
            {{"scene", comparison.scene}, {"triangles", comparison.triangle_count}, {"rays", rays}, {"rows", rows}});
    }
    return Json{{"machine", about}, {"trees", scenes}}.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace zoe
