// Sixteen rays that go much the same way, through the tree together: one test of a node's boxes for all of them, and each
// triangle against all sixteen at once. Compiled once an instruction set, by the file that includes it.
//
// A node's boxes are tested by interval arithmetic over the packet's origins and reciprocal directions. Rounding is
// monotone, so the interval's ends bound what the test of a single ray computes, and nothing is culled that it would not
// cull. The triangle test does the operations of `intersect` for each ray, those in double included.

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

struct Packet {
    HWY_ALIGN float origin[3][kPacketSize];
    HWY_ALIGN float inverse[3][kPacketSize];
    HWY_ALIGN float direction[3][kPacketSize];
    HWY_ALIGN float shear[3][kPacketSize];
    HWY_ALIGN float t_min[kPacketSize];
    HWY_ALIGN float t[kPacketSize];  // Of the closest hit so far; negative where a ray looks for no more.
    HWY_ALIGN float u[kPacketSize];
    HWY_ALIGN float v[kPacketSize];
    HWY_ALIGN uint32_t id[kPacketSize];
    HWY_ALIGN uint32_t primitive[kPacketSize];
    const Ray* rays;
    int kx, ky, kz;  // Of all rays.
    bool is_negative[3];
    BoxPacket boxes;
};

// Reads sixteen rays. Returns false for those that are better traced one by one, or must be.
// extent     of the scene.
HWY_INLINE bool set_packet(const Ray* rays, float extent, Packet* packet) {
    Packet& p = *packet;
    p.rays = rays;
    for (size_t k = 0; k < kPacketSize; ++k) {
        const Ray& ray = rays[k];
        for (int axis = 0; axis < 3; ++axis) {
            p.origin[axis][k] = ray.origin[axis];
            p.direction[axis][k] = ray.direction[axis];
        }
        p.t_min[k] = ray.t_min;
        p.t[k] = ray.t_max;
        p.u[k] = p.v[k] = 0.0f;
        p.id[k] = p.primitive[k] = kEmptyChild;
    }
    // Not for rays along an axis, or of sizes whose products may not be finite; every comparison is false for NaN.
    constexpr float kSmall = 1e-15f, kLarge = 1e15f;
    float longest = 0.0f;
    Range origins[3], directions[3];
    for (int axis = 0; axis < 3; ++axis) {
        origins[axis] = range_of(p.origin[axis]);
        directions[axis] = range_of(p.direction[axis]);
        if (!(origins[axis].low >= -kLarge && origins[axis].high <= kLarge)) return false;
        if (!(origins[axis].high - origins[axis].low <= kMaxOriginSpread * extent)) return false;
        p.is_negative[axis] = directions[axis].high < 0.0f;
        const float least = p.is_negative[axis] ? -directions[axis].high : directions[axis].low;
        const float most = p.is_negative[axis] ? -directions[axis].low : directions[axis].high;
        if (!(least >= kSmall && most <= kLarge)) return false;
        longest = most > longest ? most : longest;
    }
    const Range begins = range_of(p.t_min), ends = range_of(p.t);
    if (!(begins.low >= 0.0f && begins.high <= ends.low)) return false;
    const RayFrame first(rays[0]);
    p.kx = first.kx, p.ky = first.ky, p.kz = first.kz;
    bool is_uniform = true;
    for (size_t k = 0; k < kPacketSize; ++k) {
        const float x = std::abs(p.direction[0][k]), y = std::abs(p.direction[1][k]), z = std::abs(p.direction[2][k]);
        const int kz = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);  // As RayFrame has it.
        // `range_of` passes over a NaN; this does not.
        is_uniform &= kz == p.kz && x >= kSmall && y >= kSmall && z >= kSmall && rays[k].t_min <= rays[k].t_max &&
                      std::abs(p.origin[0][k]) <= kLarge && std::abs(p.origin[1][k]) <= kLarge &&
                      std::abs(p.origin[2][k]) <= kLarge;
    }
    if (!is_uniform) return false;
    const RayTag d;
    const BoxTag box;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(directions[axis].high - directions[axis].low <= kMaxDirectionSpread * longest)) return false;
        for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
            hn::Store(hn::Div(hn::Set(d, 1.0f), hn::Load(d, p.direction[axis] + lane)), d, p.inverse[axis] + lane);
        }
        const Range inverses = range_of(p.inverse[axis]);
        p.boxes.row[axis] = (2 * axis + (p.is_negative[axis] ? 1 : 0)) * kWidth;
        p.boxes.near_origin[axis] = hn::Set(box, p.is_negative[axis] ? origins[axis].low : origins[axis].high);
        p.boxes.far_origin[axis] = hn::Set(box, p.is_negative[axis] ? origins[axis].high : origins[axis].low);
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

