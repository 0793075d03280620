#include "tests/frame/rebuild_account.h"

#include <algorithm>
#include <limits>

#include "engine/bvh/blas.h"

namespace zoe::test {

ReadingTable record_readings(const Sequence& sequence) {
    ReadingTable readings;
    for (size_t built = 0; built < sequence.frames.size(); ++built) {
        Blas blas;
        build_blas(sequence.frames[built], sequence.corners, built == 0 ? BlasBuilder::kSweep : BlasBuilder::kBinned, &blas);
        std::vector<TreeReading>& row = readings.emplace_back();
        for (size_t frame = built; frame < sequence.frames.size(); ++frame) {
            if (frame > built) refit_blas(sequence.frames[frame], sequence.corners, &blas);
            row.push_back(read_tree(blas));
        }
    }
    return readings;
}

double Account::always_refitted() const {
    double work = trace_work(0, 0);
    for (size_t frame = 1; frame < frame_count(); ++frame) work += refit_work + trace_work(0, frame);
    return work;
}

double Account::always_rebuilt() const {
    double work = trace_work(0, 0);
    for (size_t frame = 1; frame < frame_count(); ++frame) work += build_work() + trace_work(frame, frame);
    return work;
}

double Account::in_hindsight() const {
    // [frame] of the frames from there on, beginning with a tree that was just built.
    std::vector<double> least(frame_count() + 1, 0.0);
    for (size_t built = frame_count(); built-- > 0;) {
        least[built] = std::numeric_limits<double>::infinity();
        double kept = trace_work(built, built);
        for (size_t next = built + 1; next <= frame_count(); ++next) {
            const double rest = next < frame_count() ? build_work() + least[next] : 0.0;
            least[built] = std::min(least[built], kept + rest);
            if (next < frame_count()) kept += refit_work + trace_work(built, next);
        }
    }
    return least[0];
}

double Account::by_policy(size_t* last_built) const {
    TreeWatch watch;
    note_build(readings[0][0], triangle_count, &watch);
    const TreeWatch* const watches[] = {&watch};
    std::vector<uint32_t> chosen;
    double work = trace_work(0, 0);
    size_t built = 0;
    for (size_t frame = 1; frame < frame_count(); ++frame) {
        work += refit_work;
        note_refit(readings[built][frame - built], &watch);
        add_loss(rays_in(frame), build_work(), &watch);
        choose_rebuilds({}, watches, &chosen);
        if (!chosen.empty()) {
            built = frame;
            work += build_work();
            note_build(readings[built][0], triangle_count, &watch);
        }
        work += trace_work(built, frame);
    }
    if (last_built) *last_built = built;
    return work;
}

}  // namespace zoe::test
