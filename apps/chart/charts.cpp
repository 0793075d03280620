#include "apps/chart/charts.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "apps/common/usage_error.h"

namespace zoe::chart {
namespace {

constexpr std::array kCharts = {
    ChartInfo{"tlas", "What does a tree over moving instances cost to build, and its rays to trace?", tlas},
    ChartInfo{"placing", "What do tight boxes and opened instances cost, and what do they save rays?", placing},
    ChartInfo{"builders", "What does a better tree of triangles cost, and how much faster are its rays?", builders},
    ChartInfo{"bins", "How many bins does a tree need that is rebuilt every frame?", bins},
    ChartInfo{"knobs", "What do the builders' other settings give, and what do they take?", knobs},
    ChartInfo{"pays-off", "After how many rays has a better tree earned its build?", pays_off},
    ChartInfo{"triangle", "What does a triangle test cost that misses no edge, and how exact is its t?", triangle},
    ChartInfo{"far", "How far from the origin do rays still hit what they should?", far},
    ChartInfo{"degradation", "How soon do the rays of a tree that is only refitted pay for it?", degradation},
    ChartInfo{"clip", "What does a tree gain that is built for a whole clip, and not for its first frame?", clip},
    ChartInfo{"picture", "How fast does the noise of a picture go, and what do bounces add that are not followed?", picture},
    ChartInfo{"lights", "What is gained by looking for lights and waiting for bounces to meet them, both at once?", lights},
    ChartInfo{"filtering", "What do coarser levels of textures save in samples, and what do they blur?", filtering},
    ChartInfo{"shutter", "At how many times must a scene be made to blur what moves?", shutter},
    ChartInfo{"noise", "How many samples does it save to give them to the pixels that need them?", noise},
    ChartInfo{"denoise", "What does a filter over neighbours and frames save samples, and what is its error?", denoise},
    ChartInfo{"upsample", "What is gained by lighting a picture by a smaller one, and how small may that be?", upsample},
    ChartInfo{"skinning", "What volume does a twisted or bent limb lose, and what does it cost to keep it?", skinning},
    ChartInfo{"subdivision", "How far are triangles from the surface that a cage stands for, and what does nearer cost?",
              subdivision},
    ChartInfo{"policy", "How much must a refitted tree have lost before it is rebuilt?", policy},
    ChartInfo{"threads", "What does each stage of a frame gain from more threads?", threads},
};

}  // namespace

std::span<const ChartInfo> charts() {
    return kCharts;
}

const ChartInfo& find_chart(const std::string& name) {
    const auto found = std::ranges::find_if(kCharts, [&](const ChartInfo& chart) { return name == chart.name; });
    if (found != kCharts.end()) return *found;
    std::string names;
    for (const ChartInfo& chart : kCharts) names += fmt::format("{}{}", names.empty() ? "" : ", ", chart.name);
    throw UsageError(fmt::format("{}: no such chart; there are {}", name, names));
}

std::string list_charts() {
    std::string text;
    for (const ChartInfo& chart : kCharts) text += fmt::format("  {:<13}{}\n", chart.name, chart.question);
    return text;
}

}  // namespace zoe::chart
