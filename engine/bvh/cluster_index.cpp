#include "engine/bvh/cluster_index.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace zoe {

namespace {

// The largest float that is not above x, for x >= 0.
float rounded_down(double x) {
    const float rounded = static_cast<float>(x);
    return double{rounded} > x ? std::bit_cast<float>(std::bit_cast<uint32_t>(rounded) - 1) : rounded;
}

glm::vec3 extent_rounded_down(const Aabb& box) {
    glm::vec3 extent;
    for (int axis = 0; axis < 3; ++axis) extent[axis] = rounded_down(double(box.hi[axis]) - box.lo[axis]);
    return extent;
}

// The least extent, along one axis, of the union of a box with a cluster that starts at max_lo or before, ends at min_hi or
// after, and is no smaller than min_extent.
double least_extent(float box_lo, float box_hi, float max_lo, float min_hi, float min_extent) {
    const double extent = double{std::max(box_hi, min_hi)} - double{std::min(box_lo, max_lo)};
    return std::max(extent, double{min_extent});
}

// Half the area of the least union of a box with anything under each lane of a group; where a lane is one cluster, exactly
// what Aabb::half_area gives. Never more than that for any cluster (lo, hi) under the lane, rounding included:
//     union.lo = min(box.lo, lo) <= min(box.lo, max_lo),    union.hi = max(box.hi, hi) >= max(box.hi, min_hi),
// without rounding; the float min_extent was rounded down, so it is at most double(hi) - lo <= double(union.hi) - union.lo;
// and differences, products and sums of numbers >= 0, each rounded once and in the order of Aabb::half_area, do not fall
// where their operands rise. An empty lane gives infinity: its extents all are, so 0 * infinity cannot arise.
template <typename Group, size_t kWidth>
std::array<double, kWidth> least_half_areas(const Aabb& box, const Group& group) {
    const auto extent = [&](int axis, size_t k) {
        return least_extent(box.lo[axis], box.hi[axis], group.max_lo[axis][k], group.min_hi[axis][k],
                            group.min_extent[axis][k]);
    };
    std::array<double, kWidth> areas;
    for (size_t k = 0; k < kWidth; ++k) {
        const double x = extent(0, k), y = extent(1, k), z = extent(2, k);
        areas[k] = x * y + y * z + z * x;
    }
    return areas;
}

}  // namespace

ClusterIndex::Summary ClusterIndex::Group::lane(uint32_t lane) const {
    Summary summary;
    for (int axis = 0; axis < 3; ++axis) {
        summary.max_lo[axis] = max_lo[axis][lane];
        summary.min_hi[axis] = min_hi[axis][lane];
        summary.min_extent[axis] = min_extent[axis][lane];
    }
    summary.min_id = min_id[lane];
    return summary;
}

void ClusterIndex::Group::set_lane(uint32_t lane, const Summary& summary) {
    for (int axis = 0; axis < 3; ++axis) {
        max_lo[axis][lane] = summary.max_lo[axis];
        min_hi[axis][lane] = summary.min_hi[axis];
        min_extent[axis][lane] = summary.min_extent[axis];
    }
    min_id[lane] = summary.min_id;
}

ClusterIndex::Summary ClusterIndex::Group::sum() const {
    Summary sum;
    for (uint32_t k = 0; k < kWidth; ++k) {
        const Summary summary = lane(k);
        sum.max_lo = glm::max(sum.max_lo, summary.max_lo);
        sum.min_hi = glm::min(sum.min_hi, summary.min_hi);
        sum.min_extent = glm::min(sum.min_extent, summary.min_extent);
        sum.min_id = std::min(sum.min_id, summary.min_id);
    }
    return sum;
}

void ClusterIndex::start(std::span<const Aabb> boxes) {
    assert(!boxes.empty() && boxes.size() <= (size_t{1} << 31));
    cluster_count_ = static_cast<uint32_t>(boxes.size());
    sorted_.clear();
    for (uint32_t k = 0; k < cluster_count_; ++k) {
        assert(boxes[k].is_proper());
        sorted_.push_back({boxes[k], k});
    }
    slot_of_id_.reserve(2 * boxes.size());
    slot_of_id_.resize(cluster_count_);
    partner_of_id_.reserve(2 * boxes.size());
    partner_of_id_.assign(cluster_count_, kNobody);
    rebuild();
}

