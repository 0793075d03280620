// Compiled once an instruction set by denoise_kernels.cpp: the mean over frames. What a pixel shows is looked for where it
// was in the frame before.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

// Past depths may differ by this share, and by what a slope makes of two pixels.
constexpr float kPastDepthTolerance = 0.01f;
// Light on a surface that turns is another: nothing of the past is left at 1/16 from parallel, about 20 degrees.
constexpr float kTurnFalloff = 16.0f;
// Less of a past pixel's neighbours than this is too little to go by.
constexpr float kLeastShare = 0.05f;
// Where fewer frames are known, four as a rule, noise is told by what is around. Between two whole numbers: means of them
// are not quite whole.
constexpr float kEnoughFrames = 3.5f;
// Around a pixel: 5 x 5 others, so many apart ...
constexpr int kAround = 2, kApart = 2;
// ... of which those of other nodes count so much, for pixels that have no others.
constexpr float kOtherNode = 1.0f / 32.0f;

HWY_INLINE Floats mix(const Floats& a, const Floats& b, const Floats& share) {
    return hn::Add(a, hn::Mul(share, hn::Sub(b, a)));
}

// The smaller of the steps to both sides: at an edge, the one on this side of it. 0 where there are no others.
HWY_INLINE Floats slope_between(const float* depth, ptrdiff_t apart) {
    const FloatTag d;
    const Floats here = hn::LoadU(d, depth);
    const Floats before = hn::Abs(hn::Sub(here, hn::LoadU(d, depth - apart))),
                 after = hn::Abs(hn::Sub(hn::LoadU(d, depth + apart), here));
    const Floats least = hn::Min(before, after);
    return hn::IfThenElseZero(is_finite(least), least);
}

// What the frame before knows of pixels' points; frames 0: nothing.
struct Past {
    Vectors light;
    Floats mean, square, frames;
};

// Where pixels of the past frame lie that belong to a vector's: mostly side by side.
struct Places {
    Ints at;
    ptrdiff_t first = 0;
    bool is_row = false;

    HWY_INLINE explicit Places(const Ints& places) : at(places), first(hn::GetLane(places)) {
        const IntTag d;
        is_row = hn::AllTrue(d, hn::Eq(places, hn::Iota(d, static_cast<int32_t>(first))));
    }
    HWY_INLINE Floats load(const std::vector<float>& plane, ptrdiff_t beside) const {
        const FloatTag d;
        const float* const base = plane.data() + beside;
        return is_row ? hn::LoadU(d, base + first) : hn::GatherIndex(d, base, at);
    }
    HWY_INLINE Numbers load(const std::vector<uint32_t>& plane, ptrdiff_t beside) const {
        const NumberTag d;
        const uint32_t* const base = plane.data() + beside;
        return is_row ? hn::LoadU(d, base + first) : hn::GatherIndex(d, base, at);
    }
};

HWY_INLINE Past no_past() {
    const Floats zero = set(0.0f);
    return {{zero, zero, zero}, zero, zero, zero};
}

