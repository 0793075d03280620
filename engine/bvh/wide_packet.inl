// Sixteen rays that go much the same way, through the tree together: one test of a node's boxes for all of them, and each
// triangle against all sixteen at once (wide_packet_triangle.inl). Compiled once an instruction set, by the file that
// includes it.
//
// A node's boxes are tested by interval arithmetic over the packet's origins and reciprocal directions. Rounding is
// monotone, so the interval's ends bound what the test of a single ray computes, and nothing is culled that it would not
// cull.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

constexpr size_t kPacketSize = 16;
using RayTag = hn::CappedTag<float, kPacketSize>;
using RayBits = hn::RebindToUnsigned<RayTag>;
using RayMask = hn::Mask<RayTag>;
constexpr size_t kRayLanes = HWY_MAX_BYTES >= 64 ? 16 : HWY_MAX_BYTES >= 32 ? 8 : 4;

// Directions may differ by this much of the longest component, origins by this much of the scene's extent.
constexpr float kMaxDirectionSpread = 0.25f, kMaxOriginSpread = 0.05f;
// Fewer rays than this in an instance go one by one.
constexpr int kFewRays = 2;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The rays' origins and reciprocal directions as intervals, in registers.
struct BoxPacket {
    hn::Vec<BoxTag> near_origin[3], far_origin[3];  // Where a slab is entered first, and left last.
    hn::Vec<BoxTag> near_low[3], near_high[3], far_low[3], far_high[3];
    size_t row[3];
};

HWY_INLINE Entered test_boxes(const WideNode& node, const BoxPacket& packet, hn::Vec<BoxTag> limit, size_t lane) {
    const BoxTag d;
    const float* planes = &node.planes[0][0] + lane;
    auto in = hn::Zero(d);
    auto out = limit;
    for (int axis = 0; axis < 3; ++axis) {
        const auto first = hn::Sub(hn::Load(d, planes + packet.row[axis]), packet.near_origin[axis]);
        const auto last = hn::Sub(hn::Load(d, planes + (packet.row[axis] ^ kWidth)), packet.far_origin[axis]);
        in = larger(smaller(hn::Mul(first, packet.near_low[axis]), hn::Mul(first, packet.near_high[axis])), in);
        out = smaller(larger(hn::Mul(last, packet.far_low[axis]), hn::Mul(last, packet.far_high[axis])), out);
    }
    return {hn::Le(in, out), in};
}

struct Range {
    float low, high;
};
HWY_INLINE Range range_of(const float* values) {
    const RayTag d;
    auto low = hn::Load(d, values), high = low;
    for (size_t lane = kRayLanes; lane < kPacketSize; lane += kRayLanes) {
        low = smaller(hn::Load(d, values + lane), low);
        high = larger(hn::Load(d, values + lane), high);
    }
    return {hn::GetLane(hn::MinOfLanes(d, low)), hn::GetLane(hn::MaxOfLanes(d, high))};
}

// What was found so far, in whatever space.
struct PacketHits {
    HWY_ALIGN float t_min[kPacketSize];
    HWY_ALIGN float t[kPacketSize];  // Of the closest hit; negative where a ray looks for no more.
    HWY_ALIGN float u[kPacketSize];
    HWY_ALIGN float v[kPacketSize];
    HWY_ALIGN uint32_t id[kPacketSize];
    HWY_ALIGN uint32_t primitive[kPacketSize];
};

// The rays as the tests see them in one space: the world's, or an instance's.
struct Packet {
    explicit Packet(PacketHits* hits)
        : t_min(hits->t_min), t(hits->t), u(hits->u), v(hits->v), id(hits->id), primitive(hits->primitive) {}

