// The way of a ray, or of sixteen, through both levels: from the top, into instances and back. Compiled once an instruction
// set, by the file that includes it.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// Pushed below the root of an instance's tree: the ray goes back to the world. Never culled.
constexpr uint32_t kLeave = kEmptyChild;
// At the bottom of a single ray's stack: there is no more to do. No leaf of so many blocks can begin at so late a one.
constexpr uint32_t kDone = kEmptyChild - 1;

// A ray on its way.
template <bool kIsAny>
struct Walk {
    const WideNode* nodes;
    const TriangleBlock* blocks;
    Stack stack;
    RawHit hit;
    float limit;         // Boxes entered behind it hold nothing closer than `hit`.
    uint32_t limit_key;  // The same for entries of the stack.
    float t_floor, t_min;
    uint32_t id;  // Of the instance that the ray is in.
    bool is_in_instance;
    bool is_found;
    TraverseCounts counts;
    Space world, local;

    void start(const WideNode* root, const RawHit& best, float begin) {
        stack.size = 0;
        nodes = root;
        hit = best;
        t_min = begin;
        is_found = false;
        set_limit();
    }
    void set_limit() {
        limit = hit.t * kCullPad;
        limit_key = std::bit_cast<uint32_t>(limit) | kSlotMask;
    }
};

template <bool kIsAny>
HWY_INLINE void test_leaf(Walk<kIsAny>& walk, Space& space, uint32_t child) {
    const TriangleBlock* block = walk.blocks + first_block(child);
    space.need_frame();
    for (const TriangleBlock* end = block + block_count(child); block != end; ++block) {
        walk.counts.triangles += TriangleBlock::kSize;
        test_block(*block, space, walk.t_floor, walk.t_min, walk.hit.t,
                   [&](float t, float u, float v, uint32_t primitive) HWY_ATTR {
                       RawHit& hit = walk.hit;
                       const bool is_closer =
                           t < hit.t ||
                           (t == hit.t && (walk.id < hit.id || (walk.id == hit.id && primitive < hit.primitive)));
                       if (!is_closer) return;
                       hit = {t, u, v, walk.id, primitive};
                       walk.is_found = true;
                       walk.set_limit();
                   });
        if (kIsAny && walk.is_found) return;
    }
}

// Returns false where the ray does not enter the instance's box.
template <bool kIsAny>
HWY_INLINE bool enter_instance(Walk<kIsAny>& walk, const PlacedBlas& placed, const Ray& ray) {
    // Where no transform lies between, the tree's boxes are in the world's: no entry is nearer than the floor would be.
    walk.t_floor = 0.0f;
    if (!placed.is_identity) {
        walk.t_floor = entry(walk.world.frame, placed.bounds_world.lo, placed.bounds_world.hi, walk.hit.t);
        if (!(walk.t_floor < std::numeric_limits<float>::infinity())) return false;
        // The direction is not normalised, so t stays in the world's unit.
        const Ray local{.origin = placed.local_from_world.point(ray.origin),
                        .direction = placed.local_from_world.vector(ray.direction),
                        .t_min = ray.t_min};
        const SlabRay slabs(local);
        if (!slabs.is_valid) return false;
        walk.local.set(slabs, local.direction);
    }
    walk.nodes = placed.blas->tree.nodes.data();
    walk.blocks = placed.blas->blocks.data();
    walk.id = placed.id;
    walk.is_in_instance = true;
    return true;
}

// Takes a ray from the root of `walk.nodes` to its end.
// scene      null where that is no top level.
template <bool kIsAny>
HWY_INLINE void trace(Walk<kIsAny>& walk, const TwoLevels* scene, const Ray* ray) {
    Space* space = &walk.world;
    BoxRay boxes(*space);
    Stack stack = walk.stack;
    stack.keys[0] = 0;
    stack.children[0] = kDone;
    stack.size = 1;
    const WideNode* nodes = walk.nodes;
    uint32_t at = 0, node_count = 0;
    for (;;) {
        if (HWY_LIKELY(!is_leaf(at))) {
            ++node_count;
            if (next_child<kIsAny>(nodes[at], boxes, walk.limit, &stack, &at)) continue;
        } else if (at == kDone) {
            break;
        } else if (at == kLeave) {
            walk.is_in_instance = false;
            space = &walk.world;
            boxes = BoxRay(*space);
            nodes = scene->top->nodes.data();
        } else if (walk.is_in_instance) {
            test_leaf(walk, *space, at);
            if (kIsAny && walk.is_found) break;
        } else {
            const PlacedBlas& placed = scene->instances[first_block(at)];
            if (enter_instance(walk, placed, *ray)) {
                if (stack.children[stack.size - 1] != kDone) {
                    stack.keys[stack.size] = 0;
                    stack.children[stack.size++] = kLeave;
                }
                nodes = walk.nodes;
                at = 0;
                if (!placed.is_identity) {
                    space = &walk.local;
                    boxes = BoxRay(*space);
                }
                continue;
            }
        }
        do {
            --stack.size;
        } while (!kIsAny && stack.keys[stack.size] > walk.limit_key);
        at = stack.children[stack.size];
    }
    walk.counts.nodes += node_count;
}

