// Compiled once an instruction set by the kernels that read it: three quads of floats a vertex, which are rows of its matrix
// or sums of its stencil, side by side in as few vectors as hold them.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

constexpr size_t kParts = (12 + kWidth - 1) / kWidth;

struct Quads {
    Floats parts[kParts];
};

// Those of a chunk: first quads, second ones, third ones, each in the order of `place_of`.
struct QuadMemory {
    alignas(64) float of[3][4 * kChunk] = {};
};

HWY_INLINE Quads zero_quads() {
    Quads zero;
    for (size_t part = 0; part < kParts; ++part) zero.parts[part] = hn::Zero(FloatTag());
    return zero;
}

// Which of a chunk's quads is that of a lane. Vertices of a vector's width stand so that every fourth is in one vector: what
// is then transposed block by block, without a shuffle across blocks, comes out in order.
HWY_INLINE size_t place_of(size_t lane) {
    const size_t within = lane % kWidth;
    return lane - within + within % 4 * (kWidth / 4) + within / 4;
}

// The quads of a vector's width of vertices, coordinate by coordinate.
HWY_INLINE void transpose(const float* from, Floats* x, Floats* y, Floats* z, Floats* w) {
    const FloatTag d;
    const Floats a = hn::Load(d, from), b = hn::Load(d, from + kWidth), c = hn::Load(d, from + 2 * kWidth),
                 e = hn::Load(d, from + 3 * kWidth);
    const Floats ac_low = hn::InterleaveLower(d, a, c), be_low = hn::InterleaveLower(d, b, e);
    const Floats ac_high = hn::InterleaveUpper(d, a, c), be_high = hn::InterleaveUpper(d, b, e);
    *x = hn::InterleaveLower(d, ac_low, be_low);
    *y = hn::InterleaveUpper(d, ac_low, be_low);
    *z = hn::InterleaveLower(d, ac_high, be_high);
    *w = hn::InterleaveUpper(d, ac_high, be_high);
}

HWY_INLINE void store(const Quads& quads, size_t lane, QuadMemory* memory) {
    const size_t place = 4 * place_of(lane);
    const QuadTag quad;
#if HWY_MAX_BYTES >= 64
    const hn::Half<FloatTag> half;
    const auto low = hn::LowerHalf(half, quads.parts[0]), high = hn::UpperHalf(half, quads.parts[0]);
    hn::Store(hn::LowerHalf(quad, low), quad, memory->of[0] + place);
    hn::Store(hn::UpperHalf(quad, low), quad, memory->of[1] + place);
    hn::Store(hn::LowerHalf(quad, high), quad, memory->of[2] + place);
#elif HWY_MAX_BYTES >= 32
    hn::Store(hn::LowerHalf(quad, quads.parts[0]), quad, memory->of[0] + place);
    hn::Store(hn::UpperHalf(quad, quads.parts[0]), quad, memory->of[1] + place);
    hn::Store(hn::LowerHalf(quad, quads.parts[1]), quad, memory->of[2] + place);
#else
    for (size_t part = 0; part < kParts; ++part) hn::Store(quads.parts[part], quad, memory->of[part] + place);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