    HWY_ALIGN float origin[3][kPacketSize];
    HWY_ALIGN float inverse[3][kPacketSize];
    HWY_ALIGN float direction[3][kPacketSize];
    HWY_ALIGN float shear[3][kPacketSize];
    HWY_ALIGN float t_floor[kPacketSize];  // No hit is nearer; infinite for rays that take no part.
    float *t_min, *t, *u, *v;              // Of PacketHits, which both spaces share.
    uint32_t *id, *primitive;
    int kx, ky, kz;  // Of all rays.
    bool is_negative[3];
    float origin_spread;  // How far the origins are apart, along the axis where they are farthest.
    BoxPacket boxes;

    Ray ray(size_t k) const {
        return {.origin = {origin[0][k], origin[1][k], origin[2][k]},
                .direction = {direction[0][k], direction[1][k], direction[2][k]}};
    }
};

// The farthest t that a ray which takes part still looks for; negative where none does.
HWY_INLINE float farthest(const Packet& packet) {
    const RayTag d;
    auto most = hn::Set(d, -1.0f);
    for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
        const auto takes_part = hn::Lt(hn::Load(d, packet.t_floor + lane), hn::Set(d, kInfinity));
        most = hn::IfThenElse(takes_part, larger(hn::Load(d, packet.t + lane), most), most);
    }
    return hn::GetLane(hn::MaxOfLanes(d, most));
}

// Whether all rays point much the same way, and none along an axis, or is of a size whose products may not be finite.
HWY_INLINE bool is_uniform(const Packet& space) {
    const RayTag d;
    const auto small = hn::Set(d, 1e-15f), large = hn::Set(d, 1e15f);
    for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
        hn::Vec<RayTag> sizes[3];
        for (int axis = 0; axis < 3; ++axis) {
            const auto along = hn::Load(d, space.direction[axis] + lane);
            sizes[axis] = space.is_negative[axis] ? hn::Neg(along) : along;
        }
        // As RayFrame has it.
        const auto is_x_over_y = hn::Gt(sizes[0], sizes[1]);
        const auto is_x = hn::And(is_x_over_y, hn::Gt(sizes[0], sizes[2]));
        const auto is_y = hn::AndNot(is_x_over_y, hn::Gt(sizes[1], sizes[2]));
        auto is_good = space.kz == 0 ? is_x : space.kz == 1 ? is_y : hn::Not(hn::Or(is_x, is_y));
        // Every comparison is false for NaN.
        for (int axis = 0; axis < 3; ++axis) {
            is_good = hn::And(is_good, hn::And(hn::Ge(sizes[axis], small), hn::Le(sizes[axis], large)));
            is_good = hn::And(is_good, hn::Le(hn::Abs(hn::Load(d, space.origin[axis] + lane)), large));
        }
        if (!hn::AllTrue(d, is_good)) return false;
    }
    return true;
}