// A packet's rays one by one through an instance of a space of its own, each from the hit that it has.
template <bool kIsAny>
HWY_INLINE void trace_one_by_one(const PlacedBlas& placed, Packet& packet, Walk<kIsAny>& walk) {
    for (size_t k = 0; k < kPacketSize; ++k) {
        const Ray& ray = packet.rays[k];
        if (kIsAny && packet.t[k] < 0.0f) continue;
        walk.start(nullptr, {packet.t[k], packet.u[k], packet.v[k], packet.id[k], packet.primitive[k]}, ray.t_min);
        walk.world.set(SlabRay(ray), ray.direction);
        if (!enter_instance(walk, placed, ray)) continue;
        walk.world = walk.local;
        trace<kIsAny>(walk, nullptr, nullptr);
        if (!walk.is_found) continue;
        packet.t[k] = kIsAny ? -1.0f : walk.hit.t;
        packet.u[k] = walk.hit.u;
        packet.v[k] = walk.hit.v;
        packet.id[k] = walk.hit.id;
        packet.primitive[k] = walk.hit.primitive;
    }
}

// Takes sixteen rays through the scene together.
template <bool kIsAny>
HWY_INLINE void trace_packet(const TwoLevels& scene, Packet& packet, Walk<kIsAny>& walk) {
    const Stack bottom = walk.stack;
    Stack stack = bottom;
    stack.size = 0;
    const WideNode* nodes = scene.top->nodes.data();
    const TriangleBlock* blocks = nullptr;
    uint32_t id = 0, at = 0, limit_key = 0;
    float limit = 0.0f;
    bool is_in_instance = false;
    const auto set_limit = [&]() HWY_ATTR {
        limit = range_of(packet.t).high * kCullPad;
        limit_key = std::bit_cast<uint32_t>(limit) | kSlotMask;
        return limit >= 0.0f;
    };
    set_limit();
    for (;;) {
        bool has_next = false;
        if (!is_leaf(at)) {
            ++walk.counts.nodes;
            has_next = next_child<kIsAny>(nodes[at], packet.boxes, limit, &stack, &at);
        } else if (at == kLeave) {
            is_in_instance = false;
            nodes = scene.top->nodes.data();
        } else if (is_in_instance) {
            bool is_found = false;
            for (uint32_t k = 0; k < block_count(at); ++k) {
                walk.counts.triangles += TriangleBlock::kSize;
                is_found |= test_block<kIsAny>(blocks[first_block(at) + k], id, &packet);
            }
            if (is_found && !set_limit()) break;
        } else {
            const PlacedBlas& placed = scene.instances[first_block(at)];
            if (placed.is_identity) {
                if (stack.size > 0) {
                    stack.keys[stack.size] = 0;
                    stack.children[stack.size++] = kLeave;
                }
                nodes = placed.blas->tree.nodes.data();
                blocks = placed.blas->blocks.data();
                id = placed.id;
                is_in_instance = true;
                at = 0;
                has_next = true;
            } else {
                walk.stack.keys = bottom.keys + stack.size;
                walk.stack.children = bottom.children + stack.size;
                trace_one_by_one(placed, packet, walk);
                if (!set_limit()) break;
            }
        }
        if (has_next) continue;
        do {
            if (stack.size == 0) {
                walk.stack = bottom;
                return;
            }
            --stack.size;
        } while (!kIsAny && stack.keys[stack.size] > limit_key);
        at = stack.children[stack.size];
    }
    walk.stack = bottom;
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
