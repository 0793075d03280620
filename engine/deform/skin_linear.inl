// Compiled once an instruction set by skin_kernels.cpp: vertices that follow the weighted sum of matrices.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// The rows of a chunk's matrices, row by row, vertex by vertex.
struct RowMemory {
    alignas(64) float rows[3][4 * kChunk] = {};
};

// A matrix as the instruction set holds it.
constexpr size_t kParts = (12 + kWidth - 1) / kWidth;
struct Matrix {
    Floats parts[kParts];
};

HWY_INLINE void store(const Matrix& m, size_t lane, RowMemory* memory) {
    const QuadTag quad;
#if HWY_MAX_BYTES >= 64
    const hn::Half<FloatTag> half;
    const auto low = hn::LowerHalf(half, m.parts[0]), high = hn::UpperHalf(half, m.parts[0]);
    hn::Store(hn::LowerHalf(quad, low), quad, memory->rows[0] + 4 * lane);
    hn::Store(hn::UpperHalf(quad, low), quad, memory->rows[1] + 4 * lane);
    hn::Store(hn::LowerHalf(quad, high), quad, memory->rows[2] + 4 * lane);
#elif HWY_MAX_BYTES >= 32
    hn::Store(hn::LowerHalf(quad, m.parts[0]), quad, memory->rows[0] + 4 * lane);
    hn::Store(hn::UpperHalf(quad, m.parts[0]), quad, memory->rows[1] + 4 * lane);
    hn::Store(hn::LowerHalf(quad, m.parts[1]), quad, memory->rows[2] + 4 * lane);
#else
    for (size_t part = 0; part < kParts; ++part) hn::Store(m.parts[part], quad, memory->rows[part] + 4 * lane);
#endif
}

template <uint32_t kCount>
HWY_INLINE bool is_weightless(const float* weights, uint32_t influence_count) {
    if (kCount == 4) {
        // Without the signs, the bits of 0 are 0.
        uint64_t bits[2];
        std::memcpy(bits, weights, sizeof bits);
        return ((bits[0] | bits[1]) & 0x7fffffff7fffffffu) == 0;
    }
    return std::all_of(weights, weights + influence_count, [](float weight) { return weight == 0.0f; });
}

// Weighted sum of a vertex's joint matrices. No weight at all: the first joint of its list.
// kCount       how many influences a vertex has; 0: as the work says.
// kSkipsZero   some matrix is not finite: it must not be multiplied with 0.
template <uint32_t kCount, bool kSkipsZero>
HWY_INLINE Matrix blend(const SkinWork& work, size_t vertex) {
    const FloatTag d;
    const uint32_t influence_count = kCount > 0 ? kCount : work.influence_count;
    const float* const weights = work.weights + vertex * influence_count;
    const uint16_t* const joints = work.joints + vertex * influence_count;
    const PackedAffine* const affines = work.packed->affines.data();
    Matrix sum;
    if (HWY_UNLIKELY(is_weightless<kCount>(weights, influence_count))) {
        const float* const first = affines[joints[0]].rows[0];
        for (size_t part = 0; part < kParts; ++part) sum.parts[part] = hn::Load(d, first + part * kWidth);
        return sum;
    }
    // From 0 on: a sum is never -0 then, and a joint without weight changes no bit of it.
    for (size_t part = 0; part < kParts; ++part) sum.parts[part] = hn::Zero(d);
    for (uint32_t k = 0; k < influence_count; ++k) {
        if (kSkipsZero && weights[k] == 0.0f) continue;
        const float* const matrix = affines[joints[k]].rows[0];
        const Floats weight = hn::Set(d, weights[k]);
        for (size_t part = 0; part < kParts; ++part) {
            sum.parts[part] = hn::Add(sum.parts[part], hn::Mul(weight, hn::Load(d, matrix + part * kWidth)));
        }
    }
    return sum;
}

template <uint32_t kCount, bool kSkipsZero>
HWY_INLINE void blend_chunk(const SkinWork& work, size_t first, size_t count, RowMemory* memory) {
    for (size_t lane = 0; lane < count; ++lane) store(blend<kCount, kSkipsZero>(work, first + lane), lane, memory);
}

HWY_INLINE Affines load(const RowMemory& memory, size_t lane) {
    const FloatTag d;
    Affines m;
    for (int row = 0; row < 3; ++row) {
        Vectors& to = m.rows[row];
        hn::LoadInterleaved4(d, memory.rows[row] + 4 * lane, to.x, to.y, to.z, m.translation[row]);
    }
    return m;
}

template <uint32_t kCount, bool kSkipsZero>
HWY_INLINE void move_linear(const SkinWork& work, size_t first, size_t count, RowMemory* memory) {
    blend_chunk<kCount, kSkipsZero>(work, first, count, memory);
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
