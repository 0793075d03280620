// The SIMD kernel of triangles: one ray against a block of four. Compiled once an instruction set, by the file that includes
// it.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// Tests a block and calls found(t, u, v, primitive) for every hit with t in [t_min, t_max].
// floor      gives what no hit is nearer than.
template <typename Floor, typename Found>
HWY_INLINE void test_block(const TriangleBlock& block, const Space& ray, Floor&& floor, float t_min, float t_max,
                           Found&& found) {
    const BlockTag d;
    using V = hn::Vec<BlockTag>;
    constexpr size_t kSize = TriangleBlock::kSize;
    const float* corners = block.corners[0];
    const V shear_x = hn::Set(d, ray.shear[0]), shear_y = hn::Set(d, ray.shear[1]);
    const V origin_x = hn::Set(d, ray.sheared_origin[0]), origin_y = hn::Set(d, ray.sheared_origin[1]),
            origin_z = hn::Set(d, ray.sheared_origin[2]);
    V x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
        const float* corner = corners + 3 * kSize * k;
        z[k] = hn::Sub(hn::Load(d, corner + ray.sheared_row[2]), origin_z);
        x[k] = hn::Sub(hn::Sub(hn::Load(d, corner + ray.sheared_row[0]), origin_x), hn::Mul(shear_x, z[k]));
        y[k] = hn::Sub(hn::Sub(hn::Load(d, corner + ray.sheared_row[1]), origin_y), hn::Mul(shear_y, z[k]));
    }
    const V u = hn::Sub(hn::Mul(x[2], y[1]), hn::Mul(y[2], x[1]));
    const V v = hn::Sub(hn::Mul(x[0], y[2]), hn::Mul(y[0], x[2]));
    const V w = hn::Sub(hn::Mul(x[1], y[0]), hn::Mul(y[1], x[0]));
    const V zero = hn::Zero(d);
    const auto is_candidate = hn::Or(hn::Ge(smaller(u, smaller(v, w)), zero), hn::Le(larger(u, larger(v, w)), zero));
    if (HWY_LIKELY(hn::AllFalse(d, is_candidate))) return;

    uint32_t left = bits_of(d, is_candidate);
#if HWY_MAX_BYTES >= 32
    // The operations of `intersect_plane`.
    const hn::Rebind<double, BlockTag> wide;
    const auto promote = [&](V lanes) HWY_ATTR { return hn::PromoteTo(wide, lanes); };
    const auto ax = promote(x[0]), bx = promote(x[1]), cx = promote(x[2]);
    const auto ay = promote(y[0]), by = promote(y[1]), cy = promote(y[2]);
    const auto du = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto dv = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto dw = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const auto none = hn::Zero(wide);
    const auto is_inside = hn::Or(hn::And(hn::And(hn::Ge(du, none), hn::Ge(dv, none)), hn::Ge(dw, none)),
                                  hn::And(hn::And(hn::Le(du, none), hn::Le(dv, none)), hn::Le(dw, none)));
    const auto inverse_area = hn::Div(hn::Set(wide, 1.0), hn::Add(hn::Add(du, dv), dw));
    const auto along = hn::Add(hn::Add(hn::Mul(du, promote(z[0])), hn::Mul(dv, promote(z[1]))), hn::Mul(dw, promote(z[2])));
    const auto dt = hn::Mul(hn::Mul(along, inverse_area), hn::Set(wide, double(ray.shear[2])));
    // What is below can only move t farther.
    const auto is_placed = hn::And(hn::Ge(dt, none), hn::Le(dt, hn::Set(wide, double(std::numeric_limits<float>::max()))));
    left &= bits_of(wide, hn::And(is_inside, is_placed));
    const V t_plane = hn::DemoteTo(d, dt);
    left &= bits_of(d, hn::Le(t_plane, hn::Set(d, t_max)));
    if (left == 0) return;
    HWY_ALIGN float ts[kSize], us[kSize], vs[kSize];
    hn::Store(t_plane, d, ts);
    hn::Store(hn::DemoteTo(d, hn::Mul(dv, inverse_area)), d, us);
    hn::Store(hn::DemoteTo(d, hn::Mul(dw, inverse_area)), d, vs);
#else
    HWY_ALIGN float xs[3][kSize], ys[3][kSize], zs[3][kSize];
    for (int k = 0; k < 3; ++k) {
        hn::Store(x[k], d, xs[k]);
        hn::Store(y[k], d, ys[k]);
        hn::Store(z[k], d, zs[k]);
    }
    HWY_ALIGN float ts[kSize], us[kSize], vs[kSize];
    uint32_t candidates = left;
    left = 0;
    for (; candidates != 0; candidates &= candidates - 1) {
        const int slot = std::countr_zero(candidates);
        const ShearedCorners sheared = {{xs[0][slot], xs[1][slot], xs[2][slot]},
                                        {ys[0][slot], ys[1][slot], ys[2][slot]},
                                        {zs[0][slot], zs[1][slot], zs[2][slot]}};
        // What is below can only move t farther.
        TriangleHit hit;
        if (!intersect_plane(sheared, ray.shear[2], &hit) || hit.t > t_max) continue;
        left |= 1u << slot;
        ts[slot] = hit.t, us[slot] = hit.u, vs[slot] = hit.v;
    }
#endif
    if (left == 0) return;
    // `entry` into each triangle's own box.
    V in = zero, out = hn::Set(d, std::numeric_limits<float>::infinity());
    for (int axis = 0; axis < 3; ++axis) {
        const float* row = corners + kSize * axis;
        const V a = hn::Load(d, row), b = hn::Load(d, row + 3 * kSize), c = hn::Load(d, row + 6 * kSize);
        const V lo = smaller(c, smaller(b, a)), hi = larger(c, larger(b, a));
        const V origin = hn::Set(d, ray.origin[axis]), inverse = hn::Set(d, ray.inverse[axis]);
        const auto is_negative =
            hn::MaskFromVec(hn::BitCast(d, hn::Set(hn::RebindToUnsigned<BlockTag>(), ray.negative[axis])));
        in = larger(hn::Mul(hn::Sub(hn::IfThenElse(is_negative, hi, lo), origin), inverse), in);
        out = smaller(hn::Mul(hn::Sub(hn::IfThenElse(is_negative, lo, hi), origin), inverse), out);
    }
    in = hn::Mul(in, hn::Set(d, 1.0f - kBoxPad));
    out = hn::Mul(out, hn::Set(d, 1.0f + kBoxPad));
    left &= bits_of(d, hn::Le(in, out));
    HWY_ALIGN float entries[kSize];
    hn::Store(in, d, entries);
    for (; left != 0; left &= left - 1) {
        const int slot = std::countr_zero(left);
        const float t = std::max(std::max(ts[slot], floor()), entries[slot]);
        if (t >= t_min && t <= t_max && t < std::numeric_limits<float>::infinity()) {
            found(t, us[slot], vs[slot], block.primitive[slot]);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
