// Compiled once an instruction set by skin_kernels.cpp: vertices that are skinned together.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

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