Aabb ClusterIndex::bounds(uint32_t id) const {
    const uint32_t slot = slot_of_id_[id];
    const Summary cluster = groups_[slot / kWidth].lane(slot % kWidth);
    return {cluster.max_lo, cluster.min_hi};
}

// A tree over the clusters in sorted_: full groups, but for the last of each level.
void ClusterIndex::rebuild() {
    const size_t n = sorted_.size();
    rebuild_count_ = cluster_count_ / 2;
    level_count_ = 0;
    uint32_t end = 0;
    for (size_t count = n; level_count_ == 0 || count > 1;) {
        count = (count + kWidth - 1) / kWidth;
        level_begin_[level_count_++] = end;
        end += static_cast<uint32_t>(count);
    }
    level_begin_[level_count_] = end;
    groups_.resize(end);

    // From the root down, the clusters of each group of level k are divided into four times 4^k.
    for (uint32_t level = level_count_ - 1; level > 0; --level) {
        const size_t lane_size = size_t{1} << (2 * level);
        for (size_t begin = 0; begin < n; begin += 4 * lane_size) {
            split(begin, begin + 2 * lane_size, begin + 4 * lane_size);
            split(begin, begin + lane_size, begin + 2 * lane_size);
            split(begin + 2 * lane_size, begin + 3 * lane_size, begin + 4 * lane_size);
        }
    }

    for (uint32_t slot = 0; slot < kWidth * group_count(0); ++slot) {
        Summary summary;
        if (slot < n) {
            const auto& [box, id] = sorted_[slot];
            summary = {box.lo, box.hi, extent_rounded_down(box), id};
            slot_of_id_[id] = slot;
        }
        group(0, slot / kWidth).set_lane(slot % kWidth, summary);
    }
    for (uint32_t level = 1; level < level_count_; ++level) {
        for (uint32_t k = 0; k < kWidth * group_count(level); ++k) {
            const Summary summary = k < group_count(level - 1) ? group(level - 1, k).sum() : Summary{};
            group(level, k / kWidth).set_lane(k % kWidth, summary);
        }
    }
}

// Orders [begin, end) of sorted_ about `middle`, along what varies most: a coordinate of the centres or, where boxes differ
// in size rather than in place, of the half extents. Equal ones are divided by id, which is what ties are pruned by.
void ClusterIndex::split(size_t begin, size_t middle, size_t end) {
    end = std::min(end, sorted_.size());
    if (middle >= end) return;
    Aabb centres, half_extents;
    for (size_t k = begin; k < end; ++k) {
        const Aabb& box = sorted_[k].bounds;
        centres.extend(0.5f * box.hi + 0.5f * box.lo);
        half_extents.extend(0.5f * box.hi - 0.5f * box.lo);
    }
    int best_axis = 0;
    float lo_factor = 0.5f, widest = centres.extent()[0];
    for (int axis = 0; axis < 3; ++axis) {
        for (const float factor : {0.5f, -0.5f}) {
            const float width = (factor > 0.0f ? centres : half_extents).extent()[axis];
            if (!(width > widest)) continue;
            widest = width;
            best_axis = axis;
            lo_factor = factor;
        }
    }
    const auto at = [this](size_t k) { return sorted_.begin() + static_cast<ptrdiff_t>(k); };
    std::nth_element(at(begin), at(middle), at(end), [best_axis, lo_factor](const Cluster& a, const Cluster& b) {
        const float x = 0.5f * a.bounds.hi[best_axis] + lo_factor * a.bounds.lo[best_axis];
        const float y = 0.5f * b.bounds.hi[best_axis] + lo_factor * b.bounds.lo[best_axis];
        return x != y ? x < y : a.id < b.id;
    });
}

