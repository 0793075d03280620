// A stream of rays, through both levels together, wherever they go: a node is read once for all rays that enter it, and
// tested with one after the other. A single ray waits at every node for the last one's answer, and for memory; here there is
// always another ray's test to go on with, and what comes next is known and asked for. Compiled once an instruction set, by
// the file that includes it.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// A bit for each ray.
using RaySet = uint64_t;
constexpr size_t kStreamSize = 64;

// A child to be visited by some of the rays.
struct StreamEntry {
    uint32_t child;
    uint32_t key;  // As in Stack: where the first of them enters it.
    RaySet rays;
};

struct Stream {
    explicit Stream(StreamEntry* memory) : stack(memory) {}

    void clear() {
        size = 0;
        looking = found = 0;
    }
    // slack      of TwoLevels.
    HWY_INLINE void add(const Ray& ray, float slack) {
        const size_t k = size++;
        const bool can_hit = world[k].set(ray) & (ray.t_min <= ray.t_max);
        world[k].widen(slack);
        hits[k] = {.t = ray.t_max};
        limit[k] = ray.t_max * kCullPad;
        t_min[k] = ray.t_min;
        looking |= RaySet{can_hit} << k;
    }

    StreamEntry* stack;
    size_t size = 0;
    RaySet looking = 0;  // Rays that look for a hit, or a closer one.
    RaySet found = 0;
    Space world[kStreamSize], local[kStreamSize];
    RawHit hits[kStreamSize];
    float limit[kStreamSize];  // As in Walk.
    float t_min[kStreamSize];
    float t_floor[kStreamSize];  // No hit in the instance is nearer; negative where nobody has asked yet.
};

// Pushes the children of a node that rays enter; for closest hits, nearest last, and of equally near ones the first. Returns
// the new end of the stack.
template <bool kIsAny, bool kIsInTop>
HWY_INLINE StreamEntry* push_children(const WideNode& node, const Space* spaces, const float* limit, RaySet rays,
                                      StreamEntry* end) {
    const BoxTag d;
    const hn::CappedTag<uint8_t, kStreamSize> bytes;
    // A byte for each ray, whose bits are the children that it enters.
    HWY_ALIGN uint8_t entered[kStreamSize];
    for (size_t k = 0; k < kStreamSize; k += hn::Lanes(bytes)) hn::Store(hn::Zero(bytes), bytes, entered + k);
    hn::Vec<BoxTag> nearest[kWidth / kLanes];
    for (auto& t : nearest) t = hn::Set(d, kInfinity);
    uint32_t entered_by_any = 0;
    for (; rays != 0; rays &= rays - 1) {
        const int k = std::countr_zero(rays);
        const BoxRay ray(spaces[k], kIsInTop);
        uint32_t bits = 0;
        for (size_t part = 0; part < kWidth / kLanes; ++part) {
            const Entered t = test_boxes(node, ray, hn::Set(d, limit[k]), part * kLanes);
            bits |= bits_of(d, t.mask) << (part * kLanes);
            if (!kIsAny) nearest[part] = smaller(hn::IfThenElse(t.mask, t.t, hn::Set(d, kInfinity)), nearest[part]);
        }
        entered[k] = static_cast<uint8_t>(bits);
        entered_by_any |= bits;
    }
    HWY_ALIGN uint32_t keys[kWidth];
    if (!kIsAny) {
        for (size_t part = 0; part < kWidth / kLanes; ++part)
            hn::Store(hn::BitCast(BoxBits(), nearest[part]), BoxBits(), keys + part * kLanes);
    }
    StreamEntry* const begin = end;
    for (; entered_by_any != 0; entered_by_any &= entered_by_any - 1) {
        const int slot = std::countr_zero(entered_by_any);
        RaySet entering = 0;
        for (size_t k = 0; k < kStreamSize; k += hn::Lanes(bytes)) {
            const auto is_in = hn::TestBit(hn::Load(bytes, entered + k), hn::Set(bytes, static_cast<uint8_t>(1u << slot)));
            uint8_t bits[8] = {};
            hn::StoreMaskBits(bytes, is_in, bits);
            RaySet some;
            std::memcpy(&some, bits, sizeof some);
            entering |= some << k;
        }
        StreamEntry* at = end++;
        if (!kIsAny) {
            for (; at != begin && at[-1].key <= keys[slot]; --at) *at = at[-1];
        }
        *at = {node.child[slot], kIsAny ? 0 : keys[slot], entering};
    }
    return end;
}

