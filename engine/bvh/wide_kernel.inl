// The SIMD kernel of nodes: one ray against eight boxes. Compiled once an instruction set, by the file that includes it.
//
// Why every hit is that of `intersect` over all triangles, bit for bit, whatever the tree and the instruction set:
// - A triangle's t is at least `entry` of its own box, a formula of its own that no kernel changes (it is evaluated here by
//   the same operations in the same order), and `entry` is monotone in nesting.
// - The test of a node's boxes only decides what is not looked at. It is conservative: it passes every box whose `entry`
//   is at most the closest t so far, being padded more than `entry` is. So nothing is culled that could be, or tie with,
//   the closest hit.
// - The triangle kernel does the operations of `intersect`, lane by lane, without fused ones: those in float for a whole
//   block, which leaves few triangles; for these the operations of `intersect_plane`, or that function itself.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using BoxTag = hn::CappedTag<float, kWidth>;
using BoxBits = hn::RebindToUnsigned<BoxTag>;
using BoxInts = hn::RebindToSigned<BoxTag>;
constexpr size_t kLanes = HWY_MAX_BYTES >= 32 ? 8 : 4;
using BlockTag = hn::FixedTag<float, TriangleBlock::kSize>;

// The lowest bits of a stack key hold the child's slot; what is left of t is at most 7 ulp nearer, never farther.
constexpr uint32_t kSlotMask = kWidth - 1, kKeyMask = 0x7fffffffu & ~kSlotMask;

// The same in registers, for the box tests.
struct BoxRay {
    // is_in_top  whether the nodes are the top level's, whose boxes may be tight.
    HWY_INLINE BoxRay(const Space& space, bool is_in_top) {
        const BoxTag d;
        const float *first = is_in_top ? space.first : space.origin, *last = is_in_top ? space.last : space.origin;
        first_x = hn::Set(d, first[0]), first_y = hn::Set(d, first[1]), first_z = hn::Set(d, first[2]);
        last_x = hn::Set(d, last[0]), last_y = hn::Set(d, last[1]), last_z = hn::Set(d, last[2]);
        near_x = hn::Set(d, space.inverse[0]), near_y = hn::Set(d, space.inverse[1]), near_z = hn::Set(d, space.inverse[2]);
        far_x = hn::Set(d, space.far_inverse[0]), far_y = hn::Set(d, space.far_inverse[1]),
        far_z = hn::Set(d, space.far_inverse[2]);
        row_x = space.near_row[0], row_y = space.near_row[1], row_z = space.near_row[2];
    }

    hn::Vec<BoxTag> first_x, first_y, first_z, last_x, last_y, last_z, near_x, near_y, near_z, far_x, far_y, far_z;
    size_t row_x, row_y, row_z;
};

// Tests lanes [lane, lane + kLanes) of a node's boxes: which are entered, and where.
struct Entered {
    hn::Mask<BoxTag> mask;
    hn::Vec<BoxTag> t;
};
HWY_INLINE Entered test_boxes(const WideNode& node, const BoxRay& ray, hn::Vec<BoxTag> limit, size_t lane) {
    const BoxTag d;
    const float* planes = &node.planes[0][0] + lane;
    const auto near_x = hn::Mul(hn::Sub(hn::Load(d, planes + ray.row_x), ray.first_x), ray.near_x);
    const auto near_y = hn::Mul(hn::Sub(hn::Load(d, planes + ray.row_y), ray.first_y), ray.near_y);
    const auto near_z = hn::Mul(hn::Sub(hn::Load(d, planes + ray.row_z), ray.first_z), ray.near_z);
    const auto far_x = hn::Mul(hn::Sub(hn::Load(d, planes + (ray.row_x ^ kWidth)), ray.last_x), ray.far_x);
    const auto far_y = hn::Mul(hn::Sub(hn::Load(d, planes + (ray.row_y ^ kWidth)), ray.last_y), ray.far_y);
    const auto far_z = hn::Mul(hn::Sub(hn::Load(d, planes + (ray.row_z ^ kWidth)), ray.last_z), ray.far_z);
    // A distance is the first operand: where it is NaN, the slab does not limit.
    const auto in = larger(near_z, larger(near_y, larger(near_x, hn::Zero(d))));
    const auto out = smaller(far_z, smaller(far_y, smaller(far_x, limit)));
    return {hn::Le(in, out), in};
}

// Entries to come, nearest last: `keys` hold the entry's distance.
struct Stack {
    uint32_t* keys;
    uint32_t* children;
    size_t size = 0;
};

#if HWY_MAX_BYTES >= 32

// A layer of a sorting network on eight lanes: each lane meets its partner, `keeps_larger` says who keeps which.
HWY_INLINE hn::Vec<BoxInts> meet(hn::Vec<BoxInts> v, hn::Vec<BoxInts> partner, const uint32_t* keeps_larger) {
    const BoxInts d;
    const auto mask = hn::MaskFromVec(hn::BitCast(d, hn::Load(BoxBits(), keeps_larger)));
    return hn::IfThenElse(mask, hn::Max(v, partner), hn::Min(v, partner));
}

// Descending, by Batcher's bitonic network.
HWY_INLINE hn::Vec<BoxInts> sort_descending(hn::Vec<BoxInts> v) {
    constexpr uint32_t kAll = 0xffffffffu;
    alignas(32) static constexpr uint32_t kByOne[8] = {kAll, 0, kAll, 0, kAll, 0, kAll, 0};
    alignas(32) static constexpr uint32_t kByTwo[8] = {kAll, kAll, 0, 0, kAll, kAll, 0, 0};
    alignas(32) static constexpr uint32_t kByFour[8] = {kAll, kAll, kAll, kAll, 0, 0, 0, 0};
    v = meet(v, hn::Shuffle2301(v), kByOne);
    v = meet(v, hn::Shuffle0123(v), kByTwo);
    v = meet(v, hn::Shuffle2301(v), kByOne);
    v = meet(v, hn::Reverse(BoxInts(), v), kByFour);
    v = meet(v, hn::Shuffle1032(v), kByTwo);
    return meet(v, hn::Shuffle2301(v), kByOne);
}

