#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <glm/vec3.hpp>

#include "apps/bench/peer_embree.h"

namespace zoe {

/// A tree of Embree's over one mesh that stays as it is.
class PeerTree {
public:
    /// LOW in a dynamic scene, as a mesh that is rebuilt every frame has it; the others in static ones.
    enum class Quality : uint8_t { kLow, kMedium, kHigh };

    /// Builds it, on as many threads as told.
    /// Throws     UsageError where the program was built without Embree; std::runtime_error where Embree reports an error.
    PeerTree(Quality quality, bool is_robust, std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners,
             int threads);
    ~PeerTree();
    PeerTree(PeerTree&&) noexcept;
    PeerTree& operator=(PeerTree&&) noexcept;

    /// Builds it once more in the same scene, as a mesh that moves has it.
    /// Returns    ms.
    double rebuild();
    double build_ms() const;      ///< Of the last build.
    uint64_t byte_count() const;  ///< What Embree's memory monitor counts once the tree is built.

    /// As EmbreePeer's. Hits are those of node 0.
    /// form       one of `forms_of(kind)`.
    double closest_hits(std::span<const Ray> rays, EmbreeRays form, std::span<Hit> hits);
    double any_hits(std::span<const Ray> rays, EmbreeRays form, std::span<uint8_t> is_hit);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace zoe
