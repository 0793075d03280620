#include "apps/chart/rotate.h"

#include <algorithm>
#include <utility>

namespace zoe::chart {
namespace {

constexpr double kLeastGain = 1e-5;  // Of the two boxes' areas; less is rounding.

// A child, and what is left of its box without one of its own children.
struct Opened {
    explicit Opened(const WideNode& node) : bounds(node.bounds()) {
        for (int slot = 0; slot < kWidth; ++slot) {
            boxes[slot] = node.box(slot);
            is_there[slot] = node.child[slot] != kEmptyChild;
            count += is_there[slot];
            for (int other = 0; other < kWidth; ++other) {
                if (other != slot) without[slot].extend(node.box(other));
            }
        }
    }
    Aabb bounds, boxes[kWidth], without[kWidth];
    bool is_there[kWidth] = {};
    int count = 0;
};

double area_with(Aabb box, const Aabb& other) {
    box.extend(other);
    return box.half_area();
}

struct Exchange {
    int slot_of_a = -1, slot_of_b = -1;
    double gain = 0.0;
};

Exchange best_exchange(const Opened& a, const Opened& b) {
    const double before = a.bounds.half_area() + b.bounds.half_area();
    Exchange best{.gain = kLeastGain * before};
    for (int i = 0; i < kWidth; ++i) {
        for (int k = 0; k < kWidth; ++k) {
            if (!a.is_there[i] && !b.is_there[k]) continue;
            if ((!a.is_there[i] && b.count == 1) || (!b.is_there[k] && a.count == 1)) continue;
            const double gain = before - area_with(a.without[i], b.boxes[k]) - area_with(b.without[k], a.boxes[i]);
            if (gain > best.gain) best = {i, k, gain};
        }
    }
    return best;
}

void exchange(WideNode* a, int slot_of_a, WideNode* b, int slot_of_b) {
    const Aabb box = a->box(slot_of_a);
    a->set_box(slot_of_a, b->box(slot_of_b));
    b->set_box(slot_of_b, box);
    std::swap(a->child[slot_of_a], b->child[slot_of_b]);
}

}  // namespace

size_t rotate(WideBvh* wide) {
    size_t count = 0;
    for (size_t n = wide->nodes.size(); n-- > 0;) {
        WideNode& node = wide->nodes[n];
        const auto is_inner = [&](int slot) { return node.child[slot] != kEmptyChild && !is_leaf(node.child[slot]); };
        for (int i = 0; i < kWidth; ++i) {
            for (int k = i + 1; k < kWidth; ++k) {
                if (!is_inner(i) || !is_inner(k)) continue;
                WideNode &a = wide->nodes[node.child[i]], &b = wide->nodes[node.child[k]];
                const Exchange best = best_exchange(Opened(a), Opened(b));
                if (best.slot_of_a < 0) continue;
                exchange(&a, best.slot_of_a, &b, best.slot_of_b);
                node.set_box(i, a.bounds());
                node.set_box(k, b.bounds());
                for (WideNode* changed : {&a, &b}) sum_costs(*wide, CollapseConfig{}.block_cost, changed);
                ++count;
            }
        }
        sum_costs(*wide, CollapseConfig{}.block_cost, &node);
    }
    return count;
}

}  // namespace zoe::chart
