#include "engine/bvh/cluster_index.h"

#include <algorithm>
#include <cassert>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr uint32_t kWidth = ClusterGroup::kWidth;
constexpr size_t kGrain = 8;         // Groups that one thread looks for partners of.
constexpr size_t kSplitGrain = 512;  // Clusters that one thread puts in order.

// Calls `take(lane)` for each set bit.
template <typename Take>
void for_each_bit(uint32_t bits, Take&& take) {
    for (; bits != 0; bits &= bits - 1) take(static_cast<uint32_t>(__builtin_ctz(bits)));
}

// A box that is empty or not finite counts as all there is: no other one is joined later.
Aabb proper(const Aabb& box) {
    constexpr float kAll = ClusterGroup::kFarthest;
    return box.is_proper() ? box : Aabb{glm::vec3(-kAll), glm::vec3(kAll)};
}

}  // namespace

void ClusterIndex::start(std::span<const Aabb> boxes) {
    assert(!boxes.empty() && boxes.size() < (size_t{1} << 31));
    const size_t box_count = boxes.size();
    cluster_count_ = slot_count_ = static_cast<uint32_t>(box_count);
    size_t count = box_count;
    for (uint32_t level = 0; level == 0 || count > 1; ++level) {
        count = (count + kWidth - 1) / kWidth;
        if (levels_[level].size() < count) levels_[level].resize(count);
        tree_.levels[level] = levels_[level].data();
    }
    items_.resize(box_count);
    parallel_for(0, box_count, kSplitGrain, [&](size_t begin, size_t end) {
        for (size_t id = begin; id < end; ++id) {
            const Aabb box = proper(boxes[id]);
            const glm::vec3 centre = 0.5f * box.hi + 0.5f * box.lo, half = 0.5f * box.hi - 0.5f * box.lo;
            items_[id] = {{centre.x, centre.y, centre.z, half.x, half.y, half.z}, static_cast<uint32_t>(id)};
        }
    });
    size_t size = kWidth;
    while (size < box_count) size *= 2;
    for (; size > kWidth; size /= 2) {
        parallel_for(0, box_count, std::max(size, kSplitGrain), [&](size_t from, size_t to) {
            for (size_t begin = from; begin < to; begin += size) split(begin, begin + size / 2, begin + size);
        });
    }
    slot_of_id_.resize(box_count);
    parallel_for(0, box_count, kSplitGrain, [&](size_t begin, size_t end) {
        for (size_t slot = begin; slot < end; ++slot) {
            const uint32_t id = items_[slot].id;
            leaf_of(static_cast<uint32_t>(slot)).set(slot % kWidth, proper(boxes[id]), id);
            slot_of_id_[id] = static_cast<uint32_t>(slot);
        }
    });
    partner_of_id_.assign(box_count, kNobody);
    suitor_of_id_.assign(box_count, kNobody);
    next_suitor_.resize(box_count);
    const size_t group_count = (box_count + kWidth - 1) / kWidth;
    searching_.assign(group_count, 0xffff);
    if (box_count % kWidth != 0) searching_.back() = static_cast<uint16_t>((1u << box_count % kWidth) - 1);
    search_groups_.reserve(group_count);
    sum_up();
}

// Orders [begin, end) about `middle`, along what varies most: a coordinate of the centres or, where boxes differ in size
// rather than in place, of the half extents. Equal ones are divided by id, which is what ties are pruned by.
void ClusterIndex::split(size_t begin, size_t middle, size_t end) {
    end = std::min(end, items_.size());
    if (middle >= end) return;
    Item lo = items_[begin], hi = lo;
    for (size_t k = begin; k < end; ++k) {
        for (int j = 0; j < 6; ++j) {
            lo.place_and_size[j] = std::min(lo.place_and_size[j], items_[k].place_and_size[j]);
            hi.place_and_size[j] = std::max(hi.place_and_size[j], items_[k].place_and_size[j]);
        }
    }
    int widest = 0;
    for (int j = 1; j < 6; ++j) {
        if (hi.place_and_size[j] - lo.place_and_size[j] > hi.place_and_size[widest] - lo.place_and_size[widest]) widest = j;
    }
    const auto at = [this](size_t k) { return items_.begin() + static_cast<ptrdiff_t>(k); };
    std::nth_element(at(begin), at(middle), at(end), [widest](const Item& a, const Item& b) {
        return a.place_and_size[widest] != b.place_and_size[widest] ? a.place_and_size[widest] < b.place_and_size[widest]
                                                                    : a.id < b.id;
    });
}

