#include "engine/bvh/choose_rebuilds.h"

#include <algorithm>

namespace zoe {

void note_build(double cost, TreeWatch* watch) {
    if (cost > 0.0) watch->best_cost = watch->best_cost > 0.0 ? std::min(watch->best_cost, cost) : cost;
    watch->lost_work = 0.0;
    watch->is_refitted = false;
}

void add_loss(double cost, double rays, TreeWatch* watch) {
    if (watch->is_refitted) watch->lost_work += rays * std::max(0.0, cost - watch->best_cost);
}

void choose_rebuilds(const RebuildConfig& config, std::span<const TreeWatch* const> watches, std::vector<uint32_t>* chosen) {
    chosen->clear();
    const auto build_work = [&](uint32_t k) { return config.triangle_work * watches[k]->triangle_count; };
    double budget = 0.0;
    for (uint32_t k = 0; k < watches.size(); ++k) {
        budget += config.most_share * build_work(k);
        if (watches[k]->lost_work > 0.0 && watches[k]->lost_work >= build_work(k)) chosen->push_back(k);
    }
    const auto is_worse = [&](uint32_t a, uint32_t b) {
        const double left = watches[a]->lost_work * build_work(b), right = watches[b]->lost_work * build_work(a);
        return left != right ? left > right : a < b;
    };
    std::sort(chosen->begin(), chosen->end(), is_worse);
    size_t count = 0;
    for (; count < chosen->size(); ++count) {
        budget -= build_work((*chosen)[count]);
        if (budget < 0.0 && count > 0) break;
    }
    chosen->resize(count);
}

}  // namespace zoe
