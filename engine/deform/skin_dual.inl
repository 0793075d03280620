// Compiled once an instruction set by skin_kernels.cpp: vertices that follow the weighted sum of dual quaternions.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// Of weights whose sum is about 1, no sum has a square of less, unless negative weights cancel.
constexpr float kLeastSquare = 1e-30f;

// Of each lane a dual quaternion.
struct Duals {
    Vectors real, dual;
    Floats real_w, dual_w;
};

// A chunk's motions of one influence, vertex by vertex, and their weights; and what is made of them.
struct DualMemory {
    alignas(64) float real[4 * kChunk] = {}, dual[4 * kChunk] = {}, weights[kChunk] = {};
    uint16_t pivot_joints[kChunk];  // Those of the heaviest influence.
    Duals pivots[kChunk / kWidth], sums[kChunk / kWidth];
    Floats weight_sums[kChunk / kWidth];

    HWY_INLINE void put(size_t lane, const PackedMotion& motion) {
        const QuadTag quad;
        hn::Store(hn::Load(quad, motion.real), quad, real + 4 * lane);
        hn::Store(hn::Load(quad, motion.dual), quad, dual + 4 * lane);
    }
    HWY_INLINE Duals load(size_t lane) const {
        const FloatTag d;
        Duals q;
        hn::LoadInterleaved4(d, real + 4 * lane, q.real.x, q.real.y, q.real.z, q.real_w);
        hn::LoadInterleaved4(d, dual + 4 * lane, q.dual.x, q.dual.y, q.dual.z, q.dual_w);
        return q;
    }
};

HWY_INLINE Floats dot4(const Duals& a, const Duals& b) {
    return hn::Add(dot(a.real, b.real), hn::Mul(a.real_w, b.real_w));
}

HWY_INLINE Vectors choose(hn::Mask<FloatTag> mask, const Vectors& yes, const Vectors& no) {
    return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

// The influence of the largest weight; the first, where none has any.
HWY_INLINE uint32_t heaviest(const float* weights, uint32_t count) {
    uint32_t best = 0;
    float most = std::abs(weights[0]);
    for (uint32_t k = 1; k < count; ++k) {
        const float weight = std::abs(weights[k]);
        best = weight > most ? k : best;
        most = std::max(weight, most);
    }
    return best;
}

// The weighted sum of each vertex's motions. q and -q are one motion: each counts with the sign that is nearer to the
// heaviest's.
HWY_INLINE void blend_duals(const SkinWork& work, size_t first, size_t count, DualMemory* memory) {
    const FloatTag d;
    const uint32_t influence_count = work.influence_count;
    const PackedMotion* const motions = work.packed->motions.data();
    for (size_t lane = 0; lane < count; ++lane) {
        const size_t at = (first + lane) * influence_count;
        memory->pivot_joints[lane] = work.joints[at + heaviest(work.weights + at, influence_count)];
        memory->put(lane, motions[memory->pivot_joints[lane]]);
    }
    const Floats zero = hn::Zero(d);
    for (size_t lane = 0; lane < count; lane += kWidth) {
        memory->pivots[lane / kWidth] = memory->load(lane);
        memory->sums[lane / kWidth] = {{zero, zero, zero}, {zero, zero, zero}, zero, zero};
        memory->weight_sums[lane / kWidth] = zero;
    }
    for (uint32_t k = 0; k < influence_count; ++k) {
        for (size_t lane = 0; lane < count; ++lane) {
            const size_t at = (first + lane) * influence_count + k;
            const float weight = work.weights[at];
            // Without weight, any motion will do that is finite where the sum is.
            memory->put(lane, motions[weight == 0.0f ? memory->pivot_joints[lane] : work.joints[at]]);
            memory->weights[lane] = weight;
        }
        for (size_t lane = 0; lane < count; lane += kWidth) {
            const Duals q = memory->load(lane);
            Duals& sum = memory->sums[lane / kWidth];
            const Floats weight = hn::Load(d, memory->weights + lane);
            const auto is_far = hn::Lt(dot4(q, memory->pivots[lane / kWidth]), zero);
            const Floats signed_weight = hn::IfThenElse(is_far, hn::Neg(weight), weight);
            sum.real = add(sum.real, scale(q.real, signed_weight));
            sum.dual = add(sum.dual, scale(q.dual, signed_weight));
            sum.real_w = hn::Add(sum.real_w, hn::Mul(q.real_w, signed_weight));
            sum.dual_w = hn::Add(sum.dual_w, hn::Mul(q.dual_w, signed_weight));
            memory->weight_sums[lane / kWidth] = hn::Add(memory->weight_sums[lane / kWidth], weight);
        }
    }
}

// Of length 1. Where nothing is left of a sum, the heaviest motion alone.
HWY_INLINE Duals normalized(const Duals& q, const Duals& pivot) {
    const FloatTag d;
    const auto is_nothing = hn::Lt(dot4(q, q), hn::Set(d, kLeastSquare));
    const Duals sum = {choose(is_nothing, pivot.real, q.real), choose(is_nothing, pivot.dual, q.dual),
                       hn::IfThenElse(is_nothing, pivot.real_w, q.real_w),
                       hn::IfThenElse(is_nothing, pivot.dual_w, q.dual_w)};
    const Floats to_unit = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(dot4(sum, sum)));
    return {scale(sum.real, to_unit), scale(sum.dual, to_unit), hn::Mul(sum.real_w, to_unit), hn::Mul(sum.dual_w, to_unit)};
}