void ClusterIndex::sum_up() {
    for (uint32_t slot = slot_count_; slot % kWidth != 0; ++slot) leaf_of(slot).clear(slot % kWidth);
    tree_.level_count = 0;
    for (uint32_t count = slot_count_; tree_.level_count == 0 || count > 1; ++tree_.level_count) {
        count = (count + kWidth - 1) / kWidth;
    }
    sum_up_clusters(tree_, slot_count_);
}

void ClusterIndex::find(uint32_t group, uint32_t lanes) {
    uint32_t partners[kWidth];
    search_clusters(tree_, group, lanes, partners);
    for_each_bit(lanes, [&](uint32_t lane) { partner_of_id_[levels_[0][group].id(lane)] = partners[lane]; });
}

void ClusterIndex::find_partners() {
    assert(cluster_count_ > 1);
    search_groups_.clear();
    for (uint32_t group = 0; group * kWidth < slot_count_; ++group) {
        if (searching_[group] != 0) search_groups_.push_back(group);
    }
    parallel_for(0, search_groups_.size(), kGrain, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) find(search_groups_[k], searching_[search_groups_[k]]);
    });
}

void ClusterIndex::merge_mutual(std::vector<Pair>* pairs) {
    const size_t first = pairs->size();
    for (const uint32_t group : search_groups_) {
        for_each_bit(searching_[group], [&](uint32_t lane) {
            const uint32_t a = levels_[0][group].id(lane), b = partner_of_id_[a];
            add_suitor(a);
            // Where both searched, they are met twice.
            if (partner_of_id_[b] == a && (a < b || !is_searching(b))) pairs->push_back({std::min(a, b), std::max(a, b)});
        });
    }
    for (const uint32_t group : search_groups_) searching_[group] = 0;
    for (const Pair& pair : std::span(*pairs).subspan(first)) join(pair);
    if (!close_gaps()) sum_up_clusters(tree_, slot_count_);
}

uint32_t ClusterIndex::partner(uint32_t id) {
    if (is_searching(id)) {
        const uint32_t slot = slot_of_id_[id];
        find(slot / kWidth, 1u << slot % kWidth);
        searching_[slot / kWidth] ^= static_cast<uint16_t>(1u << slot % kWidth);
        add_suitor(id);
    }
    return partner_of_id_[id];
}

void ClusterIndex::merge(const Pair& pair) {
    const uint32_t slot = slot_of_id_[pair.low], free_slot = slot_of_id_[pair.high];
    join(pair);
    if (close_gaps()) return;
    refit_clusters(tree_, slot);
    refit_clusters(tree_, free_slot);
}

void ClusterIndex::add_suitor(uint32_t id) {
    const uint32_t partner = partner_of_id_[id];
    next_suitor_[id] = suitor_of_id_[partner];
    suitor_of_id_[partner] = id;
}

void ClusterIndex::search_anew(uint32_t id) {
    const uint32_t slot = slot_of_id_[id];
    searching_[slot / kWidth] |= static_cast<uint16_t>(1u << slot % kWidth);
    partner_of_id_[id] = kNobody;
}

// The union takes the place of its lower half. All who have lost their partners search anew.
void ClusterIndex::join(const Pair& pair) {
    const uint32_t slot = slot_of_id_[pair.low], free_slot = slot_of_id_[pair.high];
    leaf_of(slot).extend(slot % kWidth, leaf_of(free_slot), free_slot % kWidth);
    leaf_of(free_slot).clear(free_slot % kWidth);
    --cluster_count_;
    for (const uint32_t half : {pair.low, pair.high}) {
        for (uint32_t suitor = suitor_of_id_[half]; suitor != kNobody; suitor = next_suitor_[suitor]) {
            if (suitor != pair.low && suitor != pair.high) search_anew(suitor);
        }
        suitor_of_id_[half] = kNobody;
    }
    search_anew(pair.low);
}

// Once a quarter of the slots is empty, moves clusters into full groups, in the same order.
// Returns    whether it did.
bool ClusterIndex::close_gaps() {
    if (4 * uint64_t{cluster_count_} > 3 * uint64_t{slot_count_} || tree_.level_count == 1) return false;
    std::fill(searching_.begin(), searching_.end(), 0);
    uint32_t count = 0;
    for (uint32_t slot = 0; slot < slot_count_; ++slot) {
        const ClusterGroup& from = leaf_of(slot);
        if (from.is_empty(slot % kWidth)) continue;
        const uint32_t id = from.id(slot % kWidth);
        if (slot != count) leaf_of(count).copy(count % kWidth, from, slot % kWidth);
        slot_of_id_[id] = count++;
        if (partner_of_id_[id] == kNobody) search_anew(id);
    }
    slot_count_ = count;
    sum_up();
    return true;
}

}  // namespace zoe
