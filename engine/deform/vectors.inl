// Compiled once an instruction set by the kernels that read it: points and directions, a vector's width of them, coordinate
// by coordinate. Lanes are worked on alike and nothing is fused, so that all widths give the same bits.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;
using QuadTag = hn::FixedTag<float, 4>;
using Floats = hn::Vec<FloatTag>;
constexpr size_t kWidth = hn::MaxLanes(FloatTag());

// What is worked out vertex by vertex is written to memory for so many of them before it is read again in other vectors: by
// then it has arrived. Lanes behind the last vertex hold anything; nothing of theirs is kept.
constexpr size_t kChunk = 64;

// Of each lane a vector.
struct Vectors {
    Floats x, y, z;
};

HWY_INLINE Vectors add(const Vectors& a, const Vectors& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE Vectors scale(const Vectors& v, Floats by) {
    return {hn::Mul(v.x, by), hn::Mul(v.y, by), hn::Mul(v.z, by)};
}

HWY_INLINE Floats dot(const Vectors& a, const Vectors& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}

HWY_INLINE Vectors load_vectors(const glm::vec3* from, size_t count) {
    const FloatTag d;
    Vectors v;
    if (HWY_LIKELY(count >= kWidth)) {
        hn::LoadInterleaved3(d, &from->x, v.x, v.y, v.z);
    } else {
        glm::vec3 padded[kWidth] = {};
        std::copy_n(from, count, padded);
        hn::LoadInterleaved3(d, &padded->x, v.x, v.y, v.z);
    }
    return v;
}

HWY_INLINE void store_vectors(const Vectors& v, size_t count, glm::vec3* to) {
    const FloatTag d;
    if (HWY_LIKELY(count >= kWidth)) {
        hn::StoreInterleaved3(v.x, v.y, v.z, d, &to->x);
    } else {
        glm::vec3 padded[kWidth];
        hn::StoreInterleaved3(v.x, v.y, v.z, d, &padded->x);
        std::copy_n(padded, count, to);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
