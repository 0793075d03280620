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
HWY_INLINE void test_leaf(Walk<kIsAny>& walk, const Space& space, uint32_t child) {
    const TriangleBlock* block = walk.blocks + first_block(child);
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

// Takes a ray into an instance's space, by the operations of Affine. Returns false for one that hits nothing there.
HWY_INLINE bool transform(const Affine& local_from_world, const Space& world, Space* local) {
    const AxisTag d;
    const glm::mat3& m = local_from_world.linear;
    const auto x = hn::LoadU(d, &m[0].x), y = hn::LoadU(d, &m[1].x), z = hn::LoadU(d, &m[2].x);
    const auto shift = hn::ShiftRightLanes<1>(d, hn::LoadU(d, &m[2].z));  // The translation follows the matrix.
    const auto times = [&](const float* v) HWY_ATTR {
        return hn::Add(hn::Add(hn::Mul(x, hn::Set(d, v[0])), hn::Mul(y, hn::Set(d, v[1]))), hn::Mul(z, hn::Set(d, v[2])));
    };
    return local->set(hn::Add(times(world.origin), shift), times(world.direction));
}
static_assert(offsetof(Affine, translation) == sizeof(glm::mat3) && sizeof(glm::mat3) == 9 * sizeof(float));

// Returns false where the ray does not enter the instance's box.
template <bool kIsAny>
HWY_INLINE bool enter_instance(Walk<kIsAny>& walk, const PlacedBlas& placed) {
    // Where no transform lies between, the tree's boxes are in the world's: no entry is nearer than the floor would be.
    walk.t_floor = 0.0f;
    if (!placed.is_identity) {
        walk.t_floor = entry(walk.world, placed.bounds_world, walk.hit.t);
        if (!(walk.t_floor < std::numeric_limits<float>::infinity())) return false;
        // The direction is not normalised, so t stays in the world's unit.
        if (!transform(placed.local_from_world, walk.world, &walk.local)) return false;
    }
    walk.nodes = placed.blas->tree.nodes.data();
    walk.blocks = placed.blas->blocks.data();
    walk.id = placed.id;
    walk.is_in_instance = true;
    return true;
}

// How much larger the boxes of the top level are to a ray, as they may be tight (see TwoLevels).
HWY_INLINE float slack_of(const Space& world, const TwoLevels& scene) {
    return scene.slack * std::max({std::abs(world.origin[0]), std::abs(world.origin[1]), std::abs(world.origin[2])});
}

// Takes a ray from a child of `walk.nodes` (0: the root) to its end.
// scene      null where that is no top level.
template <bool kIsAny>
HWY_INLINE void trace(Walk<kIsAny>& walk, const TwoLevels* scene, uint32_t at) {
    Space* space = &walk.world;
    const float slack = walk.is_in_instance ? 0.0f : slack_of(*space, *scene);
    BoxRay boxes(*space, slack);
    Stack stack = walk.stack;
    stack.keys[0] = 0;
    stack.children[0] = kDone;
    stack.size = 1;
    const WideNode* nodes = walk.nodes;
    uint32_t node_count = 0;
    for (;;) {
        if (HWY_LIKELY(!is_leaf(at))) {
            ++node_count;
            if (next_child<kIsAny>(nodes[at], boxes, walk.limit, &stack, &at)) continue;
        } else if (at == kDone) {
            break;
        } else if (at == kLeave) {
            walk.is_in_instance = false;
            space = &walk.world;
            boxes = BoxRay(*space, slack);
            nodes = scene->top->nodes.data();
        } else if (walk.is_in_instance) {
            test_leaf(walk, *space, at);
            if (kIsAny && walk.is_found) break;
        } else {
            const PlacedBlas& placed = scene->instances[first_block(at)];
            if (enter_instance(walk, placed)) {
                if (stack.children[stack.size - 1] != kDone) {
                    stack.keys[stack.size] = 0;
                    stack.children[stack.size++] = kLeave;
                }
                nodes = walk.nodes;
                at = placed.start;
                if (!placed.is_identity) space = &walk.local;
                boxes = BoxRay(*space);
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

// Those of a packet's rays that `which` has a bit for, in the space of an instance, one by one, each from the hit that it
// has.
template <bool kIsAny>
HWY_INLINE void trace_one_by_one(const PlacedBlas& placed, uint32_t which, Packet& packet, Walk<kIsAny>& walk) {
    walk.blocks = placed.blas->blocks.data();
    walk.id = placed.id;
    walk.is_in_instance = true;
    for (; which != 0; which &= which - 1) {
        const int k = std::countr_zero(which);
        if (!walk.world.set(packet.ray(k))) continue;
        walk.start(placed.blas->tree.nodes.data(),
                   {packet.t[k], packet.u[k], packet.v[k], packet.id[k], packet.primitive[k]}, packet.t_min[k]);
        walk.t_floor = packet.t_floor[k];
        trace<kIsAny>(walk, nullptr, placed.start);
        if (!walk.is_found) continue;
        packet.t[k] = kIsAny ? -1.0f : walk.hit.t;
        packet.u[k] = walk.hit.u;
        packet.v[k] = walk.hit.v;
        packet.id[k] = walk.hit.id;
        packet.primitive[k] = walk.hit.primitive;
    }
}

// A packet on its way.
template <bool kIsAny>
struct PacketWalk {
    const TwoLevels& scene;
    Packet &world, &local;
    Walk<kIsAny>& single;  // For rays that are better traced one by one.
    Packet* packet;        // In the space where the walk is.
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
HWY_INLINE bool enter_instance(PacketWalk<kIsAny>& walk, const PlacedBlas& placed) {
    Stack& stack = walk.stack;
    if (!placed.is_identity) {
        const uint32_t entered = transform(placed, walk.world, &walk.local);
        if (entered == 0) return false;
        const glm::vec3 size = placed.bounds_world.extent();
        if (std::popcount(entered) < kFewRays || !is_narrow(walk.world, size.x + size.y + size.z) || !prepare(&walk.local)) {
            const Stack bottom = walk.single.stack;
            walk.single.stack = {stack.keys + stack.size, stack.children + stack.size};
            trace_one_by_one(placed, entered, walk.local, walk.single);
            walk.single.stack = bottom;
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

// Takes sixteen rays through the scene together.
// local      its contents are scratch.
template <bool kIsAny>
HWY_INLINE void trace_packet(const TwoLevels& scene, Packet& world, Packet& local, Walk<kIsAny>& single) {
    PacketWalk<kIsAny> walk{scene, world, local, single, &world, single.stack, scene.top->nodes.data()};
    Stack& stack = walk.stack;
    stack.size = 0;
    walk.set_limit();
    uint32_t at = 0;
    for (;;) {
        bool has_next = false;
        if (!is_leaf(at)) {
            ++single.counts.nodes;
            has_next = next_child<kIsAny>(walk.nodes[at], walk.packet->boxes, walk.limit, &stack, &at);
        } else if (at == kLeave) {
            walk.is_in_instance = false;
            walk.nodes = scene.top->nodes.data();
            if (walk.packet != &world) walk.enter_space(&world, 0);
        } else if (walk.is_in_instance) {
            bool is_found = false;
            for (uint32_t k = 0; k < block_count(at); ++k) {
                single.counts.triangles += TriangleBlock::kSize;
                is_found |= test_block<kIsAny>(walk.blocks[first_block(at) + k], walk.id, walk.packet);
            }
            if (is_found) walk.set_limit();
        } else {
            const PlacedBlas& placed = scene.instances[first_block(at)];
            has_next = enter_instance(walk, placed);
            at = placed.start;
        }
        if (has_next) continue;
        if (kIsAny && walk.limit < 0.0f) stack.size = walk.leave_size;  // No ray looks for more in this space.
        do {
            if (stack.size == 0) return;
            --stack.size;
        } while (!kIsAny && stack.keys[stack.size] > walk.limit_key);
        at = stack.children[stack.size];
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
