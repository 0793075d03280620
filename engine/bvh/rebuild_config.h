#pragma once

namespace zoe {

/// When trees that are refitted are rebuilt. Work is counted in tests of a node's eight boxes by one ray. Nothing of it
/// changes a hit.
struct RebuildConfig {
    /// What a binned rebuild takes a triangle. The chart `policy` measures 10 to 31, by the mesh and its rays; this is about
    /// their middle. Where it is twice too large, clips take 3 % more in the mean; where it is half, they take no more.
    double triangle_work = 16.0;
    /// Of all work since a tree's last build, that its rebuild may be without having to wait. 1: none waits.
    double share = 0.1;
    /// Of the triangles of all refitted trees, that a frame rebuilds beside trees whose rebuild pays within that very frame.
    /// One tree may always be rebuilt, however large.
    double most_share = 0.125;
    double frame_rays = 1e6;  ///< Traced through a frame, where nobody counts them. 0: never rebuilt.
};

}  // namespace zoe
