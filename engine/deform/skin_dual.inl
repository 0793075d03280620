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

// What the motions of a vector's width of vertices are blended to.
struct Blend {
    Duals pivot;  // The motion of the largest weight; of no weight at all, the first one.
    Floats largest_weight;
    Duals sum;
    Floats weight_sum;
};

// A chunk's motions of so many influences, vertex by vertex, and their weights; and what is made of them.
constexpr uint32_t kBlock = 4;
struct DualMemory {
    alignas(64) float real[kBlock][4 * kChunk] = {}, dual[kBlock][4 * kChunk] = {}, weights[kBlock * kChunk] = {};
    Blend blends[kChunk / kWidth];
};

// The influences of a block, of a vector's width of vertices.
struct Block {
    Duals motions[kBlock];
    Floats weights[kBlock];

    HWY_INLINE Block(const DualMemory& memory, size_t lane) {
        const FloatTag d;
        hn::LoadInterleaved4(d, memory.weights + kBlock * lane, weights[0], weights[1], weights[2], weights[3]);
        for (uint32_t k = 0; k < kBlock; ++k) {
            Duals& q = motions[k];
            hn::LoadInterleaved4(d, memory.real[k] + 4 * lane, q.real.x, q.real.y, q.real.z, q.real_w);
            hn::LoadInterleaved4(d, memory.dual[k] + 4 * lane, q.dual.x, q.dual.y, q.dual.z, q.dual_w);
        }
    }
};

HWY_INLINE Floats dot4(const Duals& a, const Duals& b) {
    return hn::Add(dot(a.real, b.real), hn::Mul(a.real_w, b.real_w));
}