// Works out all else from origins and directions. Returns false for rays that are better traced one by one, or must be.
// slack      of TwoLevels, where these are rays in the world.
HWY_INLINE bool prepare(Packet* packet, float slack = 0.0f) {
    Packet& p = *packet;
    glm::vec3 first;
    for (int axis = 0; axis < 3; ++axis) {
        first[axis] = std::abs(p.direction[axis][0]);
        p.is_negative[axis] = p.direction[axis][0] < 0.0f;
    }
    p.kz = first.x > first.y ? (first.x > first.z ? 0 : 2) : (first.y > first.z ? 1 : 2);
    p.kx = p.kz == 2 ? 0 : p.kz + 1;
    p.ky = p.kx == 2 ? 0 : p.kx + 1;
    if (p.is_negative[p.kz]) std::swap(p.kx, p.ky);
    if (!is_uniform(p)) return false;
    p.origin_spread = 0.0f;
    const RayTag d;
    const BoxTag box;
    Range places[3];
    float more = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        places[axis] = range_of(p.origin[axis]);
        more = std::max({more, slack * std::abs(places[axis].low), slack * std::abs(places[axis].high)});
    }
    for (int axis = 0; axis < 3; ++axis) {
        const Range origins = places[axis], directions = range_of(p.direction[axis]);
        p.origin_spread = std::max(origins.high - origins.low, p.origin_spread);
        if (!(directions.high - directions.low <= kMaxDirectionSpread * first[p.kz])) return false;
        for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
            hn::Store(hn::Div(hn::Set(d, 1.0f), hn::Load(d, p.direction[axis] + lane)), d, p.inverse[axis] + lane);
        }
        // A reciprocal falls where what it is of rises, to the last bit.
        const Range inverses = {1.0f / directions.high, 1.0f / directions.low};
        p.boxes.row[axis] = (2 * axis + (p.is_negative[axis] ? 1 : 0)) * kWidth;
        p.boxes.near_origin[axis] = hn::Set(box, p.is_negative[axis] ? origins.low - more : origins.high + more);
        p.boxes.far_origin[axis] = hn::Set(box, p.is_negative[axis] ? origins.high + more : origins.low - more);
        p.boxes.near_low[axis] = hn::Set(box, inverses.low);
        p.boxes.near_high[axis] = hn::Set(box, inverses.high);
        p.boxes.far_low[axis] = hn::Set(box, inverses.low * kCullPad);
        p.boxes.far_high[axis] = hn::Set(box, inverses.high * kCullPad);
    }
    for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
        const auto along = hn::Load(d, p.direction[p.kz] + lane);
        hn::Store(hn::Div(hn::Load(d, p.direction[p.kx] + lane), along), d, p.shear[0] + lane);
        hn::Store(hn::Div(hn::Load(d, p.direction[p.ky] + lane), along), d, p.shear[1] + lane);
        hn::Store(hn::Load(d, p.inverse[p.kz] + lane), d, p.shear[2] + lane);
    }
    return true;
}

// extent     the size, by the sum of its sides, of what the rays are to be tested with.
HWY_INLINE bool is_narrow(const Packet& packet, float extent) {
    return packet.origin_spread <= kMaxOriginSpread * extent;
}

// Whether two rays of a packet can't be in one: tells most rays that go apart at little cost.
HWY_INLINE bool go_apart(const Ray& a, const Ray& b) {
    const AxisTag d;
    const auto first = hn::LoadU(d, &a.direction.x), second = hn::LoadU(d, &b.direction.x);
    const auto longest = hn::Set(d, std::max({std::abs(a.direction.x), std::abs(a.direction.y), std::abs(a.direction.z)}));
    const auto limit = hn::Mul(longest, hn::Set(d, kMaxDirectionSpread));
    return (bits_of(d, hn::Gt(hn::Abs(hn::Sub(first, second)), limit)) & 7) != 0;
}

// Reads sixteen rays. Returns false for those that are better traced one by one, or must be.
// extent     of the scene.
// slack      of TwoLevels.
HWY_INLINE bool set_packet(const Ray* rays, float extent, float slack, Packet* packet) {
    if (go_apart(rays[0], rays[kPacketSize - 1])) return false;
    Packet& p = *packet;
    const RayTag d;
    const RayBits bits;
    auto has_ends = hn::Eq(hn::Zero(d), hn::Zero(d));
    for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
        // Every fourth number of the first half of these rays, then of the second.
        hn::Vec<RayTag> a[4], b[4];
        const float* numbers = &rays[lane].origin.x;
        hn::LoadInterleaved4(d, numbers, a[0], a[1], a[2], a[3]);
        hn::LoadInterleaved4(d, numbers + 4 * kRayLanes, b[0], b[1], b[2], b[3]);
        const auto t_min = hn::ConcatOdd(d, b[2], a[2]), t_max = hn::ConcatOdd(d, b[3], a[3]), zero = hn::Zero(d);
        for (int axis = 0; axis < 3; ++axis) hn::Store(hn::ConcatEven(d, b[axis], a[axis]), d, p.origin[axis] + lane);
        hn::Store(hn::ConcatEven(d, b[3], a[3]), d, p.direction[0] + lane);
        hn::Store(hn::ConcatOdd(d, b[0], a[0]), d, p.direction[1] + lane);
        hn::Store(hn::ConcatOdd(d, b[1], a[1]), d, p.direction[2] + lane);
        hn::Store(t_min, d, p.t_min + lane);
        hn::Store(t_max, d, p.t + lane);
        has_ends = hn::And(has_ends, hn::And(hn::Ge(t_min, zero), hn::Le(t_min, t_max)));
        for (float* values : {p.t_floor, p.u, p.v}) hn::Store(zero, d, values + lane);
        for (uint32_t* values : {p.id, p.primitive}) hn::Store(hn::Set(bits, kEmptyChild), bits, values + lane);
    }
    return hn::AllTrue(d, has_ends) && prepare(packet, slack) && is_narrow(p, extent);
}
static_assert(sizeof(Ray) == 8 * sizeof(float) && offsetof(Ray, direction) == 3 * sizeof(float) &&
              offsetof(Ray, t_min) == 6 * sizeof(float));

