#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace zoe {

/// Picks indices with probabilities in proportion to weights, in constant time. Its memory is kept from one set of weights
/// to the next.
/// Source     Walker. New Fast Method for Generating Discrete Random Numbers with Arbitrary Frequency Distributions. 1974.
///            Vose. A Linear Algorithm for Generating Random Numbers with a Given Distribution. 1991.
class AliasTable {
public:
    /// weights    at least 0 and finite; fewer than 2^32.
    /// Cost       O(weights); the same table on any number of threads.
    void build(std::span<const float> weights);

    /// Sum of the weights; with 0 there is nothing to pick.
    double total() const { return total_; }

    /// u          uniform in [0, 1).
    /// Requires   total() > 0
    uint32_t pick(float u) const;

private:
    struct Slot {
        float keep;  // the probability that the slot's own index is picked, once the slot is
        uint32_t other;
    };
    std::vector<Slot> slots_;
    std::vector<uint32_t> small_, large_;
    double total_ = 0.0;
};

}  // namespace zoe
