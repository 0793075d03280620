#include "engine/bvh/reinsert.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/bvh/small_stack.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr uint32_t kNobody = 0xffffffffu;
constexpr size_t kGrain = 256;

// Takes node `from` out, and puts it back beside `to`.
struct Move {
    uint32_t from = kNobody, to = kNobody;
    double gain = 0.0;  // Area of inner nodes that it saves.
};

class Optimiser {
public:
    Optimiser(Bvh* bvh, int max_visits)
        : nodes_(bvh->nodes), max_visits_(max_visits), parent_(bvh->nodes.size(), kNobody), visit_(bvh->nodes.size(), 0) {
        for (uint32_t k = 0; k < nodes_.size(); ++k) adopt_children(k);
        least_gain_ = 1e-9 * area(0);
    }

    // Returns the number of moves made; adds their gain to *gain.
    uint32_t improve(float candidate_share, double* gain) {
        pick_candidates(candidate_share);
        moves_.resize(candidates_.size());
        parallel_for(0, candidates_.size(), kGrain, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) moves_[k] = best_move(candidates_[k]);
        });
        std::erase_if(moves_, [](const Move& move) { return move.to == kNobody; });
        std::sort(moves_.begin(), moves_.end(),
                  [](const Move& a, const Move& b) { return a.gain > b.gain || (a.gain == b.gain && a.from < b.from); });
        uint32_t count = 0;
        for (const Move& move : moves_) {
            // Moves made since it was found may have changed what it is worth.
            const double gain_now = gain_of(move);
            if (gain_now <= least_gain_) continue;
            make(move);
            *gain += gain_now;
            ++count;
        }
        return count;
    }

private:
    Aabb box(uint32_t k) const { return nodes_[k].bounds(); }
    double area(uint32_t k) const { return box(k).half_area(); }
    uint32_t sibling(uint32_t k) const {
        const uint32_t first = nodes_[parent_[k]].first;
        return k == first ? first + 1 : first;
    }
    void adopt_children(uint32_t k) {
        if (nodes_[k].is_leaf()) return;
        parent_[nodes_[k].first] = parent_[nodes_[k].first + 1] = k;
    }

    void pick_candidates(float share) {
        candidates_.resize(nodes_.size() - 1);
        std::iota(candidates_.begin(), candidates_.end(), 1u);
        const auto count = std::min(candidates_.size(), static_cast<size_t>(std::max(0.0f, share) * candidates_.size()) + 1);
        const auto is_larger = [&](uint32_t a, uint32_t b) {
            const double area_a = area(a), area_b = area(b);
            return area_a > area_b || (area_a == area_b && a < b);
        };
        if (count < candidates_.size()) {
            std::nth_element(candidates_.begin(), candidates_.begin() + count, candidates_.end(), is_larger);
        }
        candidates_.resize(count);
    }

    // Walks up from a node. At each ancestor looks through the other child's subtree, all of it that can still win:
    //
    //          ancestor          saved: the node's parent, and what ancestors below shrink by
    //         /        \         spent: what the nodes on the way down to the new place grow by, and a new parent there,
    //     ...           other           never smaller than the node itself
    //    /   \          /   |
    //  node  sibling
    Move best_move(uint32_t from) const {
        Move best{kNobody, kNobody, least_gain_};
        const Aabb moved = box(from);
        const double moved_area = moved.half_area();
        const uint32_t parent = parent_[from];
        double saved = area(parent);
        int visits_left = max_visits_;
        Aabb rest = box(sibling(from));  // Of the ancestor below, without the node.
        const auto look_through = [&](uint32_t other, bool is_own_sibling) {
            struct Open {
                uint32_t node;
                double spent;
            };
            SmallStack<Open, 64> open;
            open.push({other, 0.0});
            while (!open.is_empty()) {
                const auto [k, spent] = open.pop();
                if (saved - spent - moved_area <= best.gain) continue;
                if (visits_left-- <= 0) return;
                const double joint = merge(box(k), moved).half_area();
                const double gain = saved - spent - joint;
                if (gain > best.gain && !(is_own_sibling && k == other)) best = {from, k, gain};
                const double spent_below = spent + joint - area(k);
                if (nodes_[k].is_leaf() || saved - spent_below - moved_area <= best.gain) continue;
                open.push({nodes_[k].first + 1, spent_below});
                open.push({nodes_[k].first, spent_below});
            }
        };
        look_through(sibling(from), true);
        for (uint32_t at = parent; at != 0 && visits_left-- > 0; at = parent_[at]) {
            const uint32_t other = sibling(at), above = parent_[at];
            look_through(other, false);
            rest.extend(box(other));
            const double rest_area = rest.half_area();
            // Above the ancestor, which shrinks; its new parent is as large as it was.
            if (saved - rest_area > best.gain) best = {from, above, saved - rest_area};
            saved += area(above) - rest_area;
        }
        return best;
    }

    // What a move saves in the tree as it is now; 0 where it cannot be made any more.
    double gain_of(const Move& move) {
        const auto [from, to, unused] = move;
        const uint32_t parent = parent_[from];
        if (to == parent || to == sibling(from)) return 0.0;
        ++visit_count_;
        for (uint32_t k = parent; k != kNobody; k = parent_[k]) visit_[k] = visit_count_;
        const Aabb moved = box(from);
        double gain = 0.0;
        uint32_t meeting = to;
        if (visit_[to] != visit_count_) {
            gain -= merge(box(to), moved).half_area();
            for (meeting = parent_[to]; visit_[meeting] != visit_count_; meeting = parent_[meeting]) {
                if (meeting == from) return 0.0;
                gain -= merge(box(meeting), moved).half_area() - area(meeting);
            }
            if (to == from || meeting == from) return 0.0;
        }
        // Ancestors below where the ways meet shrink; one that is the target does too, under a parent of its old size.
        gain += area(parent);
        Aabb rest = box(sibling(from));
        uint32_t at = parent;
        while (at != meeting) {
            rest.extend(box(sibling(at)));
            at = parent_[at];
            if (at != meeting) gain += area(at) - rest.half_area();
        }
        if (meeting == to) gain -= rest.half_area();
        return gain;
    }

    // Nodes keep their places in pairs; what is in them moves.
    void make(const Move& move) {
        const uint32_t parent = parent_[move.from], freed = sibling(move.from);
        const uint32_t pair = std::min(move.from, freed);
        put(parent, nodes_[freed]);
        put(freed, nodes_[move.to]);
        const Aabb joint = merge(box(freed), box(move.from));
        put(move.to, {joint.lo, pair, joint.hi, 0});
        fit_up(parent_[parent]);
        fit_up(move.to);
    }
    void put(uint32_t place, const BvhNode& node) {
        nodes_[place] = node;
        adopt_children(place);
    }
    void fit_up(uint32_t k) {
        for (; k != kNobody; k = parent_[k]) {
            const Aabb bounds = merge(box(nodes_[k].first), box(nodes_[k].first + 1));
            nodes_[k].lo = bounds.lo;
            nodes_[k].hi = bounds.hi;
        }
    }

    std::vector<BvhNode>& nodes_;
    const int max_visits_;
    std::vector<uint32_t> parent_;
    std::vector<uint32_t> visit_;  // The last `gain_of` that found a node among the ancestors.
    uint32_t visit_count_ = 0;
    std::vector<uint32_t> candidates_;
    std::vector<Move> moves_;
    double least_gain_;  // Less may be rounding.
};