HWY_INLINE Past find_past(const DenoiseFrame& frame, const Guides& guides, size_t row, size_t x, ptrdiff_t k,
                          const Floats& slope) {
    const FloatTag d;
    const IntTag ints;
    const DenoiseGrid& grid = frame.grid;
    const size_t from = row * grid.width + x, count = grid.width - x;
    Floats was_x, was_y;
    if (HWY_LIKELY(count >= kWidth)) {
        hn::LoadInterleaved2(d, &guides.was_at[from].x, was_x, was_y);
    } else {
        glm::vec2 padded[kWidth];
        std::fill_n(padded, kWidth, glm::vec2(-2.0f));
        std::copy_n(&guides.was_at[from], count, padded);
        hn::LoadInterleaved2(d, &padded->x, was_x, was_y);
    }
    was_x = hn::Sub(was_x, set(0.5f));
    was_y = hn::Sub(was_y, set(0.5f));
    const auto lies_in = [&](const Floats& at, size_t size) {
        return hn::And(hn::Gt(at, set(-1.0f)), hn::Lt(at, set(static_cast<float>(size))));  // NaN does not
    };
    const Mask is_inside = hn::And(lies_in(was_x, grid.width), lies_in(was_y, grid.height));
    if (hn::AllFalse(d, is_inside)) return no_past();
    was_x = hn::IfThenElse(is_inside, was_x, hn::Iota(d, static_cast<float>(x)));
    was_y = hn::IfThenElse(is_inside, was_y, set(static_cast<float>(row)));
    const Floats left = hn::Floor(was_x), top = hn::Floor(was_y);
    // Products of floats, below 2^24: not all processors have those of integers.
    const auto rows = [&](size_t by) { return hn::ConvertTo(ints, hn::Mul(top, set(static_cast<float>(by)))); };
    const Ints down = hn::Add(hn::ShiftLeft<8>(rows(grid.stride() >> 8)), rows(grid.stride() & 255));
    const Ints begin = hn::Set(ints, static_cast<int32_t>(grid.first(0)));
    const Places places(hn::Add(hn::Add(down, hn::ConvertTo(ints, left)), begin));

    const Floats was_depth = load_some(&guides.was_depth[from], count);
    const Floats tolerance = hn::Add(hn::Mul(set(kPastDepthTolerance), hn::Abs(was_depth)), hn::Mul(set(2.0f), slope));
    const Vectors normal = load_normal(frame.shape, k);
    const Numbers node = load_node(frame.shape, k);
    const Floats right_share = hn::Sub(was_x, left), down_share = hn::Sub(was_y, top);
    const Floats one = set(1.0f);
    Past past = no_past();
    Floats share = set(0.0f);
    for (int corner = 0; corner < 4; ++corner) {
        const bool is_right = (corner & 1) != 0, is_below = (corner >> 1) != 0;
        const ptrdiff_t beside = (is_right ? 1 : 0) + (is_below ? static_cast<ptrdiff_t>(grid.stride()) : 0);
        const Floats frames = places.load(frame.past_moments.frames, beside);
        const Floats depth = places.load(frame.past_shape.depth, beside);
        const Mask is_same = hn::RebindMask(d, hn::Eq(places.load(frame.past_shape.node, beside), node));
        const Mask is_near = hn::Le(hn::Abs(hn::Sub(depth, was_depth)), tolerance);
        const Vectors past_normal{places.load(frame.past_shape.x, beside), places.load(frame.past_shape.y, beside),
                                  places.load(frame.past_shape.z, beside)};
        const Floats left_over = hn::Sub(one, hn::Mul(set(kTurnFalloff), hn::Sub(one, dot(past_normal, normal))));
        const Mask is_there = hn::And(hn::Gt(frames, set(0.0f)), hn::Gt(left_over, set(0.0f)));
        const Mask counts = hn::And(hn::And(is_inside, is_same), hn::And(is_near, is_there));
        if (hn::AllFalse(d, counts)) continue;
        const Floats part =
            hn::Mul(is_right ? right_share : hn::Sub(one, right_share), is_below ? down_share : hn::Sub(one, down_share));
        const Floats weight = hn::IfThenElseZero(counts, part);
        const Vectors light{places.load(frame.past_light.red, beside), places.load(frame.past_light.green, beside),
                            places.load(frame.past_light.blue, beside)};
        share = hn::Add(share, weight);
        past.light = add(past.light, scale(light, weight));
        past.mean = hn::Add(past.mean, hn::Mul(weight, places.load(frame.past_moments.mean, beside)));
        past.square = hn::Add(past.square, hn::Mul(weight, places.load(frame.past_moments.square, beside)));
        const Floats kept = hn::Mul(hn::Mul(part, frames), hn::Min(left_over, one));
        past.frames = hn::Add(past.frames, hn::IfThenElseZero(counts, kept));  // -inf where normals are no unit vectors
    }
    const Mask is_found = hn::And(hn::Ge(share, set(kLeastShare)), hn::Gt(past.frames, set(0.0f)));
    const Floats by = hn::IfThenElseZero(is_found, hn::Div(one, share));
    past.light = keep(is_found, scale(past.light, by));
    past.mean = hn::Mul(past.mean, by);
    past.square = hn::Mul(past.square, by);
    past.frames = hn::Mul(past.frames, by);
    return past;
}

// The mean of samples around, and how far they spread.
struct Around {
    Floats mean, spread;
};

