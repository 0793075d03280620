#include "engine/bvh/build_sbvh.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "engine/bvh/assemble.h"
#include "engine/bvh/sbvh_split.h"
#include "engine/bvh/small_stack.h"
#include "engine/math/parallel.h"

namespace zoe {

namespace {

constexpr uint32_t kSubtreeSize = 8192;  // Subtrees of at most this many references are built by one thread each.

// A node in the making: references [begin, begin + count), with room for copies up to begin + capacity. What is between the
// count and the capacity is the node's share of the budget.
struct Range {
    uint32_t node, begin, count, capacity;
};

class Builder {
public:
    Builder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, const SbvhConfig& config)
        : positions_(positions),
          corners_(corners),
          config_(config),
          block_shift_(std::countr_zero(static_cast<uint32_t>(config.block_size))) {
        const auto count = static_cast<uint32_t>(corners.size());
        const double capacity = std::max(1.0, double(config.max_reference_growth)) * count;
        references_.resize(static_cast<size_t>(std::min(capacity, double(0xffffffffu))));
        parallel_for(0, count, kSubtreeSize, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) references_[k] = whole(static_cast<uint32_t>(k));
        });
    }

    Bvh build() {
        const auto count = static_cast<uint32_t>(corners_.size());
        const Range root{0, 0, count, static_cast<uint32_t>(references_.size())};
        root_area_ = bounds_of(root).half_area();
        TreeParts parts;
        parts.top.resize(1);
        std::vector<Range> ranges;
        {
            SplitScratch scratch;
            grow(root, kSubtreeSize, &parts.top, &ranges, &scratch);
        }
        parts.subtree_of_top.assign(parts.top.size(), TreeParts::kNone);
        for (size_t k = 0; k < ranges.size(); ++k) parts.subtree_of_top[ranges[k].node] = static_cast<uint32_t>(k);
        parts.subtrees.resize(ranges.size());
        parallel_for(0, ranges.size(), 1, [&](size_t k, size_t) {
            SplitScratch scratch;
            Range range = ranges[k];
            range.node = 0;
            std::vector<BvhNode> nodes(1);
            grow(range, 0, &nodes, nullptr, &scratch);
            parts.subtrees[k].assign(nodes.begin(), nodes.end());  // No larger than it is.
        });
        Bvh bvh;
        bvh.nodes = assemble(&parts);
        close_gaps(&bvh);
        fit_boxes(&bvh);
        return bvh;
    }

