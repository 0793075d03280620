// The way of a single ray through both levels: from the top, into instances and back. Compiled once an instruction
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

HWY_INLINE bool is_closer(float t, uint32_t id, uint32_t primitive, const RawHit& hit) {
    return t < hit.t || (t == hit.t && (id < hit.id || (id == hit.id && primitive < hit.primitive)));
}

template <bool kIsAny>
HWY_INLINE void test_leaf(Walk<kIsAny>& walk, const Space& space, uint32_t child) {
    const TriangleBlock* block = walk.blocks + first_block(child);
    for (const TriangleBlock* end = block + block_count(child); block != end; ++block) {
        walk.counts.triangles += TriangleBlock::kSize;
        test_block(
            *block, space, [&]() HWY_ATTR { return walk.t_floor; }, walk.t_min, walk.hit.t,
            [&](float t, float u, float v, uint32_t primitive) HWY_ATTR {
                RawHit& hit = walk.hit;
                if (!is_closer(t, walk.id, primitive, hit)) return;
                hit = {t, u, v, walk.id, primitive};
                walk.is_found = true;
                walk.set_limit();
            });
        if (kIsAny && walk.is_found) return;
    }
}

// Takes a ray into an instance's space, by the operations of Affine. Returns false for one that hits nothing there.
HWY_INLINE bool transform(const PlacedBlas& placed, const Space& world, Space* local) {
    const AxisTag d;
    const glm::mat3& m = placed.local_from_world.linear;
    if (placed.is_shifted) {
        const auto zero = hn::Zero(d), at = hn::Load(d, world.origin);
        // The products with the identity change nothing but signs of 0.
        const auto has_zero = hn::Or(hn::Eq(at, zero), hn::Eq(hn::Load(d, world.direction), zero));
        const auto shift = hn::ShiftRightLanes<1>(d, hn::LoadU(d, &m[2].z));
        if (HWY_LIKELY((bits_of(d, has_zero) & 7) == 0)) return local->set_shifted(world, hn::Add(at, shift));
    }
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
HWY_INLINE bool enter_instance(Walk<kIsAny>& walk, const PlacedBlas& placed, const Aabb& bounds) {
    // Where no transform lies between, the tree's boxes are in the world's: no entry is nearer than the floor would be.
    walk.t_floor = 0.0f;
    if (!placed.is_identity) {
        walk.t_floor = entry(walk.world, bounds, walk.hit.t);
        if (!(walk.t_floor < std::numeric_limits<float>::infinity())) return false;
        // The direction is not normalised, so t stays in the world's unit.
        if (!transform(placed, walk.world, &walk.local)) return false;
    }
    walk.nodes = placed.blas->tree.nodes.data();
    walk.blocks = placed.blas->blocks.data();
    walk.id = placed.id;
    walk.is_in_instance = true;
    return true;
}

// Takes a ray from a child of `walk.nodes` (0: the root) to its end.
// scene      null where that is no top level.
template <bool kIsAny>
HWY_INLINE void trace(Walk<kIsAny>& walk, const TwoLevels* scene, uint32_t at) {
    Space* space = &walk.world;
    BoxRay boxes(*space, !walk.is_in_instance);
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
            boxes = BoxRay(*space, true);
            nodes = scene->top->nodes.data();
        } else if (walk.is_in_instance) {
            test_leaf(walk, *space, at);
            if (kIsAny && walk.is_found) break;
        } else {
            const PlacedBlas& placed = scene->instances[first_block(at)];
            if (enter_instance(walk, placed, scene->bounds[first_block(at)])) {
                if (stack.children[stack.size - 1] != kDone) {
                    stack.keys[stack.size] = 0;
                    stack.children[stack.size++] = kLeave;
                }
                nodes = walk.nodes;
                at = placed.start;
                if (!placed.is_identity) {
                    space = &walk.local;
                    boxes = BoxRay(*space, false);
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

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
