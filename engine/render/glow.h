#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "engine/frame/trace.h"
#include "engine/render/alias_table.h"

namespace zoe {

/// The emissive triangles of a frame, to be picked by their power: area times the brightness of their material. A material's
/// brightness is its emission's strongest colour, times that of its texture's mean.
class Glow {
public:
    /// Collects them from what the frame shows. Memory is kept from one frame to the next.
    /// Cost       O(triangles that glow), plus O(material ranges): in parallel, but for the table of their powers, which is
    ///            kept while these are the same.
    void gather(const Scene& scene, const Tlas& tlas);

    bool is_dark() const { return !(table_.total() > 0.0); }

    /// A point on one of them, as a ray would meet it; its t is 0.
    /// pick, u    uniform in [0, 1).
    Hit sample(float pick, const glm::vec2& u) const;

    /// The density of `sample` on surfaces of a material, per square metre.
    float density(MaterialId material) const;

private:
    struct Place {
        NodeId node;
        uint32_t primitive;
    };
    /// Triangles of an instance that have the same material, from the place `begin` on.
    struct Piece {
        const Instance* instance;
        const MaterialRange* range;
        size_t begin, end;
    };
    void list_pieces(const Tlas& tlas);
    void weigh(size_t begin, size_t end);

    std::vector<float> brightness_;  // [material_count]
    std::vector<Piece> pieces_;      // while gathering
    std::vector<Place> places_;
    std::vector<float> power_, built_for_;  // [places]; built_for_: what the table holds
    AliasTable table_;
};

}  // namespace zoe
