#pragma once

#include <memory>
#include <span>

#include "apps/bench/peer_tree.h"
#include "apps/bench/trees.h"
#include "apps/bench/world_mesh.h"

namespace zoe {

/// A tree that is compared: how its rays are traced is the owner's business.
class TracedTree {
public:
    virtual ~TracedTree() = default;
    TreeRow row;

    /// Traces all rays of a kind in every way there is, keeps the least times.
    /// hits, is_hit   [ray_count]
    virtual void trace_closest(std::span<const Ray> rays, RayKind kind, std::span<Hit> hits) = 0;
    virtual void trace_any(std::span<const Ray> rays, std::span<uint8_t> is_hit) = 0;

protected:
    /// Takes down what all rays of a kind took.
    /// way        of handing them over: "single".
    void keep(RayKind kind, const char* way, size_t ray_count, double ms);
};

/// A tree by one of our builders, built `repeats` times where that is quick. Tracing throws std::runtime_error where batches
/// and single rays give different hits.
///
/// primary, diffuse    rays by which the tests a ray are counted.
///
/// Cost       the builds, and the tree's end-point overlap.
std::unique_ptr<TracedTree> make_our_tree(const char* name, BlasBuilder builder, const WorldMesh& mesh, int repeats,
                                          std::span<const Ray> primary, std::span<const Ray> diffuse);

/// The same with Embree.
std::unique_ptr<TracedTree> make_peer_tree(const char* name, PeerTree::Quality quality, bool is_robust,
                                           const WorldMesh& mesh, int repeats);

}  // namespace zoe
