// Compiled once an instruction set by skin_kernels.cpp: vertices that follow the weighted sum of matrices.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

HWY_INLINE Quads load_affine(const SkinWork& work, size_t joint) {
    const float* const from = work.packed->affines[joint].rows[0];
    Quads affine;
    for (size_t part = 0; part < kParts; ++part) affine.parts[part] = hn::Load(FloatTag(), from + part * kWidth);
    return affine;
}

HWY_INLINE void add_weighted(const Quads& affine, Floats weight, Quads* sum) {
    for (size_t part = 0; part < kParts; ++part) {
        sum->parts[part] = hn::Add(sum->parts[part], hn::Mul(weight, affine.parts[part]));
    }
}

// Weighted sum of a vertex's joint matrices. No weight at all: the first joint of its list. Sums go from 0 on: they are
// never -0 then, and a joint without weight changes no bit of them. kSkipsZero   some matrix is not finite: it must not be
// multiplied with 0.
template <bool kSkipsZero>
HWY_INLINE Quads blend_any(const SkinWork& work, size_t vertex) {
    const float* const weights = work.weights + vertex * work.influence_count;
    const uint16_t* const joints = work.joints + vertex * work.influence_count;
    bool is_weighted = false;
    for (uint32_t k = 0; k < work.influence_count; ++k) is_weighted |= weights[k] != 0.0f;
    if (HWY_UNLIKELY(!is_weighted)) return load_affine(work, joints[0]);
    Quads sum = zero_quads();
    for (uint32_t k = 0; k < work.influence_count; ++k) {
        if (kSkipsZero && weights[k] == 0.0f) continue;
        add_weighted(load_affine(work, joints[k]), hn::Set(FloatTag(), weights[k]), &sum);
    }
    return sum;
}

// The same of four, some of which is not 0.
HWY_INLINE Quads blend_four(const SkinWork& work, size_t vertex) {
    const uint16_t* const joints = work.joints + 4 * vertex;
    const float* const weights = work.weights + 4 * vertex;
    Quads sum = zero_quads();
    for (int k = 0; k < 4; ++k) add_weighted(load_affine(work, joints[k]), hn::Set(FloatTag(), weights[k]), &sum);
    return sum;
}

// Tells whether some vertex of a whole chunk, of four influences each, has no weight at all. Folded twice, each vertex's
// weights are one lane, wherever that is.
HWY_INLINE bool has_weightless(const float* weights) {
    const FloatTag d;
    auto is_any = hn::MaskFromVec(hn::Zero(d));
    const auto fold = [&](Floats a, Floats b) { return hn::Or(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b)); };
    for (size_t lane = 0; lane < kChunk; lane += kWidth) {
        const auto at = [&](size_t k) { return hn::LoadU(d, weights + 4 * lane + k * kWidth); };
        const Floats bits = fold(fold(at(0), at(1)), fold(at(2), at(3)));
        is_any = hn::Or(is_any, hn::Eq(hn::Abs(bits), hn::Zero(d)));
    }
    return !hn::AllFalse(d, is_any);
}

HWY_INLINE void blend_chunk(const SkinWork& work, size_t first, size_t count, QuadMemory* memory) {
    const bool is_whole = count == kChunk && work.influence_count == 4;
    if (!work.packed->is_finite) {
        for (size_t lane = 0; lane < count; ++lane) store(blend_any<true>(work, first + lane), lane, memory);
    } else if (is_whole && !has_weightless(work.weights + 4 * first)) {
        for (size_t lane = 0; lane < kChunk; ++lane) store(blend_four(work, first + lane), lane, memory);
    } else {
        for (size_t lane = 0; lane < count; ++lane) store(blend_any<false>(work, first + lane), lane, memory);
    }
}

HWY_INLINE Affines load(const QuadMemory& memory, size_t lane) {
    Affines m;
    for (int row = 0; row < 3; ++row) {
        Vectors& to = m.rows[row];
        transpose(memory.of[row] + 4 * lane, &to.x, &to.y, &to.z, &m.translation[row]);
    }
    return m;
}

HWY_INLINE void move_linear(const SkinWork& work, size_t first, size_t count, QuadMemory* memory) {
    blend_chunk(work, first, count, memory);
    for (size_t lane = 0; lane < count; lane += kWidth) {
        Group group;
        group.load(work, first, lane, count);
        const Affines m = load(*memory, lane);
        group.positions = m.point(group.positions);
        if (work.normals) group.normals = m.normal(group.normals);
        group.store(work, first, lane, count);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
