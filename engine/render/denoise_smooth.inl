// Compiled once an instruction set by denoise_kernels.cpp: a round of the spatial filter.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// How fast weights fall with the angle between normals: to nothing at 1/8 from parallel, about 29 degrees.
constexpr float kNormalFalloff = 32.0f;
// Depths that differ by what the slope and this share of them explain are of one surface.
constexpr float kDepthTolerance = 0.002f;
// Light that differs by this share counts as equal, whatever its noise.
constexpr float kLightTolerance = 0.005f;
constexpr float kLeastLight = 1e-12f, kLeastDepth = 1e-30f;
constexpr float kCentre = 0.25f, kSide = 0.125f, kCorner = 0.0625f;

// The variance around pixels: a single one's is noisy itself. `above` and `below`: of the rows there, or at the border this.
HWY_INLINE Floats blurred(const float* above, const float* here, const float* below) {
    const FloatTag d;
    const auto at = [&](const float* row, int across) { return hn::LoadU(d, row + across); };
    const auto sum = [](const Floats& a, const Floats& b, const Floats& c, const Floats& e) {
        return hn::Add(hn::Add(hn::Add(a, b), c), e);
    };
    const Floats corners = sum(at(above, -1), at(above, 1), at(below, -1), at(below, 1));
    const Floats sides = sum(at(above, 0), at(below, 0), at(here, -1), at(here, 1));
    return hn::Add(hn::Add(hn::Mul(set(kCentre), at(here, 0)), hn::Mul(set(kSide), sides)), hn::Mul(set(kCorner), corners));
}

// What neighbours are compared by, and their sums.
struct Smoothing {
    Vectors normal;
    Floats depth, brightness, less_deep, less_bright;
    Vectors light;
    Floats variance, weight;

    // Adds pixels as far as they are alike. What is around the picture is infinitely deep.
    HWY_INLINE void add_those(const DenoiseShape& shape, const DenoiseLight& from, ptrdiff_t q, float kernel) {
        const FloatTag d;
        const Floats one = set(1.0f), zero = set(0.0f);
        const Floats cosine = dot(normal, load_normal(shape, q));
        const Floats turned = hn::Mul(set(kNormalFalloff), hn::Max(hn::Sub(one, cosine), zero));
        const Floats deeper = hn::Mul(hn::Abs(hn::Sub(depth, hn::LoadU(d, shape.depth.data() + q))), less_deep);
        const Vectors other = load_light(from, q);
        const Floats brighter = hn::Mul(hn::Abs(hn::Sub(brightness, luminance_of(other))), less_bright);
        // (1 - x / 4)^4: near to exp(-x), and 0 from 4 on.
        const Floats unlike = hn::Mul(set(0.25f), hn::Add(hn::Add(turned, deeper), brighter));
        const Floats like = hn::Max(hn::Sub(one, unlike), zero), square = hn::Mul(like, like);
        const Floats share = hn::Mul(set(kernel), hn::Mul(square, square));
        light = add(light, scale(other, share));
        variance = hn::Add(variance, hn::Mul(hn::Mul(share, share), hn::LoadU(d, from.variance.data() + q)));
        weight = hn::Add(weight, share);
    }
};

void smooth_range(const DenoiseGrid& grid, const DenoiseShape& shape, const DenoiseLight& from, size_t step, float strength,
                  DenoiseLight* to, size_t begin, size_t end) {
    const FloatTag d;
    const auto stride = static_cast<ptrdiff_t>(grid.stride()), far = static_cast<ptrdiff_t>(step),
               width = static_cast<ptrdiff_t>(grid.width), height = static_cast<ptrdiff_t>(grid.height);
    for (size_t r = begin; r < end; ++r) {
        const auto row = static_cast<ptrdiff_t>(r);
        const float* const variances = from.variance.data() + grid.first(row);
        const float *const above = row > 0 ? variances - stride : variances, *const below = row + 1 < height
                                                                                                ? variances + stride
                                                                                                : variances;
        for (ptrdiff_t x = 0; x < width; x += static_cast<ptrdiff_t>(kWidth)) {
            const ptrdiff_t k = grid.first(row) + x;
            const Vectors light = load_light(from, k);
            const Floats depth = hn::LoadU(d, shape.depth.data() + k), slope = hn::LoadU(d, shape.slope.data() + k);
            const Floats noise = hn::Sqrt(blurred(above + x, variances + x, below + x));
            const Floats brightness = luminance_of(light);
            const Floats explained = hn::Add(hn::Mul(set(strength), noise), hn::Mul(set(kLightTolerance), brightness));
            const Floats slanted =
                hn::Add(hn::Mul(set(2.0f * static_cast<float>(step)), slope), hn::Mul(set(kDepthTolerance), hn::Abs(depth)));
            // A pixel is like itself, whatever it shows.
            Smoothing sums{.normal = load_normal(shape, k),
                           .depth = depth,
                           .brightness = brightness,
                           .less_deep = hn::Div(set(1.0f), hn::Add(slanted, set(kLeastDepth))),
                           .less_bright = hn::Div(set(1.0f), hn::Add(explained, set(kLeastLight))),
                           .light = scale(light, set(kCentre)),
                           .variance = hn::Mul(set(kCentre * kCentre), hn::LoadU(d, variances + x)),
                           .weight = set(kCentre)};
            // Vectors that lie beside the picture as a whole may lie beside its margin, too.
            const bool has_left = x - far + static_cast<ptrdiff_t>(kWidth) > 0, has_right = x + far < width;
            for (int down = -1; down <= 1; ++down) {
                if (row + down * far < 0 || row + down * far >= height) continue;
                const ptrdiff_t there = k + down * far * stride;
                const float beside = down == 0 ? kSide : kCorner;
                if (has_left) sums.add_those(shape, from, there - far, beside);
                if (down != 0) sums.add_those(shape, from, there, kSide);
                if (has_right) sums.add_those(shape, from, there + far, beside);
            }
            const Floats part = hn::Div(set(1.0f), sums.weight);
            const Mask inside = within(static_cast<size_t>(x), grid.width);
            store_light(keep(inside, scale(sums.light, part)),
                        hn::IfThenElseZero(inside, hn::Mul(sums.variance, hn::Mul(part, part))), k, to);
        }
        close_row(grid, r, to);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
