// Compiled once an instruction set by the kernels that read it: three quads of floats a vertex, which are rows of its matrix
// or sums of its stencil, side by side in as few vectors as hold them.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

constexpr size_t kParts = (12 + kWidth - 1) / kWidth;

struct Quads {
    Floats parts[kParts];
};

// Those of a chunk: first quads, second ones, third ones, each vertex by vertex.
struct QuadMemory {
    alignas(64) float of[3][4 * kChunk] = {};
};

HWY_INLINE Quads zero_quads() {
    Quads zero;
    for (size_t part = 0; part < kParts; ++part) zero.parts[part] = hn::Zero(FloatTag());
    return zero;
}

HWY_INLINE void store(const Quads& quads, size_t lane, QuadMemory* memory) {
    const QuadTag quad;
#if HWY_MAX_BYTES >= 64
    const hn::Half<FloatTag> half;
    const auto low = hn::LowerHalf(half, quads.parts[0]), high = hn::UpperHalf(half, quads.parts[0]);
    hn::Store(hn::LowerHalf(quad, low), quad, memory->of[0] + 4 * lane);
    hn::Store(hn::UpperHalf(quad, low), quad, memory->of[1] + 4 * lane);
    hn::Store(hn::LowerHalf(quad, high), quad, memory->of[2] + 4 * lane);
#elif HWY_MAX_BYTES >= 32
    hn::Store(hn::LowerHalf(quad, quads.parts[0]), quad, memory->of[0] + 4 * lane);
    hn::Store(hn::UpperHalf(quad, quads.parts[0]), quad, memory->of[1] + 4 * lane);
    hn::Store(hn::LowerHalf(quad, quads.parts[1]), quad, memory->of[2] + 4 * lane);
#else
    for (size_t part = 0; part < kParts; ++part) hn::Store(quads.parts[part], quad, memory->of[part] + 4 * lane);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
