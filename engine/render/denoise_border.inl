// Compiled once an instruction set by denoise_kernels.cpp: how light comes into the filter's planes, and how it leaves them.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

using IntTag = hn::RebindToSigned<FloatTag>;
using NumberTag = hn::RebindToUnsigned<FloatTag>;
using Ints = hn::Vec<IntTag>;
using Numbers = hn::Vec<NumberTag>;
using Mask = hn::Mask<FloatTag>;

constexpr uint32_t kSky = 0xffffffffu;
// Brighter light counts as this bright, so that squares stay finite.
constexpr float kBrightest = 1e15f;
// The sky's depth in sums that must stay finite.
constexpr float kFarthest = 1e30f;

HWY_INLINE Floats set(float value) {
    return hn::Set(FloatTag(), value);
}

HWY_INLINE Floats luminance_of(const Vectors& color) {
    return dot(color, {set(kLuminance.r), set(kLuminance.g), set(kLuminance.b)});
}

HWY_INLINE Mask is_finite(const Floats& v) {
    return hn::Le(hn::Abs(v), set(std::numeric_limits<float>::max()));
}

HWY_INLINE Mask is_finite(const Vectors& v) {
    return hn::And(hn::And(is_finite(v.x), is_finite(v.y)), is_finite(v.z));
}

HWY_INLINE Vectors keep(const Mask& mask, const Vectors& v) {
    return {hn::IfThenElseZero(mask, v.x), hn::IfThenElseZero(mask, v.y), hn::IfThenElseZero(mask, v.z)};
}

HWY_INLINE Vectors load_light(const DenoiseLight& light, ptrdiff_t k) {
    const FloatTag d;
    return {hn::LoadU(d, light.red.data() + k), hn::LoadU(d, light.green.data() + k), hn::LoadU(d, light.blue.data() + k)};
}

HWY_INLINE Vectors load_normal(const DenoiseShape& shape, ptrdiff_t k) {
    const FloatTag d;
    return {hn::LoadU(d, shape.x.data() + k), hn::LoadU(d, shape.y.data() + k), hn::LoadU(d, shape.z.data() + k)};
}

HWY_INLINE Numbers load_node(const DenoiseShape& shape, ptrdiff_t k) {
    return hn::LoadU(NumberTag(), shape.node.data() + k);
}

HWY_INLINE void store_light(const Vectors& color, const Floats& variance, ptrdiff_t k, DenoiseLight* light) {
    const FloatTag d;
    hn::StoreU(color.x, d, light->red.data() + k);
    hn::StoreU(color.y, d, light->green.data() + k);
    hn::StoreU(color.z, d, light->blue.data() + k);
    hn::StoreU(variance, d, light->variance.data() + k);
}

// Of the last vector of a row, those behind its end hold anything: they must become what is around the picture.
HWY_INLINE Mask within(size_t x, size_t width) {
    return hn::FirstN(FloatTag(), std::min(width - x, kWidth));
}

// A number a pixel from an array without margins; 0 behind the end of a row.
HWY_INLINE Floats load_some(const float* from, size_t count) {
    if (HWY_LIKELY(count >= kWidth)) return hn::LoadU(FloatTag(), from);
    float padded[kWidth] = {};
    std::copy_n(from, count, padded);
    return hn::LoadU(FloatTag(), padded);
}

HWY_INLINE Numbers load_some(const uint32_t* from, size_t count) {
    if (HWY_LIKELY(count >= kWidth)) return hn::LoadU(NumberTag(), from);
    uint32_t padded[kWidth] = {};
    std::copy_n(from, count, padded);
    return hn::LoadU(NumberTag(), padded);
}

struct Radiance {
    Vectors color;
    Floats coverage;

    HWY_INLINE void load(const glm::vec4* from, size_t count) {
        const FloatTag d;
        glm::vec4 padded[kWidth];
        if (HWY_UNLIKELY(count < kWidth)) {
            std::fill_n(padded, kWidth, glm::vec4(0.0f));
            std::copy_n(from, count, padded);
            from = padded;
        }
        hn::LoadInterleaved4(d, &from->x, color.x, color.y, color.z, coverage);
    }
    HWY_INLINE void store(size_t count, glm::vec4* to) const {
        const FloatTag d;
        if (HWY_LIKELY(count >= kWidth)) return hn::StoreInterleaved4(color.x, color.y, color.z, coverage, d, &to->x);
        glm::vec4 padded[kWidth];
        hn::StoreInterleaved4(color.x, color.y, color.z, coverage, d, &padded->x);
        std::copy_n(padded, count, to);
    }
};

HWY_INLINE Floats divisor_of(const Floats& albedo) {
    return hn::Add(set(kLeastAlbedo), hn::Mul(set(1.0f - kLeastAlbedo), albedo));
}