// What `intersect_plane` works out, by the same operations: t is below 0 where it returns false.
using HalfTag = hn::Half<RayTag>;
struct Placed {
    hn::Vec<HalfTag> t, u, v;
};
template <bool kIsUpper>
HWY_INLINE Placed intersect_planes(const hn::Vec<RayTag>* x, const hn::Vec<RayTag>* y, const hn::Vec<RayTag>* z,
                                   hn::Vec<RayTag> shear_z) {
    const HalfTag half;
    const hn::Rebind<double, HalfTag> d;
    const auto promote = [&](hn::Vec<RayTag> lanes) HWY_ATTR {
        return hn::PromoteTo(d, kIsUpper ? hn::UpperHalf(half, lanes) : hn::LowerHalf(half, lanes));
    };
    const auto ax = promote(x[0]), bx = promote(x[1]), cx = promote(x[2]);
    const auto ay = promote(y[0]), by = promote(y[1]), cy = promote(y[2]);
    const auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const auto zero = hn::Zero(d);
    const auto is_inside = hn::Or(hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::Ge(w, zero)),
                                  hn::And(hn::And(hn::Le(u, zero), hn::Le(v, zero)), hn::Le(w, zero)));
    const auto inverse = hn::Div(hn::Set(d, 1.0), hn::Add(hn::Add(u, v), w));
    const auto along = hn::Add(hn::Add(hn::Mul(u, promote(z[0])), hn::Mul(v, promote(z[1]))), hn::Mul(w, promote(z[2])));
    const auto t = hn::Mul(hn::Mul(along, inverse), promote(shear_z));
    const auto is_placed = hn::And(is_inside, hn::Le(t, hn::Set(d, double(std::numeric_limits<float>::max()))));
    return {hn::DemoteTo(half, hn::IfThenElse(is_placed, t, hn::Set(d, -1.0))), hn::DemoteTo(half, hn::Mul(v, inverse)),
            hn::DemoteTo(half, hn::Mul(w, inverse))};
}

