#include "engine/deform/stencil_kernels.h"

#include <algorithm>

#include "engine/math/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/deform/stencil_kernels.cpp"
#include <hwy/foreach_target.h>  // Compiles what follows once an instruction set.
#include <hwy/highway.h>

// In this order, each of which reads the one before it:
#include "engine/deform/vectors.inl"

#include "engine/deform/quads.inl"

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

using DoubleTag = hn::FixedTag<double, kWidth / 2>;
using Doubles = hn::Vec<DoubleTag>;

// Of a vertex: the sums of its position and of both tangents are the three quads. Terms are added in the stencil's order.
// kPoint     of the four at `k`.
template <int kPoint>
HWY_INLINE void add_point(const StencilWork& work, uint32_t k, const Quads& weights, Quads* sums) {
    const Floats point = hn::LoadDup128(FloatTag(), &work.cage[work.stencils->indices[k + kPoint]].x);
    for (size_t part = 0; part < kParts; ++part) {
        sums->parts[part] = hn::Add(sums->parts[part], hn::Mul(hn::Broadcast<kPoint>(weights.parts[part]), point));
    }
}

// The weights of four points, each quad with those of its sum.
HWY_INLINE Quads load_weights(const StencilTable& stencils, uint32_t k) {
    const QuadTag quad;
    const float *w = stencils.weights.data() + k, *u = stencils.u_weights.data() + k, *v = stencils.v_weights.data() + k;
    Quads weights;
#if HWY_MAX_BYTES >= 64
    const FloatTag d;
    const hn::Half<FloatTag> half;
    const auto low = hn::Combine(half, hn::LoadU(quad, u), hn::LoadU(quad, w));
    weights.parts[0] = hn::Combine(d, hn::ZeroExtendVector(half, hn::LoadU(quad, v)), low);
#elif HWY_MAX_BYTES >= 32
    const FloatTag d;
    weights.parts[0] = hn::Combine(d, hn::LoadU(quad, u), hn::LoadU(quad, w));
    weights.parts[1] = hn::LoadDup128(d, v);
#else
    weights.parts[0] = hn::LoadU(quad, w);
    weights.parts[1] = hn::LoadU(quad, u);
    weights.parts[2] = hn::LoadU(quad, v);
#endif
    return weights;
}

HWY_INLINE void sum_with_tangents(const StencilWork& work, size_t vertex, size_t lane, QuadMemory* memory) {
    const StencilTable& stencils = *work.stencils;
    Quads sums = zero_quads();
    for (uint32_t k = stencils.offsets[vertex]; k < stencils.offsets[vertex + 1]; k += 4) {
        const Quads weights = load_weights(stencils, k);
        add_point<0>(work, k, weights, &sums);
        add_point<1>(work, k, weights, &sums);
        add_point<2>(work, k, weights, &sums);
        add_point<3>(work, k, weights, &sums);
    }
    store(sums, lane, memory);
}

HWY_INLINE void sum_position(const StencilWork& work, size_t vertex, size_t lane, QuadMemory* memory) {
    const QuadTag quad;
    const StencilTable& stencils = *work.stencils;
    const auto point = [&](uint32_t k) { return hn::Load(quad, &work.cage[stencils.indices[k]].x); };
    auto sum = hn::Zero(quad);
    for (uint32_t k = stencils.offsets[vertex]; k < stencils.offsets[vertex + 1]; k += 4) {
        const auto weights = hn::LoadU(quad, &stencils.weights[k]);
        sum = hn::Add(sum, hn::Mul(hn::Broadcast<0>(weights), point(k)));
        sum = hn::Add(sum, hn::Mul(hn::Broadcast<1>(weights), point(k + 1)));
        sum = hn::Add(sum, hn::Mul(hn::Broadcast<2>(weights), point(k + 2)));
        sum = hn::Add(sum, hn::Mul(hn::Broadcast<3>(weights), point(k + 3)));
    }
    hn::Store(sum, quad, memory->of[0] + 4 * place_of(lane));
}

HWY_INLINE Vectors load(const QuadMemory& memory, size_t quad, size_t lane) {
    Vectors v;
    Floats unused;
    transpose(memory.of[quad] + 4 * lane, &v.x, &v.y, &v.z, &unused);
    return v;
}

// u x v, of length 1; zero where it has no direction. In double: squares of squares of small tangents would vanish.
struct Normals {
    Doubles x, y, z;

    template <typename HalfFloats>
    HWY_INLINE Normals(const HalfFloats& ux, const HalfFloats& uy, const HalfFloats& uz, const HalfFloats& vx,
                       const HalfFloats& vy, const HalfFloats& vz) {
        const DoubleTag d;
        const auto wide = [d](const HalfFloats& v) { return hn::PromoteTo(d, v); };
        const auto cross = [&](const HalfFloats& a, const HalfFloats& b, const HalfFloats& c, const HalfFloats& e) {
            return hn::Sub(hn::Mul(wide(a), wide(b)), hn::Mul(wide(c), wide(e)));
        };
        x = cross(uy, vz, vy, uz);
        y = cross(uz, vx, vz, ux);
        z = cross(ux, vy, vx, uy);
        const Doubles square = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
        const auto has_direction = hn::Gt(square, hn::Zero(d));
        const Doubles to_unit = hn::Div(hn::Set(d, 1.0), hn::Sqrt(square));
        x = hn::IfThenElseZero(has_direction, hn::Mul(x, to_unit));
        y = hn::IfThenElseZero(has_direction, hn::Mul(y, to_unit));
        z = hn::IfThenElseZero(has_direction, hn::Mul(z, to_unit));
    }
};

HWY_INLINE Vectors normals_of(const Vectors& u, const Vectors& v) {
    const FloatTag d;
    const hn::Half<FloatTag> half;
    const auto low_of = [&](Floats f) { return hn::LowerHalf(half, f); };
    const auto high_of = [&](Floats f) { return hn::UpperHalf(half, f); };
    const Normals low(low_of(u.x), low_of(u.y), low_of(u.z), low_of(v.x), low_of(v.y), low_of(v.z));
    const Normals high(high_of(u.x), high_of(u.y), high_of(u.z), high_of(v.x), high_of(v.y), high_of(v.z));
    const auto join = [&](const Doubles& high_half, const Doubles& low_half) {
        return hn::Combine(d, hn::DemoteTo(half, high_half), hn::DemoteTo(half, low_half));
    };
    return {join(high.x, low.x), join(high.y, low.y), join(high.z, low.z)};
}

void sum_stencils_range(const StencilWork& work, size_t begin, size_t end) {
    QuadMemory memory;
    for (size_t first = begin; first < end; first += kChunk) {
        const size_t count = std::min(kChunk, end - first);
        for (size_t lane = 0; lane < count; ++lane) {
            if (work.normals) {
                sum_with_tangents(work, first + lane, lane, &memory);
            } else {
                sum_position(work, first + lane, lane, &memory);
            }
        }
        for (size_t lane = 0; lane < count; lane += kWidth) {
            store_vectors(load(memory, 0, lane), count - lane, work.positions + first + lane);
            if (!work.normals) continue;
            const Vectors normals = normals_of(load(memory, 1, lane), load(memory, 2, lane));
            store_vectors(normals, count - lane, work.normals + first + lane);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace zoe {

HWY_EXPORT(sum_stencils_range);

void sum_stencils(const StencilWork& work, size_t begin, size_t end) {
    HWY_DYNAMIC_DISPATCH(sum_stencils_range)(work, begin, end);
}

}  // namespace zoe

#endif  // HWY_ONCE