// Takes the rays that enter an instance's box into its space, by the operations of `entry` and of Affine; the others stand
// where the first of these does, so that they widen nothing. Returns a bit for each that enters; where none does,
// `local` is as it was.
HWY_INLINE uint32_t transform(const PlacedBlas& placed, const Aabb& bounds, const Packet& world, Packet* local) {
    const RayTag d;
    using V = hn::Vec<RayTag>;
    uint32_t entered = 0;
    HWY_ALIGN float t_floor[kPacketSize];
    for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
        V in = hn::Zero(d), out = hn::Set(d, kInfinity);
        for (int axis = 0; axis < 3; ++axis) {
            const float lo = bounds.lo[axis], hi = bounds.hi[axis];
            const V origin = hn::Load(d, world.origin[axis] + lane), inverse = hn::Load(d, world.inverse[axis] + lane);
            in = larger(hn::Mul(hn::Sub(hn::Set(d, world.is_negative[axis] ? hi : lo), origin), inverse), in);
            out = smaller(hn::Mul(hn::Sub(hn::Set(d, world.is_negative[axis] ? lo : hi), origin), inverse), out);
        }
        in = hn::Mul(in, hn::Set(d, 1.0f - kBoxPad));
        out = hn::Mul(out, hn::Set(d, 1.0f + kBoxPad));
        const auto is_entered =
            hn::And(hn::And(hn::Le(in, out), hn::Le(in, hn::Load(d, world.t + lane))), hn::Lt(in, hn::Set(d, kInfinity)));
        hn::Store(hn::IfThenElse(is_entered, in, hn::Set(d, kInfinity)), d, t_floor + lane);
        uint8_t bits[8] = {};
        hn::StoreMaskBits(d, is_entered, bits);
        entered |= static_cast<uint32_t>(bits[0] | bits[1] << 8) << lane;
    }
    if (entered == 0) return 0;
    const int first = std::countr_zero(entered);
    const glm::mat3& m = placed.local_from_world.linear;
    for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
        const V floor = hn::Load(d, t_floor + lane);
        const auto is_entered = hn::Lt(floor, hn::Set(d, kInfinity));
        V origin[3], direction[3];
        for (int axis = 0; axis < 3; ++axis) {
            origin[axis] =
                hn::IfThenElse(is_entered, hn::Load(d, world.origin[axis] + lane), hn::Set(d, world.origin[axis][first]));
            direction[axis] = hn::IfThenElse(is_entered, hn::Load(d, world.direction[axis] + lane),
                                             hn::Set(d, world.direction[axis][first]));
        }
        const auto times = [&](int row, const V* v) HWY_ATTR {
            return hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0][row]), v[0]), hn::Mul(hn::Set(d, m[1][row]), v[1])),
                           hn::Mul(hn::Set(d, m[2][row]), v[2]));
        };
        for (int row = 0; row < 3; ++row) {
            const V shift = hn::Set(d, placed.local_from_world.translation[row]);
            hn::Store(hn::Add(times(row, origin), shift), d, local->origin[row] + lane);
            hn::Store(times(row, direction), d, local->direction[row] + lane);
        }
        hn::Store(floor, d, local->t_floor + lane);
    }
    return entered;
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