private:
    Triangle triangle(uint32_t primitive) const {
        const glm::uvec3& c = corners_[primitive];
        return {positions_[c.x], positions_[c.y], positions_[c.z], primitive};
    }
    Reference whole(uint32_t primitive) const {
        const Triangle t = triangle(primitive);
        const bool is_bounded = is_finite(t.a) && is_finite(t.b) && is_finite(t.c);
        return {is_bounded ? bounds(t) : Aabb{}, primitive, false};
    }
    std::span<Reference> of(const Range& range) { return std::span(references_).subspan(range.begin, range.count); }
    Aabb bounds_of(const Range& range) {
        Aabb bounds;
        for (const Reference& reference : of(range)) bounds.extend(reference.box);
        return bounds;
    }

    // Splits until ranges are leaves, or (where `small` is given) have at most `small_size` references.
    void grow(const Range& root, uint32_t small_size, std::vector<BvhNode>* nodes, std::vector<Range>* small,
              SplitScratch* scratch) {
        SmallStack<Range, 64> open;
        open.push(root);
        while (!open.is_empty()) {
            const Range range = open.pop();
            if (small && range.count <= small_size) {
                small->push_back(range);
                continue;
            }
            const Aabb bounds = bounds_of(range);
            (*nodes)[range.node] = {bounds.lo, range.begin, bounds.hi, range.count};
            Range left, right;
            if (!split(range, bounds, scratch, &left, &right)) continue;
            left.node = static_cast<uint32_t>(nodes->size());
            right.node = left.node + 1;
            nodes->resize(nodes->size() + 2);
            (*nodes)[range.node].first = left.node;
            (*nodes)[range.node].count = 0;
            open.push(right);
            open.push(left);
        }
    }

    // Returns false for a leaf; else puts the references of both sides where their ranges say.
    bool split(const Range& range, const Aabb& bounds, SplitScratch* scratch, Range* left, Range* right) {
        if (range.count <= static_cast<uint32_t>(std::min(config_.block_size, config_.max_leaf_size))) return false;
        const ObjectSplit object = best_object_split(of(range), block_shift_, scratch);
        SpatialSplit spatial;
        const Aabb overlap{glm::max(object.left.lo, object.right.lo), glm::min(object.left.hi, object.right.hi)};
        if (range.capacity > range.count && overlap.half_area() > config_.min_overlap * root_area_) {
            // A few references need few planes.
            const int bin_count = std::min(config_.bin_count, static_cast<int>(std::min(8 + range.count / 4, 64u)));
            spatial = best_spatial_split(of(range), bounds, positions_, corners_, bin_count, block_shift_);
        }
        const double area = bounds.half_area(), cost = std::min(object.cost, spatial.cost);
        if (range.count <= static_cast<uint32_t>(config_.max_leaf_size) &&
            config_.node_cost * area + cost >= area * (((range.count - 1) >> block_shift_) + 1)) {
            return false;
        }
        if (range.count > kSubtreeSize) release_search(scratch);
        uint32_t left_count = spatial.cost < object.cost ? part(range, spatial, scratch) : 0;
        // With one side empty all stand where they stood.
        if (left_count == 0 || scratch->right.empty()) left_count = part(range, object, scratch);
        place(range, left_count, *scratch, left, right);
        return true;
    }

    // A large node's search needs memory that is as large; what it leaves is needed no more.
    static void release_search(SplitScratch* scratch) {
        for (std::vector<double>& areas : scratch->right_areas) std::vector<double>().swap(areas);
        std::vector<uint64_t>().swap(scratch->keys[1]);
        std::vector<uint64_t>().swap(scratch->keys[2]);
    }

    // Puts the left side where the range begins, and the right one into scratch->right. Returns how many are left.
    uint32_t part(const Range& range, const ObjectSplit& split, SplitScratch* scratch) {
        scratch->right.clear();
        scratch->right.reserve(range.count - split.position);
        const std::vector<uint64_t>& order = scratch->orders[split.axis];
        // In the order that they stand in: whatever was near in memory stays so.
        std::vector<uint64_t>& is_left = scratch->keys[0];
        is_left.assign(range.count, 0);
        for (uint32_t k = 0; k < split.position; ++k) is_left[static_cast<uint32_t>(order[k])] = 1;
        const std::span<Reference> references = of(range);
        uint32_t left_count = 0;
        for (uint32_t k = 0; k < range.count; ++k) {
            if (is_left[k]) {
                references[left_count++] = references[k];
            } else {
                scratch->right.push_back(references[k]);
            }
        }
        return left_count;
    }

    // Cuts what crosses the plane, but for what costs less whole on one side.
    uint32_t part(const Range& range, SpatialSplit split, SplitScratch* scratch) {
        scratch->right.clear();
        scratch->right.reserve(std::min(split.right_count, range.count));
        const int axis = split.axis;
        uint32_t copies_left = range.capacity - range.count;
        const std::span<Reference> references = of(range);
        uint32_t left_count = 0;
        const auto put_left = [&](const Reference& reference) { references[left_count++] = reference; };
        for (uint32_t k = 0; k < range.count; ++k) {
            const Reference reference = references[k];
            if (reference.box.hi[axis] <= split.plane) {
                put_left(reference);
                continue;
            }
            if (reference.box.lo[axis] >= split.plane) {
                scratch->right.push_back(reference);
                continue;
            }
            const ClippedBoxes pieces = split_box(triangle(reference.primitive), reference.box, axis, split.plane);
            const Aabb left_whole = merge(split.left, reference.box), right_whole = merge(split.right, reference.box);
            const double left_area = split.left.half_area(), right_area = split.right.half_area();
            const double cut_cost = left_area * split.left_count + right_area * split.right_count;
            const double left_cost = left_whole.half_area() * split.left_count + right_area * (split.right_count - 1.0);
            const double right_cost = left_area * (split.left_count - 1.0) + right_whole.half_area() * split.right_count;
            const bool may_cut = copies_left > 0 && !pieces.left.is_empty() && !pieces.right.is_empty();
            if (may_cut && cut_cost < std::min(left_cost, right_cost)) {
                --copies_left;
                put_left({pieces.left, reference.primitive, true});
                scratch->right.push_back({pieces.right, reference.primitive, true});
            } else if (left_cost <= right_cost) {
                put_left(reference);
                split.left = left_whole;
                if (split.right_count > 0) --split.right_count;
            } else {
                scratch->right.push_back(reference);
                split.right = right_whole;
                if (split.left_count > 0) --split.left_count;
            }
        }
        return left_count;
    }

    // The rest of the budget goes where rays will spend more: by area times count.
    void place(const Range& range, uint32_t left_count, const SplitScratch& scratch, Range* left, Range* right) {
        const auto right_count = static_cast<uint32_t>(scratch.right.size());
        assert(uint64_t(left_count) + right_count <= range.capacity);
        const uint32_t rest = range.capacity - left_count - right_count;
        Aabb left_bounds, right_bounds;
        for (const Reference& reference : of(range).first(left_count)) left_bounds.extend(reference.box);
        for (const Reference& reference : scratch.right) right_bounds.extend(reference.box);
        const double left_weight = left_bounds.half_area() * left_count,
                     right_weight = right_bounds.half_area() * right_count;
        const double weight = left_weight + right_weight;
        const double share = weight > 0.0 && left_weight < weight ? left_weight / weight : 0.5;
        const uint32_t left_capacity = left_count + std::min(rest, static_cast<uint32_t>(share * rest));
        *left = {0, range.begin, left_count, left_capacity};
        *right = {0, range.begin + left_capacity, right_count, range.capacity - left_capacity};
        std::copy(scratch.right.begin(), scratch.right.end(), references_.begin() + right->begin);
    }

    // Leaves stand one after another, in the order of the nodes, references with them.
    void close_gaps(Bvh* bvh) {
        size_t count = 0;
        for (const BvhNode& node : bvh->nodes) count += node.count;
        std::vector<Reference> kept;
        kept.reserve(count);
        for (BvhNode& node : bvh->nodes) {
            if (!node.is_leaf()) continue;
            const uint32_t begin = node.first;
            node.first = static_cast<uint32_t>(kept.size());
            for (uint32_t k = 0; k < node.count; ++k) kept.push_back(references_[begin + k]);
        }
        references_ = std::move(kept);
        bvh->primitives.resize(count);
        for (size_t k = 0; k < count; ++k) bvh->primitives[k] = references_[k].primitive;
    }

    // From the back, so that children come first. Boxes of pieces are widened here only: until now they are exact.
    void fit_boxes(Bvh* bvh) const {
        for (size_t k = bvh->nodes.size(); k-- > 0;) {
            BvhNode& node = bvh->nodes[k];
            Aabb bounds;
            if (node.is_leaf()) {
                for (uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
                    const Reference& reference = references_[slot];
                    bounds.extend(reference.is_piece ? padded(reference.box, triangle(reference.primitive)) : reference.box);
                }
            } else {
                bounds = merge(bvh->nodes[node.first].bounds(), bvh->nodes[node.first + 1].bounds());
            }
            node.lo = bounds.lo;
            node.hi = bounds.hi;
        }
    }

    std::span<const glm::vec3> positions_;
    std::span<const glm::uvec3> corners_;
    const SbvhConfig& config_;
    int block_shift_;
    std::vector<Reference> references_;
    double root_area_ = 0.0;
};

}  // namespace

StaticBvh build_sbvh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> corners, const SbvhConfig& config) {
    assert(std::has_single_bit(static_cast<uint32_t>(config.block_size)));
    assert(config.bin_count >= 2 && config.bin_count <= 64);
    if (corners.empty()) return {};
    return {Builder(positions, corners, config).build(), static_cast<uint32_t>(corners.size())};
}

}  // namespace zoe