// Depth first again, children in pairs after their parent, primitives in the order of the leaves.
void put_in_order(Bvh* bvh) {
    struct Open {
        uint32_t from, to;
    };
    std::vector<BvhNode> nodes;
    std::vector<uint32_t> primitives;
    nodes.reserve(bvh->nodes.size());
    primitives.reserve(bvh->primitives.size());
    nodes.push_back(bvh->nodes[0]);
    SmallStack<Open, 64> open;
    open.push({0, 0});
    while (!open.is_empty()) {
        const auto [from, to] = open.pop();
        const BvhNode& node = bvh->nodes[from];
        if (node.is_leaf()) {
            nodes[to].first = static_cast<uint32_t>(primitives.size());
            const auto begin = bvh->primitives.begin() + node.first;
            primitives.insert(primitives.end(), begin, begin + node.count);
        } else {
            const auto children = static_cast<uint32_t>(nodes.size());
            nodes[to].first = children;
            nodes.push_back(bvh->nodes[node.first]);
            nodes.push_back(bvh->nodes[node.first + 1]);
            open.push({node.first + 1, children + 1});
            open.push({node.first, children});
        }
    }
    bvh->nodes = std::move(nodes);
    bvh->primitives = std::move(primitives);
}

}  // namespace

ReinsertCounts reinsert(Bvh* bvh, const ReinsertConfig& config) {
    ReinsertCounts counts;
    if (bvh->nodes.size() < 5) return counts;  // Two leaves or three nodes have no other tree worth a search.
    {
        Optimiser optimiser(bvh, config.max_visits);
        double cost = 0.0;
        for (const BvhNode& node : bvh->nodes) cost += node.bounds().half_area() * (node.is_leaf() ? node.count : 1.0);
        while (counts.rounds < config.max_rounds) {
            double gain = 0.0;
            counts.moves += optimiser.improve(config.candidate_share, &gain);
            ++counts.rounds;
            if (!(gain > config.min_gain * cost)) break;
            cost -= gain;
        }
    }
    // Here, where the search's memory is given back: the nodes are there twice.
    put_in_order(bvh);
    return counts;
}

}  // namespace zoe
