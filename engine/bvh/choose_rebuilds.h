#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace zoe {

/// When trees that are refitted are rebuilt. Work is counted in tests of a node's eight boxes.
struct RebuildConfig {
    double triangle_work = 12.0;  ///< What a binned rebuild takes a triangle, beside what a ray of any kind takes.
    double most_share = 0.125;    ///< Of all refitted trees' triangles, that one frame rebuilds; one tree may be more.
    double frame_rays = 1e6;      ///< Traced through a frame, where nobody counts them. 0: never rebuilt.
};

/// What tracing a refitted tree has lost, against the best that its mesh has had.
struct TreeWatch {
    double best_cost = 0.0;  ///< The least SAH cost of its builds: the work of a ray that enters it. 0: not known.
    double lost_work = 0.0;  ///< Since the last build, by all rays.
    uint32_t triangle_count = 0;
    bool is_refitted = false;  ///< Since the last build. Else another would give the same tree again.
};

/// Begins anew after a build.
/// cost       SAH cost as built; 0, of a tree without an area, tells nothing.
void note_build(double cost, TreeWatch* watch);

/// Adds what a frame's rays lose in a tree that was refitted.
/// cost       SAH cost as refitted to the frame.
/// rays       that enter the tree in this frame; need not be whole.
void add_loss(double cost, double rays, TreeWatch* watch);

/// Chooses the trees to be rebuilt before a frame is traced: those that have lost what rebuilding costs, this frame's loss
/// counted. So rebuilding never takes more work than tracing does, and renting before buying keeps within twice of what
/// would have been best, had the end been known: not of a choice that waits for poses which make an old tree good again.
/// Where more are due than a frame may rebuild, those that lost most for their size come first; the others lose on, and
/// their turn comes.
/// watches    of all trees that are refitted.
/// chosen     result: positions in `watches`.
/// Cost       O(trees); no allocation once `chosen` is large enough. Counts of work decide, never times.
/// Source     Karlin, Manasse, Rudolph, Sleator. Competitive Snoopy Caching. Algorithmica 1988.
void choose_rebuilds(const RebuildConfig& config, std::span<const TreeWatch* const> watches, std::vector<uint32_t>* chosen);

}  // namespace zoe
