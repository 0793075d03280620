// Compiled once an instruction set by skin_kernels.cpp: a vector's width of vertices, coordinate by coordinate. Lanes are
// worked on alike and nothing is fused, so that all widths give the same bits.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, 16>;
using QuadTag = hn::FixedTag<float, 4>;
using Floats = hn::Vec<FloatTag>;
constexpr size_t kWidth = hn::MaxLanes(FloatTag());

// What joints do to so many vertices is written to memory before it is read again in other vectors: by then it has arrived.
// Lanes behind the last vertex hold anything; nothing of theirs is kept.
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

// A vector's width of vertices.
struct Group {
    Vectors positions, normals;

    // Those of a chunk of `count` vertices from its `lane` on.
    HWY_INLINE void load(const SkinWork& work, size_t first, size_t lane, size_t count) {
        positions = load_vectors(work.positions + first + lane, count - lane);
        if (work.normals) normals = load_vectors(work.normals + first + lane, count - lane);
    }
    HWY_INLINE void store(const SkinWork& work, size_t first, size_t lane, size_t count) const {
        store_vectors(positions, count - lane, work.skinned_positions + first + lane);
        if (work.normals) store_vectors(normals, count - lane, work.skinned_normals + first + lane);
    }

private:
    static HWY_INLINE Vectors load_vectors(const glm::vec3* from, size_t count) {
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
    static HWY_INLINE void store_vectors(const Vectors& v, size_t count, glm::vec3* to) {
        const FloatTag d;
        if (HWY_LIKELY(count >= kWidth)) {
            hn::StoreInterleaved3(v.x, v.y, v.z, d, &to->x);
        } else {
            glm::vec3 padded[kWidth];
            hn::StoreInterleaved3(v.x, v.y, v.z, d, &padded->x);
            std::copy_n(padded, count, to);
        }
    }
};

// Of each lane an affine map, by rows.
struct Affines {
    Vectors rows[3];
    Floats translation[3];

    HWY_INLINE Vectors point(const Vectors& p) const {
        return {hn::Add(dot(rows[0], p), translation[0]), hn::Add(dot(rows[1], p), translation[1]),
                hn::Add(dot(rows[2], p), translation[2])};
    }
    // The cofactor matrix is the inverse transpose times the determinant: its sign keeps normals outside, and it is fine
    // for flattened maps.
    // Always: a sum of rotations flattens, too, and a test for what needs it costs what it saves.
    HWY_INLINE Vectors normal(const Vectors& n) const {
        const Vectors x = cross(rows[1], rows[2]), y = cross(rows[2], rows[0]), z = cross(rows[0], rows[1]);
        const auto is_mirror = hn::Lt(dot(rows[0], x), hn::Zero(FloatTag()));
        const Vectors turned = {dot(x, n), dot(y, n), dot(z, n)};
        return {hn::IfThenElse(is_mirror, hn::Neg(turned.x), turned.x),
                hn::IfThenElse(is_mirror, hn::Neg(turned.y), turned.y),
                hn::IfThenElse(is_mirror, hn::Neg(turned.z), turned.z)};
    }
};

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
