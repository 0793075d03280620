#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/frame/trace.h"
#include "engine/render/view.h"

namespace zoe {

/// The point of a hit triangle, in the world.
glm::vec3 point_of(const Tlas& tlas, const Hit& hit);

/// Where everything on show was in the frame before: for whoever follows what a ray meets back to it.
class PastFrame {
public:
    /// Keeps a frame, as long as it is there: before the next `advance`.
    /// Cost       O(instances, and vertices of those that deform or are arbitrary); no allocation once sizes have settled.
    void keep(const Tlas& tlas, const View& view);
    void forget() { is_kept_ = false; }

    bool is_kept() const { return is_kept_; }
    const View& view() const { return view_; }  ///< Of the frame that was kept.

    /// Where a point was that a ray of the present frame has met.
    /// tlas       the present frame's.
    /// Returns    false where there was no such triangle: the node was hidden, or its mesh another one.
    bool find_point(const Tlas& tlas, const Hit& hit, glm::vec3* point) const;

private:
    static constexpr size_t kNotCopied = ~size_t{0};
    struct Place {
        Affine world_from_local;
        const Mesh* mesh = nullptr;  // null: nothing was shown
        uint64_t version = 0;
        size_t vertex_count = 0;
        size_t first = kNotCopied;  // in positions_; those of static and rigid nodes stay what they are
    };
    bool is_kept_ = false;
    View view_;
    std::vector<Place> places_;  // [node_count]
    std::vector<glm::vec3> positions_;
};

}  // namespace zoe
