// A ray as the SIMD kernels read it. Compiled once an instruction set, by the file that includes it.

HWY_BEFORE_NAMESPACE();
namespace zoe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using AxisTag = hn::FixedTag<float, 4>;
using AxisBits = hn::RebindToUnsigned<AxisTag>;
using AxisInts = hn::RebindToSigned<AxisTag>;

// Relative slack of the box test, put on the far planes and on the closest t so far, in units of e = 2^-23: 39 are needed.
// `entry` lets a box in where in (1 - 6 e) <= out (1 + 6 e), each product rounded: where in <= out (1 + 13 e). Here `in` is
// the same, and `out` is rounded three times: by this factor, by the step, and as a product; with its rounding there that is
// 2 e more. Below 2^-126 numbers round by half of s = 2^-149, whatever their size: in (1 - 6 e) is other than `in` from
// s / (12 e) on, where the four such halves of both tests are 24 e. The step is for reciprocals below 2^-126.
constexpr float kCullPad = 1.0f + 64.0f * 1.1920929e-7f, kCullStep = 64.0f * 1.4e-45f;
// Comparisons with NaN give the second operand, and so do equal ones, as in `entry`.
template <class V>
HWY_INLINE V larger(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128
    return hn::Max(a, b);
#else
    return hn::IfThenElse(hn::Gt(a, b), a, b);
#endif
}
template <class V>
HWY_INLINE V smaller(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128
    return hn::Min(a, b);
#else
    return hn::IfThenElse(hn::Lt(a, b), a, b);
#endif
}

// A bit for each of at most eight lanes.
template <class D>
HWY_INLINE uint32_t bits_of(D d, hn::Mask<D> mask) {
    uint8_t bits[8];
    hn::StoreMaskBits(d, mask, bits);
    return bits[0] & ((1u << hn::MaxLanes(d)) - 1);
}

// What the kernels read of a ray in one space: by axis, and a lane of no meaning. The operations are those of SlabRay and
// RayFrame.
struct Space {
    // Returns false for a ray that hits nothing.
    HWY_INLINE bool set(hn::Vec<AxisTag> ray_origin, hn::Vec<AxisTag> ray_direction) {
        const AxisTag d;
        const auto one = hn::Set(d, 1.0f), most = hn::Set(d, std::numeric_limits<float>::max());
        set_slabs(ray_origin, hn::Div(one, ray_direction));
        hn::Store(ray_direction, d, direction);
        set_shears(ray_origin, ray_direction);
        // Comparisons are false for NaN.
        const auto size = hn::Abs(ray_direction);
        const auto is_finite = hn::And(hn::Le(size, most), hn::Le(hn::Abs(ray_origin), most));
        return (bits_of(d, is_finite) & 7) == 7 && (bits_of(d, hn::Ge(size, hn::Set(d, kShortestDirection))) & 7) != 0;
    }
    HWY_INLINE bool set(const Ray& ray) {
        const AxisTag d;
        // What follows an origin or a direction fills the fourth lane.
        return set(hn::LoadU(d, &ray.origin.x), hn::LoadU(d, &ray.direction.x)) & (ray.t_min >= 0.0f);
    }
    // As `set` of a ray from another place with the direction of `other`.
    HWY_INLINE bool set_shifted(const Space& other, hn::Vec<AxisTag> ray_origin) {
        const AxisTag d;
        const AxisBits bits;
        hn::Store(ray_origin, d, origin);
        hn::Store(hn::Load(d, other.inverse), d, inverse);
        hn::Store(hn::Load(d, other.far_inverse), d, far_inverse);
        hn::Store(hn::Load(bits, other.negative), bits, negative);
        hn::Store(hn::Load(bits, other.near_row), bits, near_row);
        hn::Store(hn::Load(d, other.direction), d, direction);
        hn::Store(hn::Load(d, other.shear), d, shear);
        const auto row = hn::Load(bits, other.sheared_row);
        hn::Store(row, bits, sheared_row);
        const auto order = hn::IndicesFromVec(d, hn::ShiftRight<2>(row));
        hn::Store(hn::TableLookupLanes(ray_origin, order), d, sheared_origin);
        const auto is_finite = hn::Le(hn::Abs(ray_origin), hn::Set(d, std::numeric_limits<float>::max()));
        return (bits_of(d, is_finite) & 7) == 7;
    }
    // Of a ray in the world, for the top level.
    // slack      of TwoLevels.
    HWY_INLINE void widen(float slack) {
        const AxisTag d;
        // A near plane that moves against the ray is an origin that moves along it.
        const float size = std::max({std::abs(origin[0]), std::abs(origin[1]), std::abs(origin[2])});
        const auto at = hn::Load(d, origin), more = hn::CopySign(hn::Set(d, slack * size), hn::Load(d, inverse));
        hn::Store(hn::Add(at, more), d, first);
        hn::Store(hn::Sub(at, more), d, last);
    }
    void set(const RayFrame& ray) {
        const AxisTag d;
        const auto load = [&](const glm::vec3& v) HWY_ATTR {
            HWY_ALIGN const float lanes[4] = {v.x, v.y, v.z, 1.0f};
            return hn::Load(d, lanes);
        };
        set_slabs(load(ray.origin), load(ray.inverse_direction));
        const int order[3] = {ray.kx, ray.ky, ray.kz};
        const float shears[3] = {ray.shear_x, ray.shear_y, ray.shear_z};
        for (int k = 0; k < 3; ++k) {
            sheared_row[k] = order[k] * TriangleBlock::kSize;
            sheared_origin[k] = ray.origin[order[k]];
            shear[k] = shears[k];
        }
    }

