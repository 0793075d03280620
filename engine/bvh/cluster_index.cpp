#include "engine/bvh/cluster_index.h"

#include <algorithm>
#include <cassert>

#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr uint32_t kWidth = ClusterGroup::kWidth;
constexpr size_t kGrain = 128;       // Slots that one thread looks for partners of.
constexpr size_t kSplitGrain = 512;  // Clusters that one thread puts in order.

}  // namespace

ClusterIndex::Item ClusterIndex::item(const Aabb& box, uint32_t id) {
    const glm::vec3 centre = 0.5f * box.hi + 0.5f * box.lo, half = 0.5f * box.hi - 0.5f * box.lo;
    return {{centre.x, centre.y, centre.z, half.x, half.y, half.z}, id};
}

void ClusterIndex::start(std::span<const Aabb> boxes) {
    assert(!boxes.empty() && boxes.size() <= (size_t{1} << 31));
    cluster_count_ = slot_count_ = static_cast<uint32_t>(boxes.size());
    for (const Aabb& box : boxes) assert(box.is_proper());
    box_of_id_.reserve(2 * boxes.size());
    box_of_id_.assign(boxes.begin(), boxes.end());
    slot_of_id_.reserve(2 * boxes.size());
    slot_of_id_.resize(cluster_count_);
    partner_of_id_.reserve(2 * boxes.size());
    partner_of_id_.assign(cluster_count_, kNobody);

    size_t count = boxes.size();
    for (uint32_t level = 0; level == 0 || count > 1; ++level) {
        count = (count + kWidth - 1) / kWidth;
        if (levels_[level].size() < count) levels_[level].resize(count);
        tree_.levels[level] = levels_[level].data();
    }
    items_.clear();
    for (uint32_t id = 0; id < cluster_count_; ++id) items_.push_back(item(boxes[id], id));
    rebuild();
}

// A tree over the clusters in items_: full groups, but for the last of each level.
void ClusterIndex::rebuild() {
    size_t size = kWidth;
    while (size < items_.size()) size *= 2;
    for (; size > kWidth; size /= 2) {
        parallel_for(0, items_.size(), std::max(size, kSplitGrain), [&](size_t from, size_t to) {
            for (size_t begin = from; begin < to; begin += size) split(begin, begin + size / 2, begin + size);
        });
    }
    slot_count_ = 0;
    for (const Item& item : items_) {
        tree_.levels[0][slot_count_ / kWidth].set(slot_count_ % kWidth, box_of_id_[item.id], item.id);
        slot_of_id_[item.id] = slot_count_++;
    }
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
    rebuild_count_ = cluster_count_ / 2;
    for (uint32_t slot = slot_count_; slot % kWidth != 0; ++slot) tree_.levels[0][slot / kWidth].clear(slot % kWidth);
    tree_.level_count = 0;
    for (uint32_t count = slot_count_; tree_.level_count == 0 || count > 1; ++tree_.level_count) {
        count = (count + kWidth - 1) / kWidth;
    }
    sum_up_clusters(tree_, slot_count_);
}

uint32_t ClusterIndex::join(uint32_t a, uint32_t b) {
    const Aabb box = zoe::merge(bounds(a), bounds(b));
    const auto id = static_cast<uint32_t>(slot_of_id_.size());
    const uint32_t slot = slot_of_id_[a], free_slot = slot_of_id_[b];
    slot_of_id_[a] = slot_of_id_[b] = kNobody;
    partner_of_id_[a] = partner_of_id_[b] = id;
    slot_of_id_.push_back(slot);
    box_of_id_.push_back(box);
    partner_of_id_.push_back(kNobody);
    tree_.levels[0][slot / kWidth].set(slot % kWidth, box, id);
    tree_.levels[0][free_slot / kWidth].clear(free_slot % kWidth);
    --cluster_count_;
    return id;
}

uint32_t ClusterIndex::merge(uint32_t a, uint32_t b) {
    const uint32_t slot = slot_of_id_[a], free_slot = slot_of_id_[b], id = join(a, b);
    if (is_sparse()) {
        move_together();
    } else {
        refit_clusters(tree_, slot);
        refit_clusters(tree_, free_slot);
    }
    return id;
}

void ClusterIndex::merge(std::span<const Pair> pairs) {
    for (const Pair& pair : pairs) join(pair.a, pair.b);
    if (is_sparse()) {
        move_together();
    } else {
        sum_up_clusters(tree_, slot_count_);
    }
}

void ClusterIndex::move_together() {
    items_.clear();
    for (uint32_t slot = 0; slot < slot_count_; ++slot) {
        const uint32_t id = tree_.levels[0][slot / kWidth].min_id[slot % kWidth];
        if (id != kNobody) items_.push_back(item(box_of_id_[id], id));
    }
    rebuild();
}

uint32_t ClusterIndex::best_partner(uint32_t id, uint32_t guess) {
    assert(cluster_count_ > 1);
    if (!has_partner(id)) find_partner(id, guess);
    return partner_of_id_[id];
}

void ClusterIndex::find_partner(uint32_t id, uint32_t guess) {
    // Most often a cluster loses its partner to a third one, and likes the two of them together best.
    const uint32_t last = partner_of_id_[id];
    if (guess == kNobody && last != kNobody && is_there(partner_of_id_[last])) guess = partner_of_id_[last];
    const uint32_t slot = slot_of_id_[id];
    const Aabb box = tree_.levels[0][slot / kWidth].box(slot % kWidth);  // It is looked at next; bounds(id) is far away.
    Partner partner;
    if (guess != kNobody) partner = {zoe::merge(box, bounds(guess)).half_area(), guess};
    partner_of_id_[id] = search_clusters(tree_, box, slot, partner).id;
}

void ClusterIndex::find_partners() {
    assert(cluster_count_ > 1);
    parallel_for(0, slot_count_, kGrain, [&](size_t begin, size_t end) {
        for (size_t slot = begin; slot < end; ++slot) {
            const uint32_t id = tree_.levels[0][slot / kWidth].min_id[slot % kWidth];
            if (id != kNobody && !has_partner(id)) find_partner(id, kNobody);
        }
    });
}

}  // namespace zoe