HWY_INLINE Around look_around(const DenoiseFrame& frame, size_t row, ptrdiff_t k) {
    const FloatTag d;
    const Numbers node = load_node(frame.shape, k);
    Floats mean = set(0.0f), square = mean, count = mean;
    for (int down = -kAround * kApart; down <= kAround * kApart; down += kApart) {
        const ptrdiff_t y = static_cast<ptrdiff_t>(row) + down;
        if (y < 0 || y >= static_cast<ptrdiff_t>(frame.grid.height)) continue;
        for (int across = -kAround * kApart; across <= kAround * kApart; across += kApart) {
            const ptrdiff_t q = k + down * static_cast<ptrdiff_t>(frame.grid.stride()) + across;
            const Mask is_same = hn::RebindMask(d, hn::Eq(load_node(frame.shape, q), node));
            const Floats known = hn::LoadU(d, frame.known.data() + q);
            const Floats weight = hn::Mul(known, hn::IfThenElse(is_same, set(1.0f), set(kOtherNode)));
            const Floats bright = hn::LoadU(d, frame.brightness.data() + q), weighted = hn::Mul(weight, bright);
            mean = hn::Add(mean, weighted);
            square = hn::Add(square, hn::Mul(weighted, bright));
            count = hn::Add(count, weight);
        }
    }
    const Floats part = hn::IfThenElseZero(hn::Gt(count, set(0.0f)), hn::Div(set(1.0f), count));
    mean = hn::Mul(mean, part);
    return {mean, hn::Max(hn::Sub(hn::Mul(square, part), hn::Mul(mean, mean)), set(0.0f))};
}

// Joins pixels' samples with their past, and tells the variance of the mean.
HWY_INLINE void follow(const Guides& guides, const Floats& most_frames, size_t row, size_t x, DenoiseFrame* frame) {
    const FloatTag d;
    const DenoiseGrid& grid = frame->grid;
    const ptrdiff_t k = grid.first(static_cast<ptrdiff_t>(row)) + static_cast<ptrdiff_t>(x);
    const float* const depth = frame->shape.depth.data() + k;
    const Floats slope = hn::Max(slope_between(depth, 1), slope_between(depth, static_cast<ptrdiff_t>(grid.stride())));
    hn::StoreU(slope, d, frame->shape.slope.data() + k);
    const Past past = frame->has_past ? find_past(*frame, guides, row, x, k, slope) : no_past();

    const Floats zero = set(0.0f), one = set(1.0f);
    const Mask is_known = hn::Gt(hn::LoadU(d, frame->known.data() + k), zero);
    const Floats frames = hn::IfThenElse(is_known, hn::Min(hn::Add(past.frames, one), most_frames), past.frames);
    const Mask is_new = hn::Lt(frames, set(kEnoughFrames));
    Around around{zero, zero};
    if (!hn::AllFalse(d, is_new)) around = look_around(*frame, row, k);
    // A sample that says nothing leaves the mean as it was; where nothing is known, what is around stands in.
    const Floats share = hn::IfThenElse(is_known, hn::Div(one, frames), hn::IfThenElseZero(hn::Le(frames, zero), one));
    const auto joined = [&](const Floats& old, const std::vector<float>& sample) {
        return mix(old, hn::IfThenElse(is_known, hn::LoadU(d, sample.data() + k), around.mean), share);
    };
    const Mask inside = within(x, grid.width);
    const Vectors light{joined(past.light.x, frame->sample.red), joined(past.light.y, frame->sample.green),
                        joined(past.light.z, frame->sample.blue)};
    const Floats bright = hn::IfThenElse(is_known, hn::LoadU(d, frame->brightness.data() + k), around.mean);
    const Floats mean = mix(past.mean, bright, share), square = mix(past.square, hn::Mul(bright, bright), share);
    hn::StoreU(mean, d, frame->moments.mean.data() + k);
    hn::StoreU(square, d, frame->moments.square.data() + k);
    hn::StoreU(frames, d, frame->moments.frames.data() + k);
    const Floats in_time = hn::Max(hn::Sub(square, hn::Mul(mean, mean)), zero);
    const Floats variance = hn::Div(hn::IfThenElse(is_new, around.spread, in_time), hn::Max(frames, one));
    store_light(keep(inside, light), hn::IfThenElseZero(inside, variance), k, &frame->light);
}

// What is around a row's variances is its edge's.
HWY_INLINE void close_row(const DenoiseGrid& grid, size_t row, DenoiseLight* light) {
    float* const variance = light->variance.data() + grid.first(static_cast<ptrdiff_t>(row));
    variance[-1] = variance[0];
    variance[grid.width] = variance[grid.width - 1];
}

void follow_range(const Guides& guides, float most_frames, DenoiseFrame* frame, size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
        for (size_t x = 0; x < frame->grid.width; x += kWidth) follow(guides, set(most_frames), row, x, frame);
        close_row(frame->grid, row, &frame->light);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
