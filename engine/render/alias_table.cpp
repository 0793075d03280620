#include "engine/render/alias_table.h"

#include <algorithm>
#include <cassert>

namespace zoe {

void AliasTable::build(std::span<const float> weights) {
    total_ = 0.0;
    for (const float weight : weights) total_ += static_cast<double>(weight);
    slots_.resize(weights.size());
    if (!(total_ > 0.0)) return;

    // Each slot holds the same probability. What has less than a slot's share is filled up by one that has more.
    const double scale = static_cast<double>(weights.size()) / total_;
    small_.clear();
    large_.clear();
    for (uint32_t i = 0; i < weights.size(); ++i) {
        slots_[i] = {static_cast<float>(static_cast<double>(weights[i]) * scale), i};
        (slots_[i].keep < 1.0f ? small_ : large_).push_back(i);
    }
    while (!small_.empty() && !large_.empty()) {
        Slot& filled = slots_[small_.back()];
        small_.pop_back();
        filled.other = large_.back();
        Slot& giver = slots_[filled.other];
        giver.keep -= 1.0f - filled.keep;
        if (giver.keep < 1.0f) {
            small_.push_back(filled.other);
            large_.pop_back();
        }
    }
    // What rounding leaves over has its slot for itself, unless its weight is 0.
    for (const uint32_t i : large_) slots_[i].keep = 1.0f;
    const uint32_t heaviest = static_cast<uint32_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
    for (const uint32_t i : small_) slots_[i] = weights[i] > 0.0f ? Slot{1.0f, i} : Slot{0.0f, heaviest};
}

uint32_t AliasTable::pick(float u) const {
    assert(total_ > 0.0);
    const double scaled = static_cast<double>(u) * static_cast<double>(slots_.size());
    const size_t slot = std::min(static_cast<size_t>(scaled), slots_.size() - 1);
    const Slot& chosen = slots_[slot];
    return scaled - static_cast<double>(slot) < static_cast<double>(chosen.keep) ? static_cast<uint32_t>(slot)
                                                                                 : chosen.other;
}

}  // namespace zoe