HWY_INLINE Vectors choose(hn::Mask<FloatTag> mask, const Vectors& yes, const Vectors& no) {
    return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

HWY_INLINE Duals choose(hn::Mask<FloatTag> mask, const Duals& yes, const Duals& no) {
    return {choose(mask, yes.real, no.real), choose(mask, yes.dual, no.dual), hn::IfThenElse(mask, yes.real_w, no.real_w),
            hn::IfThenElse(mask, yes.dual_w, no.dual_w)};
}

HWY_INLINE void put(const SkinWork& work, uint16_t joint, uint32_t k, size_t lane, DualMemory* memory) {
    const QuadTag quad;
    const PackedMotion& motion = work.packed->motions[joint];
    hn::Store(hn::Load(quad, motion.real), quad, memory->real[k] + 4 * lane);
    hn::Store(hn::Load(quad, motion.dual), quad, memory->dual[k] + 4 * lane);
}

// Puts the influences of a chunk from `begin` on into memory. Where there are less than four, any motion, without weight.
HWY_INLINE void put_block(const SkinWork& work, size_t first, size_t count, uint32_t begin, DualMemory* memory) {
    const QuadTag quad;
    const uint32_t there = std::min(kBlock, work.influence_count - begin);
    for (size_t lane = 0; lane < count; ++lane) {
        const size_t at = (first + lane) * work.influence_count + begin;
        if (HWY_LIKELY(there == kBlock)) {
            hn::Store(hn::LoadU(quad, work.weights + at), quad, memory->weights + kBlock * lane);
            for (uint32_t k = 0; k < kBlock; ++k) put(work, work.joints[at + k], k, lane, memory);
        } else {
            for (uint32_t k = 0; k < kBlock; ++k) {
                memory->weights[kBlock * lane + k] = k < there ? work.weights[at + k] : 0.0f;
                put(work, work.joints[k < there ? at + k : at], k, lane, memory);
            }
        }
    }
}

HWY_INLINE void choose_pivot(const Block& block, bool is_first, Blend* blend) {
    const FloatTag d;
    const Floats zero = hn::Zero(d);
    if (is_first) *blend = {block.motions[0], zero, {{zero, zero, zero}, {zero, zero, zero}, zero, zero}, zero};
    for (uint32_t k = 0; k < kBlock; ++k) {
        const Floats weight = hn::Abs(block.weights[k]);
        blend->pivot = choose(hn::Gt(weight, blend->largest_weight), block.motions[k], blend->pivot);
        blend->largest_weight = hn::Max(weight, blend->largest_weight);
    }
}

// q and -q are one motion: each counts with the sign that is nearer to the pivot's.
HWY_INLINE void add_block(const Block& block, Blend* blend) {
    const Floats zero = hn::Zero(FloatTag());
    for (uint32_t k = 0; k < kBlock; ++k) {
        const Floats weight = block.weights[k];
        // Without weight, any motion will do that is finite where the sum is.
        const Duals q = choose(hn::Eq(weight, zero), blend->pivot, block.motions[k]);
        const auto is_far = hn::Lt(dot4(q, blend->pivot), zero);
        const Floats signed_weight = hn::IfThenElse(is_far, hn::Neg(weight), weight);
        blend->sum.real = add(blend->sum.real, scale(q.real, signed_weight));
        blend->sum.dual = add(blend->sum.dual, scale(q.dual, signed_weight));
        blend->sum.real_w = hn::Add(blend->sum.real_w, hn::Mul(q.real_w, signed_weight));
        blend->sum.dual_w = hn::Add(blend->sum.dual_w, hn::Mul(q.dual_w, signed_weight));
        blend->weight_sum = hn::Add(blend->weight_sum, weight);
    }
}

// The weighted sum of each vertex's motions. All pivots come before the sums: of more influences than a block has, twice.
HWY_INLINE void blend_duals(const SkinWork& work, size_t first, size_t count, DualMemory* memory) {
    const bool is_one = work.influence_count <= kBlock;
    for (uint32_t begin = 0; begin < work.influence_count; begin += kBlock) {
        put_block(work, first, count, begin, memory);
        for (size_t lane = 0; lane < count; lane += kWidth) {
            const Block block(*memory, lane);
            choose_pivot(block, begin == 0, &memory->blends[lane / kWidth]);
            if (is_one) add_block(block, &memory->blends[lane / kWidth]);
        }
    }
    for (uint32_t begin = 0; begin < work.influence_count && !is_one; begin += kBlock) {
        put_block(work, first, count, begin, memory);
        for (size_t lane = 0; lane < count; lane += kWidth) add_block(Block(*memory, lane), &memory->blends[lane / kWidth]);
    }
}

// Of length 1. Where nothing is left of a sum, the heaviest motion alone.
HWY_INLINE Duals normalized(const Duals& q, const Duals& pivot) {
    const FloatTag d;
    const auto is_nothing = hn::Lt(dot4(q, q), hn::Set(d, kLeastSquare));
    const Duals sum = choose(is_nothing, pivot, q);
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

HWY_INLINE void move_dual(const SkinWork& work, size_t first, size_t count, QuadMemory* rows, DualMemory* duals) {
    const FloatTag d;
    const bool is_stretched = !work.packed->affines.empty();
    if (is_stretched) blend_chunk(work, first, count, rows);
    blend_duals(work, first, count, duals);
    const Floats common = hn::Set(d, work.packed->common_scale);
    for (size_t lane = 0; lane < count; lane += kWidth) {
        const Blend& blend = duals->blends[lane / kWidth];
        Group group;
        group.load(work, first, lane, count);
        if (is_stretched) {
            // The motion is the same whatever the weights' sum; so be the stretch. Weightless vertices have that of a joint.
            const Floats sum = blend.weight_sum;
            const auto is_zero = hn::Eq(sum, hn::Zero(d));
            const Affines stretch = divide(load(*rows, lane), hn::IfThenElse(is_zero, hn::Set(d, 1.0f), sum));
            group.positions = stretch.point(group.positions);
            if (work.normals) group.normals = stretch.normal(group.normals);
        }
        const Duals q = normalized(blend.sum, blend.pivot);
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