HWY_INLINE Floats light_of(const Floats& sum, const Floats& scale, const Floats& unfiltered, const Floats& albedo) {
    return hn::Div(hn::Sub(hn::Mul(sum, scale), unfiltered), divisor_of(albedo));
}

HWY_INLINE Floats kept_light(const Mask& is_known, const Floats& light) {
    return hn::IfThenElseZero(is_known, hn::Min(hn::Max(light, set(0.0f)), set(kBrightest)));
}

void take_in_range(const Guides& guides, const glm::vec4* sums, float scale_of_all, DenoiseFrame* frame, size_t begin,
                   size_t end) {
    const FloatTag d;
    const NumberTag numbers;
    const DenoiseGrid grid = frame->grid;
    const Floats scale = set(scale_of_all);
    for (size_t row = begin; row < end; ++row) {
        for (size_t x = 0; x < grid.width; x += kWidth) {
            const size_t from = row * grid.width + x, count = grid.width - x;
            const ptrdiff_t k = grid.first(static_cast<ptrdiff_t>(row)) + static_cast<ptrdiff_t>(x);
            const Mask inside = within(x, grid.width);
            Radiance sum;
            sum.load(sums + from, count);
            const Vectors unfiltered = load_vectors(&guides.unfiltered[from], count),
                          albedo = load_vectors(&guides.albedo[from], count);
            const Numbers node = load_some(&guides.node[from], count);
            const Floats depth = load_some(&guides.depth[from], count);
            const Mask is_surface =
                hn::And(hn::And(inside, is_finite(depth)), hn::RebindMask(d, hn::Ne(node, hn::Set(numbers, kSky))));
            const Vectors light{light_of(sum.color.x, scale, unfiltered.x, albedo.x),
                                light_of(sum.color.y, scale, unfiltered.y, albedo.y),
                                light_of(sum.color.z, scale, unfiltered.z, albedo.z)};
            const Mask is_known = hn::And(is_surface, is_finite(light));
            const Vectors kept{kept_light(is_known, light.x), kept_light(is_known, light.y), kept_light(is_known, light.z)};
            store_light(kept, set(0.0f), k, &frame->sample);
            hn::StoreU(luminance_of(kept), d, frame->brightness.data() + k);
            hn::StoreU(hn::IfThenElseZero(is_known, set(1.0f)), d, frame->known.data() + k);
            const Vectors any_normal = load_vectors(&guides.normal[from], count);
            const Vectors normal = keep(hn::And(inside, is_finite(any_normal)), any_normal);
            hn::StoreU(normal.x, d, frame->shape.x.data() + k);
            hn::StoreU(normal.y, d, frame->shape.y.data() + k);
            hn::StoreU(normal.z, d, frame->shape.z.data() + k);
            const Floats near = hn::Min(hn::Max(depth, set(-kFarthest)), set(kFarthest));
            const Floats beside = hn::IfThenElse(inside, set(kFarthest), set(std::numeric_limits<float>::infinity()));
            hn::StoreU(hn::IfThenElse(is_surface, near, beside), d, frame->shape.depth.data() + k);
            const auto inside_number = hn::RebindMask(numbers, inside);
            hn::StoreU(hn::IfThenElse(inside_number, node, hn::Set(numbers, kSky)), numbers, frame->shape.node.data() + k);
        }
    }
}

void put_out_range(const DenoiseGrid& grid, const Guides& guides, const DenoiseLight& light, float scale_of_all,
                   glm::vec4* sums, size_t begin, size_t end) {
    const FloatTag d;
    const Floats scale = set(scale_of_all);
    for (size_t row = begin; row < end; ++row) {
        for (size_t x = 0; x < grid.width; x += kWidth) {
            const size_t to = row * grid.width + x, count = grid.width - x;
            const ptrdiff_t k = grid.first(static_cast<ptrdiff_t>(row)) + static_cast<ptrdiff_t>(x);
            Radiance sum;
            sum.load(sums + to, count);
            const Vectors unfiltered = load_vectors(&guides.unfiltered[to], count),
                          albedo = load_vectors(&guides.albedo[to], count), smooth = load_light(light, k);
            const Numbers node = load_some(&guides.node[to], count);
            // What shows no surface has nothing to be smoothed by.
            const Mask is_surface = hn::RebindMask(d, hn::Ne(node, hn::Set(NumberTag(), kSky)));
            const auto radiance = [&](const Floats& raw, const Floats& pure, const Floats& by, const Floats& lit) {
                const Floats whole = hn::Mul(scale, hn::Add(pure, hn::Mul(divisor_of(by), lit)));
                return hn::IfThenElse(is_surface, whole, raw);
            };
            const Vectors result{radiance(sum.color.x, unfiltered.x, albedo.x, smooth.x),
                                 radiance(sum.color.y, unfiltered.y, albedo.y, smooth.y),
                                 radiance(sum.color.z, unfiltered.z, albedo.z, smooth.z)};
            sum.color = keep(is_finite(result), result);
            sum.store(count, sums + to);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
