#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/bvh/rebuild_config.h"

namespace zoe {

struct Blas;

/// What is read off a tree in one pose of its mesh.
struct TreeReading {
    double cost = 0.0;           ///< SAH cost: the work of a ray that enters the tree.
    double triangle_area = 0.0;  ///< Half areas of the boxes around triangles, beside the root's: what no tree can save.
};

/// Reads a tree that has been built or refitted.
/// Cost       O(1): the triangles of a hundred blocks, spread over the tree, stand for all; of one tree always the same.
TreeReading read_tree(const Blas& blas);

/// What tracing a refitted tree loses beside a tree built for the same pose.
struct TreeWatch {
    uint32_t triangle_count = 0;
    TreeReading built;           ///< At the last build.
    double ray_loss = 0.0;       ///< Of a ray, in the pose that it was refitted to last; 0 where it was not since.
    double frame_loss = 0.0;     ///< Of all rays of this frame.
    double lost_work = 0.0;      ///< Since the last build, this frame's counted.
    double new_cost = 0.0;       ///< Of a ray, in a tree built for this pose: as estimated.
    double needed_work = 0.0;    ///< What all rays since the last build would have taken in such trees.
    double coming_work = 0.0;    ///< Lost until the next jump, if this pose is held for as long as the last one was.
    double growth = 1.0;         ///< The tree's cost beside new_cost.
    uint64_t held = 0;           ///< Frames between the last two jumps: poses that doubled the growth. 0: not yet two.
    uint64_t since_jump = 0;     ///< One more than the frames that were added since the last one; 0: none yet.
    uint32_t regular_jumps = 0;  ///< Last ones that came as long after the one before as that after its own.
    double build_work = 0.0;     ///< Of this tree.
    double spare_work = 0.0;     ///< By which twice hindsight was more than what was done, up to the last build; at least.
    double open_work = 0.0;      ///< What hindsight will have lost on top, while the pose of the last build is held ...
    double open_loss = 0.0;      ///< ... a ray.
};

/// Begins anew after a build. What is known of jumps stays.
void note_build(const TreeReading& built, uint32_t triangle_count, TreeWatch* watch);

/// Estimates what a ray loses after a refit: the tree's cost, less what a new tree's would be. That is the last one's as it
/// was built, and what is below its root less by as much as the triangles have become smaller beside the root: else a tree
/// whose first pose was a bad one would never be found wanting. A tenth more counts as nothing.
void note_refit(const TreeReading& refitted, TreeWatch* watch);

/// Adds what a frame's rays lose.
/// rays       that enter the tree; need not be whole.
/// build_work what its rebuild takes: RebuildConfig::triangle_work a triangle.
void add_loss(double rays, double build_work, TreeWatch* watch);

/// Chooses the trees to be rebuilt before a frame is traced: those that will have lost what a rebuild takes. While that is
/// more than `share` of all work since the last build, the rebuild waits, for the clip may end or turn back: until the loss
/// is a rebuild's work and what the rays needed anyway. A tree that is bad at once is rebuilt before it has lost anything.
/// So is one that a jump made bad, where poses are held: if this one is held for as long as the last, the tree will have
/// lost a rebuild's work. Only while a rebuild is at most all work since the last build, and, where jumps came regularly,
/// what was spare before: then twice hindsight holds, too. For hindsight has a tree no newer at the last build, so that it
/// loses as much or rebuilds; of a pose that is still held, it also loses on where the new tree no longer does.
///
/// Where newer trees are never worse than older ones, and new trees never better than estimated, rays, refits and rebuilds
/// take at most twice what the best choice in hindsight would: until then that one has lost as much, or rebuilt. Waiting
/// longer would break this. Beside always refitting, a rebuild that turns out to be for nothing is a `share`, or happens
/// where waiting would break it; no rule that keeps to twice hindsight has less. Losses that are not counted, a tenth of
/// what a ray takes, come on top. Where poses come back, an old tree that was kept may be good again: no rule that doesn't
/// know what comes is always within three times of hindsight's then, with as few as two poses (Borodin, Linial, Saks. An
/// Optimal On-Line Algorithm for Metrical Task System. JACM 1992); this one stayed within four, with two
/// poses, wherever that was searched.
///
/// Tried, and no better: losses extrapolated by their trend; rebuilding as soon as a half or a quarter of a rebuild's work
/// is lost where the cost has doubled (jumps gain, waves lose up to twice as much). Without the condition on jumps, two
/// poses in turns take more than four times hindsight, nearly eight with what is spare after irregular ones; without what is
/// spare, a mesh whose triangles change places again and again takes up to 1.25 times the better of refits and rebuilds, and
/// 1.08 with it. Rebuilding the worst subtrees only, of a half down to a 32nd of the tree, each with an account of its own
/// and what it loses known exactly: 1.052 times hindsight in the mean of clips and numbers of rays, and 1.053 without.
///
/// A frame rebuilds all trees whose rebuild pays within it, and of the others so many as `most_share` allows, those first
/// that lost most for their size. What is left loses on, and its turn comes.
/// watches    of all trees that are refitted.
/// chosen     result: positions in `watches`.
/// Cost       O(trees log trees); no allocation once `chosen` is large enough. Counts of work decide, never times.
/// Source     Karlin, Manasse, Rudolph, Sleator. Competitive Snoopy Caching. Algorithmica 1988.
void choose_rebuilds(const RebuildConfig& config, std::span<const TreeWatch* const> watches, std::vector<uint32_t>* chosen);

}  // namespace zoe
