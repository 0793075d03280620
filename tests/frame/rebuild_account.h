#pragma once

#include <cstdint>
#include <vector>

#include "engine/bvh/choose_rebuilds.h"
#include "tests/frame/rebuild_sequences.h"

namespace zoe::test {

/// [built][frame - built] what is read off a tree that was built for one frame and refitted to another.
using ReadingTable = std::vector<std::vector<TreeReading>>;

/// The first tree by full sweep, as a deforming node's is, and the others binned.
ReadingTable record_readings(const Sequence& sequence);

/// What ways through a clip take, in tests of a node's eight boxes: rays, refits and rebuilds. The first frame's tree is
/// there.
struct Account {
    const ReadingTable& readings;
    uint32_t triangle_count = 0;
    double rays = 0.0;                ///< That enter the tree in each frame.
    double refit_work = 0.0;          ///< A frame that does not rebuild.
    std::vector<double> shares = {};  ///< [frame_count] of `rays`, that enter in each frame; empty: all in each.

    size_t frame_count() const { return readings.size(); }
    double build_work() const { return RebuildConfig{}.triangle_work * triangle_count; }
    double trace_work(size_t built, size_t frame) const { return rays_in(frame) * readings[built][frame - built].cost; }
    double rays_in(size_t frame) const { return shares.empty() ? rays : shares[frame] * rays; }

    double always_refitted() const;
    double always_rebuilt() const;
    /// The least of all choices of frames to rebuild in.
    double in_hindsight() const;
    /// By what the engine chooses: it refits first, in every frame.
    /// last_built  out, where wanted: the last frame that rebuilds; 0 where none does.
    double by_policy(size_t* last_built = nullptr) const;
};

}  // namespace zoe::test