// Tests a triangle against lanes [lane, lane + kRayLanes). Returns whether one of them found a hit that it keeps.
template <bool kIsAny>
HWY_INLINE bool test_triangle(const TriangleBlock& block, int slot, uint32_t id, size_t lane, Packet* packet) {
    Packet& p = *packet;
    const RayTag d;
    const RayBits bits;
    using V = hn::Vec<RayTag>;
    const auto corner = [&](int k, int axis) HWY_ATTR { return hn::Set(d, block.corners[3 * k + axis][slot]); };
    const V origin_x = hn::Load(d, p.origin[p.kx] + lane), origin_y = hn::Load(d, p.origin[p.ky] + lane),
            origin_z = hn::Load(d, p.origin[p.kz] + lane);
    const V shear_x = hn::Load(d, p.shear[0] + lane), shear_y = hn::Load(d, p.shear[1] + lane);
    V x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
        z[k] = hn::Sub(corner(k, p.kz), origin_z);
        x[k] = hn::Sub(hn::Sub(corner(k, p.kx), origin_x), hn::Mul(shear_x, z[k]));
        y[k] = hn::Sub(hn::Sub(corner(k, p.ky), origin_y), hn::Mul(shear_y, z[k]));
    }
    const V u = hn::Sub(hn::Mul(x[2], y[1]), hn::Mul(y[2], x[1]));
    const V v = hn::Sub(hn::Mul(x[0], y[2]), hn::Mul(y[0], x[2]));
    const V w = hn::Sub(hn::Mul(x[1], y[0]), hn::Mul(y[1], x[0]));
    const V zero = hn::Zero(d);
    const auto is_candidate = hn::Or(hn::Ge(smaller(u, smaller(v, w)), zero), hn::Le(larger(u, larger(v, w)), zero));
    if (HWY_LIKELY(hn::AllFalse(d, is_candidate))) return false;

    const V shear_z = hn::Load(d, p.shear[2] + lane);
    // Small triangles are often in front of one half of the rays only.
    const auto is_candidate_bits = hn::VecFromMask(d, is_candidate);
    const HalfTag half;
    const Placed nothing = {hn::Set(half, -1.0f), hn::Zero(half), hn::Zero(half)};
    Placed low = nothing, high = nothing;
    if (!hn::AllFalse(half, hn::MaskFromVec(hn::LowerHalf(half, is_candidate_bits))))
        low = intersect_planes<false>(x, y, z, shear_z);
    if (!hn::AllFalse(half, hn::MaskFromVec(hn::UpperHalf(half, is_candidate_bits))))
        high = intersect_planes<true>(x, y, z, shear_z);
    V t = hn::Combine(d, high.t, low.t);
    const V weight_b = hn::Combine(d, high.u, low.u), weight_c = hn::Combine(d, high.v, low.v);
    auto is_hit = hn::And(is_candidate, hn::Ge(t, zero));
    // `entry` into the triangle's own box.
    const V infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    const V t_max = hn::Load(d, p.t + lane), t_min = hn::Load(d, p.t_min + lane);
    V in = zero, out = infinity;
    for (int axis = 0; axis < 3; ++axis) {
        const V a = corner(0, axis), b = corner(1, axis), c = corner(2, axis);
        const V lo = smaller(c, smaller(b, a)), hi = larger(c, larger(b, a));
        const V origin = hn::Load(d, p.origin[axis] + lane), inverse = hn::Load(d, p.inverse[axis] + lane);
        in = larger(hn::Mul(hn::Sub(p.is_negative[axis] ? hi : lo, origin), inverse), in);
        out = smaller(hn::Mul(hn::Sub(p.is_negative[axis] ? lo : hi, origin), inverse), out);
    }
    in = hn::Mul(in, hn::Set(d, 1.0f - kBoxPad));
    out = hn::Mul(out, hn::Set(d, 1.0f + kBoxPad));
    // The floor is 0 here: no transform lies between.
    t = larger(in, larger(zero, t));
    is_hit = hn::And(is_hit, hn::And(hn::Le(in, out), hn::Le(in, t_max)));
    is_hit = hn::And(is_hit, hn::And(hn::Ge(t, t_min), hn::Le(t, t_max)));
    is_hit = hn::And(is_hit, hn::Lt(t, infinity));

    const uint32_t primitive = block.primitive[slot];
    const auto ids = hn::Load(bits, p.id + lane), primitives = hn::Load(bits, p.primitive + lane);
    const auto new_id = hn::Set(bits, id), new_primitive = hn::Set(bits, primitive);
    const auto is_lower = hn::Or(hn::Lt(new_id, ids), hn::And(hn::Eq(new_id, ids), hn::Lt(new_primitive, primitives)));
    const auto is_kept = hn::And(is_hit, hn::Or(hn::Lt(t, t_max), hn::And(hn::Eq(t, t_max), hn::RebindMask(d, is_lower))));
    if (hn::AllFalse(d, is_kept)) return false;
    if (kIsAny) t = hn::Set(d, -1.0f);
    hn::Store(hn::IfThenElse(is_kept, t, t_max), d, p.t + lane);
    hn::Store(hn::IfThenElse(is_kept, weight_b, hn::Load(d, p.u + lane)), d, p.u + lane);
    hn::Store(hn::IfThenElse(is_kept, weight_c, hn::Load(d, p.v + lane)), d, p.v + lane);
    const auto is_kept_bits = hn::RebindMask(bits, is_kept);
    hn::Store(hn::IfThenElse(is_kept_bits, new_id, ids), bits, p.id + lane);
    hn::Store(hn::IfThenElse(is_kept_bits, new_primitive, primitives), bits, p.primitive + lane);
    return true;
}

template <bool kIsAny>
HWY_INLINE bool test_block(const TriangleBlock& block, uint32_t id, Packet* packet) {
    bool is_found = false;
    for (int slot = 0; slot < static_cast<int>(TriangleBlock::kSize); ++slot) {
        if (block.primitive[slot] == kEmptyChild) break;
        for (size_t lane = 0; lane < kPacketSize; lane += kRayLanes) {
            is_found |= test_triangle<kIsAny>(block, slot, id, lane, packet);
        }
    }
    return is_found;
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