HWY_INLINE Vectors twice(const Vectors& v) {
    return add(v, v);
}

// v + 2 real x (real x v + real_w v)
HWY_INLINE Vectors turn(const Duals& q, const Vectors& v) {
    return add(v, twice(cross(q.real, add(cross(q.real, v), scale(v, q.real_w)))));
}

// 2 (real_w dual - dual_w real + real x dual)
HWY_INLINE Vectors translation(const Duals& q) {
    const Vectors along = add(scale(q.dual, q.real_w), scale(q.real, hn::Neg(q.dual_w)));
    return twice(add(along, cross(q.real, q.dual)));
}

HWY_INLINE Affines divide(Affines m, Floats by) {
    for (int row = 0; row < 3; ++row) {
        m.rows[row] = {hn::Div(m.rows[row].x, by), hn::Div(m.rows[row].y, by), hn::Div(m.rows[row].z, by)};
        m.translation[row] = hn::Div(m.translation[row], by);
    }
    return m;
}

HWY_INLINE void move_dual(const SkinWork& work, size_t first, size_t count, RowMemory* rows, DualMemory* duals) {
    const FloatTag d;
    const bool is_stretched = !work.packed->affines.empty();
    if (is_stretched) blend_chunk<0, false>(work, first, count, rows);
    blend_duals(work, first, count, duals);
    const Floats common = hn::Set(d, work.packed->common_scale);
    for (size_t lane = 0; lane < count; lane += kWidth) {
        Group group;
        group.load(work, first, lane, count);
        if (is_stretched) {
            // The motion is the same whatever the weights' sum; so be the stretch. Weightless vertices have that of a joint.
            const Floats sum = duals->weight_sums[lane / kWidth];
            const auto is_zero = hn::Eq(sum, hn::Zero(d));
            const Affines stretch = divide(load(*rows, lane), hn::IfThenElse(is_zero, hn::Set(d, 1.0f), sum));
            group.positions = stretch.point(group.positions);
            if (work.normals) group.normals = stretch.normal(group.normals);
        }
        const Duals q = normalized(duals->sums[lane / kWidth], duals->pivots[lane / kWidth]);
        group.positions = scale(add(turn(q, group.positions), translation(q)), common);
        if (work.normals) {
            group.normals = turn(q, group.normals);
            if (work.packed->common_scale < 0.0f) group.normals = scale(group.normals, hn::Set(d, -1.0f));
        }
        group.store(work, first, lane, count);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
