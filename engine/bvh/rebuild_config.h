#pragma once

namespace zoe {

/// When trees that are refitted are rebuilt. Work is counted in tests of a node's eight boxes by one ray. Nothing of it
/// changes a hit.
struct RebuildConfig {
    /// What a binned rebuild takes a triangle. The chart `policy` measures it; it depends on the mesh, its rays and the
    /// machine, within a factor of two or so.
    double triangle_work = 12.0;
    /// Of the triangles of all refitted trees, that a frame rebuilds beside trees whose rebuild pays within that very frame.
    /// One tree may always be rebuilt, however large.
    double most_share = 0.125;
    double frame_rays = 1e6;  ///< Traced through a frame, where nobody counts them. 0: never rebuilt.
};

}  // namespace zoe
