#include "apps/chart/clip_ways.h"

#include <algorithm>
#include <limits>

namespace zoe::chart {

double always_refitted(const ClipTrees& trees) {
    double work = trees.trace_work(0, 0);
    for (size_t frame = 1; frame < trees.frame_count(); ++frame) work += trees.refit_work + trees.trace_work(0, frame);
    return work;
}

double always_rebuilt(const ClipTrees& trees) {
    double work = trees.trace_work(0, 0);
    for (size_t frame = 1; frame < trees.frame_count(); ++frame) work += trees.build_work + trees.trace_work(frame, frame);
    return work;
}

double in_hindsight(const ClipTrees& trees) {
    // [frame] of the frames from there on, beginning with a tree that was just built.
    std::vector<double> least(trees.frame_count(), std::numeric_limits<double>::infinity());
    for (size_t built = trees.frame_count(); built-- > 0;) {
        double kept = trees.trace_work(built, built);
        for (size_t next = built + 1; next < trees.frame_count(); ++next) {
            least[built] = std::min(least[built], kept + trees.build_work + least[next]);
            kept += trees.refit_work + trees.trace_work(built, next);
        }
        least[built] = std::min(least[built], kept);
    }
    return least[0];
}

double by_sensor(const ClipTrees& trees, double threshold) {
    const RebuildConfig config{.triangle_work = threshold * trees.build_work / trees.triangle_count};
    TreeWatch watch;
    note_build(trees.readings[0][0], trees.triangle_count, &watch);
    const TreeWatch* const watches[] = {&watch};
    std::vector<uint32_t> chosen;
    double work = trees.trace_work(0, 0);
    size_t built = 0;
    for (size_t frame = 1; frame < trees.frame_count(); ++frame) {
        work += trees.refit_work;
        note_refit(trees.readings[built][frame - built], &watch);
        add_loss(trees.rays, threshold * trees.build_work, &watch);
        choose_rebuilds(config, watches, &chosen);
        if (!chosen.empty()) {
            built = frame;
            work += trees.build_work;
            note_build(trees.readings[built][0], trees.triangle_count, &watch);
        }
        work += trees.trace_work(built, frame);
    }
    return work;
}

}  // namespace zoe::chart
