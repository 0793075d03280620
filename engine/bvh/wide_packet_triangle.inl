// Each triangle of a block against the sixteen rays of a packet at once. Compiled once an instruction set, by the file that
// includes it.
//
// The operations are those of `intersect` for each ray, those in double included.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

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
    const auto is_finite = hn::And(hn::Ge(t, zero), hn::Le(t, hn::Set(d, double(std::numeric_limits<float>::max()))));
    const auto is_placed = hn::And(is_inside, is_finite);
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
    t = larger(in, larger(hn::Load(d, p.t_floor + lane), t));
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