uint32_t ClusterIndex::merge(uint32_t a, uint32_t b) {
    const Aabb box = zoe::merge(bounds(a), bounds(b));
    const auto id = static_cast<uint32_t>(slot_of_id_.size());
    const uint32_t slot = slot_of_id_[a], free_slot = slot_of_id_[b];
    slot_of_id_[a] = slot_of_id_[b] = kNobody;
    slot_of_id_.push_back(slot);
    partner_of_id_.push_back(kNobody);
    group(0, slot / kWidth).set_lane(slot % kWidth, {box.lo, box.hi, extent_rounded_down(box), id});
    group(0, free_slot / kWidth).set_lane(free_slot % kWidth, {});
    --cluster_count_;
    if (cluster_count_ > rebuild_count_ || level_count_ == 1) {
        refit(slot);
        refit(free_slot);
        return id;
    }
    sorted_.clear();
    for (uint32_t k = 0; k < kWidth * group_count(0); ++k) {
        const Summary cluster = group(0, k / kWidth).lane(k % kWidth);
        if (cluster.min_id != kNobody) sorted_.push_back({{cluster.max_lo, cluster.min_hi}, cluster.min_id});
    }
    rebuild();
    return id;
}

// Sums up anew what is above a slot, until nothing changes.
void ClusterIndex::refit(uint32_t slot) {
    for (uint32_t level = 1, k = slot / kWidth; level < level_count_; ++level, k /= kWidth) {
        const Summary summary = group(level - 1, k).sum();
        Group& above = group(level, k / kWidth);
        if (above.lane(k % kWidth) == summary) return;
        above.set_lane(k % kWidth, summary);
    }
}

uint32_t ClusterIndex::best_partner(uint32_t id, uint32_t guess) {
    assert(cluster_count_ > 1);
    // The last answer holds for as long as that partner lives: whatever was made since contains something that was there, so
    // its union with this cluster is no smaller, and where equal, its higher id loses.
    uint32_t& known = partner_of_id_[id];
    if (known != kNobody && slot_of_id_[known] != kNobody) return known;

    Search search;
    search.cluster = {bounds(id), id};
    search.best = {std::numeric_limits<double>::infinity(), 0, 0};
    search.partner = kNobody;
    search.open_count = 0;
    if (guess != kNobody) {
        search.best = {zoe::merge(search.cluster.bounds, bounds(guess)).half_area(), std::min(id, guess),
                       std::max(id, guess)};
        search.partner = guess;
    }
    // From the cluster up to the root, so that near ones come first and leave little to be looked into of the rest.
    uint32_t place = slot_of_id_[id];
    for (uint32_t level = 0; level < level_count_; ++level, place /= kWidth) {
        look_into(level, place / kWidth, place % kWidth, &search);
        while (search.open_count > 0) {
            const OpenGroup next = search.open[--search.open_count];
            if (next.least < search.best) look_into(next.level, next.group, kWidth, &search);
        }
    }
    known = search.partner;
    return known;
}

// Compares with each lane: clusters may become the best, groups may become open, the best on top.
void ClusterIndex::look_into(uint32_t level, uint32_t group_index, uint32_t skipped_lane, Search* search) {
    const Group& here = group(level, group_index);
    const uint32_t id = search->cluster.id, base = search->open_count;
    const std::array<double, kWidth> areas = least_half_areas<Group, kWidth>(search->cluster.bounds, here);
    for (uint32_t k = 0; k < kWidth; ++k) {
        if (k == skipped_lane || areas[k] > search->best.half_area) continue;
        // Of equal areas: the pair with the lowest id of the lane is the least, on whichever side of `id` it is.
        const Key key{areas[k], std::min(id, here.min_id[k]), std::max(id, here.min_id[k])};
        if (!(key < search->best)) continue;
        if (level == 0) {
            search->best = key;
            search->partner = here.min_id[k];
            continue;
        }
        uint32_t at = search->open_count++;
        for (; at > base && search->open[at - 1].least < key; --at) search->open[at] = search->open[at - 1];
        search->open[at] = {key, level - 1, kWidth * group_index + k};
    }
}

}  // namespace zoe