    alignas(16) float origin[4];
    alignas(16) float first[4], last[4];  // The origin for near and far planes that are moved out by the slack.
    alignas(16) float inverse[4];
    alignas(16) float far_inverse[4];
    alignas(16) uint32_t negative[4];  // All bits where the direction's component is below 0.
    alignas(16) uint32_t near_row[4];  // Rows of WideNode::planes, as offsets in floats.
    alignas(16) float direction[4];
    alignas(16) uint32_t sheared_row[4];  // Rows of TriangleBlock::corners: along kx, ky, kz.
    alignas(16) float sheared_origin[4];
    alignas(16) float shear[4];

private:
    HWY_INLINE void set_slabs(hn::Vec<AxisTag> ray_origin, hn::Vec<AxisTag> ray_inverse) {
        const AxisTag d;
        const AxisBits bits;
        HWY_ALIGN static constexpr uint32_t kRows[4] = {0, 2 * kWidth, 4 * kWidth, 0};
        const auto far =
            hn::Add(hn::Mul(ray_inverse, hn::Set(d, kCullPad)), hn::CopySign(hn::Set(d, kCullStep), ray_inverse));
        const auto is_negative = hn::BitCast(bits, hn::BroadcastSignBit(hn::BitCast(AxisInts(), ray_inverse)));
        hn::Store(ray_origin, d, origin);
        hn::Store(ray_inverse, d, inverse);
        hn::Store(far, d, far_inverse);
        hn::Store(is_negative, bits, negative);
        hn::Store(hn::Add(hn::Load(bits, kRows), hn::And(is_negative, hn::Set(bits, uint32_t{kWidth}))), bits, near_row);
    }
    HWY_INLINE void set_shears(hn::Vec<AxisTag> ray_origin, hn::Vec<AxisTag> along) {
        const AxisTag d;
        const AxisBits bits;
        HWY_ALIGN static constexpr uint32_t kFirst[4] = {0, 0, 1, 3}, kSecond[4] = {1, 2, 2, 3};
        // By x > y, x > z, y > z: the longest axis.
        static constexpr uint8_t kLongest[8] = {2, 2, 2, 0, 1, 2, 1, 0};
        // By that axis and whether the direction is negative there: kx, ky, kz, and any.
        HWY_ALIGN static constexpr uint32_t kOrders[6][4] = {{1, 2, 0, 0}, {2, 1, 0, 0}, {2, 0, 1, 1},
                                                             {0, 2, 1, 1}, {0, 1, 2, 2}, {1, 0, 2, 2}};
        const auto size = hn::Abs(along);
        const auto pick = [&](hn::Vec<AxisTag> v, const uint32_t* lanes)
                              HWY_ATTR { return hn::TableLookupLanes(v, hn::IndicesFromVec(d, hn::Load(bits, lanes))); };
        const uint32_t longest = kLongest[bits_of(d, hn::Gt(pick(size, kFirst), pick(size, kSecond))) & 7];
        const uint32_t* const order = kOrders[2 * longest + (negative[longest] & 1)];
        const auto ordered = pick(along, order);
        hn::Store(hn::Div(ordered, hn::Broadcast<2>(ordered)), d, shear);
        shear[2] = inverse[longest];
        hn::Store(pick(ray_origin, order), d, sheared_origin);
        static_assert(TriangleBlock::kSize == 4);
        hn::Store(hn::ShiftLeft<2>(hn::Load(bits, order)), bits, sheared_row);
    }
};

static_assert(sizeof(Aabb) == 6 * sizeof(float) && offsetof(Aabb, hi) == 3 * sizeof(float));

// `entry` into a box.
HWY_INLINE float entry(const Space& ray, const Aabb& box, float t_max) {
    const AxisTag d;
    const auto lo = hn::LoadU(d, &box.lo.x), hi = hn::ShiftRightLanes<1>(d, hn::LoadU(d, &box.lo.z));
    const auto origin = hn::Load(d, ray.origin), inverse = hn::Load(d, ray.inverse);
    const auto is_negative = hn::MaskFromVec(hn::BitCast(d, hn::Load(AxisBits(), ray.negative)));
    const auto first = hn::Mul(hn::Sub(hn::IfThenElse(is_negative, hi, lo), origin), inverse);
    const auto last = hn::Mul(hn::Sub(hn::IfThenElse(is_negative, lo, hi), origin), inverse);
    const auto zero = hn::Zero(d), infinity = hn::Set(d, std::numeric_limits<float>::infinity());
    const auto is_axis = hn::FirstN(d, 3);
    const float in = hn::GetLane(hn::MaxOfLanes(d, larger(hn::IfThenElse(is_axis, first, zero), zero))) * (1.0f - kBoxPad);
    const float out =
        hn::GetLane(hn::MinOfLanes(d, smaller(hn::IfThenElse(is_axis, last, infinity), infinity))) * (1.0f + kBoxPad);
    return in <= out && in <= t_max ? in : std::numeric_limits<float>::infinity();
}

}  // namespace HWY_NAMESPACE
}  // namespace zoe
HWY_AFTER_NAMESPACE();
