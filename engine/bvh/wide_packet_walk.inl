// The way of sixteen coherent rays through both levels. Compiled once an instruction set, by the file that includes it.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// Those of a packet's rays that `which` has a bit for, in the space of an instance, as a stream, each from the hit that it
// has.
template <bool kIsAny>
HWY_INLINE void trace_apart(const PlacedBlas& placed, const Aabb& bounds, uint32_t which, Packet* packet, Stream* stream,
                            TraverseCounts* counts) {
    stream->clear();
    for (; which != 0; which &= which - 1) {
        const int k = std::countr_zero(which);
        stream->hits[k] = {packet->t[k], packet->u[k], packet->v[k], packet->id[k], packet->primitive[k]};
        stream->limit[k] = packet->t[k] * kCullPad;
        stream->t_min[k] = packet->t_min[k];
        stream->t_floor[k] = packet->t_floor[k];
        if (stream->local[k].set(packet->ray(k))) stream->looking |= RaySet{1} << k;
    }
    trace_instance<kIsAny>(placed, bounds, stream->looking, stream, stream->stack, counts);
    for (RaySet found = stream->found; found != 0; found &= found - 1) {
        const int k = std::countr_zero(found);
        const RawHit& hit = stream->hits[k];
        packet->t[k] = kIsAny ? -1.0f : hit.t;
        packet->u[k] = hit.u;
        packet->v[k] = hit.v;
        packet->id[k] = hit.id;
        packet->primitive[k] = hit.primitive;
    }
}

// A packet on its way.
template <bool kIsAny>
struct PacketWalk {
    Packet &world, &local;
    Stream* stream;  // For rays that are better not traced as a packet.
    TraverseCounts* counts;
    Packet* packet;  // In the space where the walk is.
    Stack stack;
    const WideNode* nodes;
    const TriangleBlock* blocks = nullptr;
    uint32_t id = 0;
    float limit = 0.0f;  // As in Walk, of the ray that sees farthest.
    uint32_t limit_key = 0;
    size_t leave_size = 0;  // Of the stack when all that is left is to leave this space.
    bool is_in_instance = false;

    void set_limit() {
        limit = farthest(*packet) * kCullPad;
        limit_key = std::bit_cast<uint32_t>(limit) | kSlotMask;
    }
    void enter_space(Packet* next, size_t size) {
        packet = next;
        leave_size = size;
        set_limit();
    }
};

// Returns false where the packet does not go on from the root of the instance's tree.
template <bool kIsAny>
HWY_INLINE bool enter_instance(PacketWalk<kIsAny>& walk, const PlacedBlas& placed, const Aabb& bounds) {
    Stack& stack = walk.stack;
    if (!placed.is_identity) {
        const uint32_t entered = transform(placed, bounds, walk.world, &walk.local);
        if (entered == 0) return false;
        const glm::vec3 size = bounds.extent();
        if (std::popcount(entered) < kFewRays || !is_narrow(walk.world, size.x + size.y + size.z) || !prepare(&walk.local)) {
            trace_apart<kIsAny>(placed, bounds, entered, &walk.local, walk.stream, walk.counts);
            walk.set_limit();
            return false;
        }
    }
    if (stack.size > 0) {
        stack.keys[stack.size] = 0;
        stack.children[stack.size++] = kLeave;
    }
    if (!placed.is_identity) walk.enter_space(&walk.local, stack.size);
    walk.nodes = placed.blas->tree.nodes.data();
    walk.blocks = placed.blas->blocks.data();
    walk.id = placed.id;
    walk.is_in_instance = true;
    return true;
}

// Takes sixteen rays through the scene together. Returns how many blocks of triangles were tested with all of them.
// local, stream   their contents are scratch.
template <bool kIsAny>
HWY_INLINE uint32_t trace_packet(const TwoLevels& scene, Packet& world, Packet& local, const Stack& memory, Stream* stream,
                                 TraverseCounts* counts) {
    PacketWalk<kIsAny> walk{world, local, stream, counts, &world, memory, scene.top->nodes.data()};
    Stack& stack = walk.stack;
    walk.set_limit();
    uint32_t at = 0, tested_blocks = 0;
    for (;;) {
        bool has_next = false;
        if (!is_leaf(at)) {
            ++counts->nodes;
            has_next = next_child<kIsAny>(walk.nodes[at], walk.packet->boxes, walk.limit, &stack, &at);
        } else if (at == kLeave) {
            walk.is_in_instance = false;
            walk.nodes = scene.top->nodes.data();
            if (walk.packet != &world) walk.enter_space(&world, 0);
        } else if (walk.is_in_instance) {
            bool is_found = false;
            tested_blocks += block_count(at);
            counts->triangles += TriangleBlock::kSize * block_count(at);
            for (uint32_t k = 0; k < block_count(at); ++k) {
                is_found |= test_block<kIsAny>(walk.blocks[first_block(at) + k], walk.id, walk.packet);
            }
            if (is_found) walk.set_limit();
        } else {
            const PlacedBlas& placed = scene.instances[first_block(at)];
            has_next = enter_instance(walk, placed, scene.bounds[first_block(at)]);
            at = placed.start;
        }
        if (has_next) continue;
        if (kIsAny && walk.limit < 0.0f) stack.size = walk.leave_size;  // No ray looks for more in this space.
        do {
            if (stack.size == 0) return tested_blocks;
            --stack.size;
        } while (!kIsAny && stack.keys[stack.size] > walk.limit_key);
        at = stack.children[stack.size];
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