// Gives the nearest of the children that are entered back and pushes the others, farthest first.
HWY_INLINE uint32_t push_sorted(const WideNode& node, const Entered& entered, uint32_t mask, Stack* stack) {
    const BoxBits bits;
    const BoxInts ints;
    const auto keys =
        hn::BitCast(ints, hn::Or(hn::And(hn::BitCast(bits, entered.t), hn::Set(bits, kKeyMask)), hn::Iota(bits, 0)));
    const auto is_entered = hn::RebindMask(ints, entered.mask);
    // The ray goes on to the nearest: not a cycle later than it must, so that is found by itself.
    auto least = hn::IfThenElse(is_entered, keys, hn::Set(ints, 0x7fffffff));
    least = hn::Min(least, hn::Shuffle2301(least));
    least = hn::Min(least, hn::Shuffle1032(least));
    least = hn::Min(least, hn::ConcatLowerUpper(ints, least, least));
    const uint32_t nearest = node.child[static_cast<uint32_t>(hn::GetLane(least)) & kSlotMask];
    // What is not entered sorts behind all keys, and so above the new top of the stack; the nearest lies on it.
    const auto sorted = sort_descending(hn::IfThenElse(is_entered, keys, hn::Set(ints, -1)));
    const auto slots = hn::And(hn::BitCast(bits, sorted), hn::Set(bits, kSlotMask));
    const auto children = hn::TableLookupLanes(hn::Load(bits, node.child), hn::IndicesFromVec(bits, slots));
    hn::StoreU(hn::BitCast(bits, sorted), bits, stack->keys + stack->size);
    hn::StoreU(children, bits, stack->children + stack->size);
    stack->size += std::popcount(mask) - 1;
    return nearest;
}

#endif

// Tests a node's boxes. The nearest child that is entered (any of them for `kIsAny`) is given back, the others are pushed,
// farthest first. Returns false where there is none.
// ray        anything that `test_boxes` takes.
template <bool kIsAny, class Tested>
HWY_INLINE bool next_child(const WideNode& node, const Tested& ray, float limit, Stack* stack, uint32_t* child) {
    const BoxTag d;
    const BoxBits bits;
#if HWY_MAX_BYTES >= 32
    const Entered entered = test_boxes(node, ray, hn::Set(d, limit), 0);
    uint8_t mask_bits[8];
    hn::StoreMaskBits(d, entered.mask, mask_bits);
    const uint32_t mask = mask_bits[0];
    if (mask == 0) return false;
    if (kIsAny) {
        // The last one is given back, and lands where the next one is pushed.
        *child = node.child[31 - std::countl_zero(mask)];
        if ((mask & (mask - 1)) == 0) return true;
#if HWY_TARGET <= HWY_AVX3
        hn::StoreU(hn::Compress(hn::Load(bits, node.child), hn::RebindMask(bits, entered.mask)), bits,
                   stack->children + stack->size);
        stack->size += std::popcount(mask) - 1;
#else
        // Compressing takes older processors longer than these few.
        for (uint32_t rest = mask; (rest & (rest - 1)) != 0; rest &= rest - 1)
            stack->children[stack->size++] = node.child[std::countr_zero(rest)];
#endif
        return true;
    }
    const uint32_t first = static_cast<uint32_t>(std::countr_zero(mask)), rest = mask & (mask - 1);
    if (rest == 0) {
        *child = node.child[first];
        return true;
    }
    if ((rest & (rest - 1)) == 0) {
        const uint32_t second = static_cast<uint32_t>(std::countr_zero(rest));
        HWY_ALIGN uint32_t t[kWidth];
        hn::Store(hn::BitCast(bits, entered.t), bits, t);
        // A branch, not a choice of values: where it is foreseen, the next node is on its way before t is known.
        if (t[first] <= t[second]) {
            stack->keys[stack->size] = t[second];
            stack->children[stack->size++] = node.child[second];
            *child = node.child[first];
        } else {
            stack->keys[stack->size] = t[first];
            stack->children[stack->size++] = node.child[first];
            *child = node.child[second];
        }
        return true;
    }
    *child = push_sorted(node, entered, mask, stack);
    return true;
#else
    HWY_ALIGN uint32_t keys[kWidth];
    uint32_t mask = 0;
    for (size_t lane = 0; lane < kWidth; lane += kLanes) {
        const Entered entered = test_boxes(node, ray, hn::Set(d, limit), lane);
        uint8_t mask_bits[8];
        hn::StoreMaskBits(d, entered.mask, mask_bits);
        mask |= (mask_bits[0] & 15u) << lane;
        hn::Store(hn::And(hn::BitCast(bits, entered.t), hn::Set(bits, kKeyMask)), bits, keys + lane);
    }
    if (mask == 0) return false;
    const size_t bottom = stack->size;
    for (; mask != 0; mask &= mask - 1) {
        const auto slot = static_cast<uint32_t>(std::countr_zero(mask));
        size_t at = stack->size++;
        if (!kIsAny) {
            for (; at > bottom && stack->keys[at - 1] < keys[slot]; --at) {
                stack->keys[at] = stack->keys[at - 1];
                stack->children[at] = stack->children[at - 1];
            }
        }
        stack->keys[at] = keys[slot];
        stack->children[at] = node.child[slot];
    }
    *child = stack->children[--stack->size];
    return true;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