// Tests a leaf's triangles.
template <bool kIsAny>
HWY_INLINE void test_leaf(const PlacedBlas& placed, const Aabb& bounds, uint32_t child, const Space* spaces, RaySet rays,
                          Stream* stream, TraverseCounts* counts) {
    const TriangleBlock* const blocks = placed.blas->blocks.data();
    const TriangleBlock* block = blocks + first_block(child);
    for (const TriangleBlock* end = block + block_count(child); block != end; ++block) {
        if (kIsAny) rays &= stream->looking;
        counts->triangles += TriangleBlock::kSize * static_cast<uint64_t>(std::popcount(rays));
        for (RaySet rest = rays; rest != 0; rest &= rest - 1) {
            const int k = std::countr_zero(rest);
            RawHit& hit = stream->hits[k];
            const auto floor = [&]() HWY_ATTR {
                float& t = stream->t_floor[k];
                if (t < 0.0f) t = entry(stream->world[k], bounds, kInfinity);
                return t;
            };
            test_block(*block, spaces[k], floor, stream->t_min[k], hit.t,
                       [&](float t, float u, float v, uint32_t primitive) HWY_ATTR {
                           if (!is_closer(t, placed.id, primitive, hit)) return;
                           hit = {t, u, v, placed.id, primitive};
                           stream->limit[k] = t * kCullPad;
                           stream->found |= RaySet{1} << k;
                           if (kIsAny) stream->looking &= ~(RaySet{1} << k);
                       });
        }
    }
}

// Takes those of the rays that can hit anything in an instance into its space, and returns them. Where they enter its box is
// worked out by the first hit: most tests find none.
HWY_INLINE RaySet enter_instance(const PlacedBlas& placed, RaySet rays, Stream* stream) {
    if (placed.is_identity) {
        for (RaySet rest = rays; rest != 0; rest &= rest - 1) stream->t_floor[std::countr_zero(rest)] = 0.0f;
        return rays;
    }
    RaySet entered = 0;
    for (; rays != 0; rays &= rays - 1) {
        const int k = std::countr_zero(rays);
        stream->t_floor[k] = -1.0f;
        if (!transform(placed, stream->world[k], &stream->local[k])) continue;
        entered |= RaySet{1} << k;
    }
    return entered;
}

// Asks for the memory of what is visited next, or soon.
// leaves     what the tree's blocks are.
template <class Leaf>
HWY_INLINE void prefetch(const StreamEntry* bottom, const StreamEntry* end, const WideNode* nodes, const Leaf* leaves) {
    for (ptrdiff_t n = 1; n <= std::min<ptrdiff_t>(2, end - bottom); ++n) {
        const uint32_t child = end[-n].child;
        const void* what = nodes + child;
        if (is_leaf(child)) what = leaves + first_block(child);
        for (int line = 0; line < 4; ++line) __builtin_prefetch(static_cast<const std::byte*>(what) + 64 * line);
    }
}

// Takes rays through an instance, in whose space they are already.
// bottom     of what it may keep of the stack.
template <bool kIsAny>
HWY_INLINE void trace_instance(const PlacedBlas& placed, const Aabb& bounds, RaySet entered, Stream* stream,
                               StreamEntry* bottom, TraverseCounts* counts) {
    const WideNode* const nodes = placed.blas->tree.nodes.data();
    const TriangleBlock* const blocks = placed.blas->blocks.data();
    const Space* const spaces = placed.is_identity ? stream->world : stream->local;
    StreamEntry* end = bottom;
    *end++ = {placed.start, 0, entered};
    while (end != bottom) {
        --end;
        const uint32_t at = end->child;
        const RaySet rays = kIsAny ? end->rays & stream->looking : end->rays;
        if (kIsAny && rays == 0) continue;
        if (is_leaf(at)) {
            test_leaf<kIsAny>(placed, bounds, at, spaces, rays, stream, counts);
        } else {
            counts->nodes += static_cast<uint64_t>(std::popcount(rays));
            end = push_children<kIsAny, false>(nodes[at], spaces, stream->limit, rays, end);
            prefetch(bottom, end, nodes, blocks);
        }
    }
}

// Takes the stream's rays through the scene.
template <bool kIsAny>
void trace_stream(const TwoLevels& scene, Stream* stream, TraverseCounts* counts) {
    const WideNode* const nodes = scene.top->nodes.data();
    StreamEntry* const bottom = stream->stack;
    StreamEntry* end = bottom;
    *end++ = {0, 0, stream->looking};
    while (end != bottom) {
        --end;
        const uint32_t at = end->child;
        const RaySet rays = kIsAny ? end->rays & stream->looking : end->rays;
        if (kIsAny && rays == 0) continue;
        if (is_leaf(at)) {
            const PlacedBlas& placed = scene.instances[first_block(at)];
            const RaySet entered = enter_instance(placed, rays, stream);
            if (entered != 0) trace_instance<kIsAny>(placed, scene.bounds[first_block(at)], entered, stream, end, counts);
        } else {
            counts->nodes += static_cast<uint64_t>(std::popcount(rays));
            end = push_children<kIsAny, true>(nodes[at], stream->world, stream->limit, rays, end);
            prefetch(bottom, end, nodes, scene.instances);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
