#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/quaternion_double.hpp>
#include <glm/gtc/quaternion.hpp>

#include "engine/deform/packed_joints.h"
#include "engine/deform/polar.h"

namespace zoe {

namespace {

constexpr double kRounding = 2e-6;  // What floats leave of a matrix that is meant to be a rotation.

bool is_rotation(const glm::dmat3& m) {
    for (int a = 0; a < 3; ++a) {
        for (int b = a; b < 3; ++b) {
            if (!(std::abs(glm::dot(m[a], m[b]) - (a == b ? 1.0 : 0.0)) <= kRounding)) return false;
        }
    }
    return glm::determinant(m) > 0.0;
}

// What most joints are scaled by; of two in the middle the smaller one, so that a single huge one does not count.
// scratch    memory.
double common_scale(std::span<const Affine> joints, std::span<const uint8_t> is_used, std::vector<double>* scratch) {
    scratch->clear();
    for (size_t k = 0; k < joints.size(); ++k) {
        const double scale = std::cbrt(glm::determinant(glm::dmat3(joints[k].linear)));
        if (is_used[k] && std::isfinite(scale)) scratch->push_back(scale);
    }
    if (scratch->empty()) return 1.0;
    const auto middle = scratch->begin() + static_cast<ptrdiff_t>(scratch->size() / 2);
    std::nth_element(scratch->begin(), middle, scratch->end());
    double scale = *middle;
    if (scratch->size() % 2 == 0) {
        const double before = *std::max_element(scratch->begin(), middle);
        if (std::abs(before) < std::abs(scale)) scale = before;
    }
    if (std::abs(std::abs(scale) - 1.0) <= kRounding) return std::copysign(1.0, scale);
    const double as_float = static_cast<float>(scale);
    return std::abs(as_float) >= std::numeric_limits<float>::min() ? as_float : 1.0;
}

PackedMotion pack_motion(const glm::dmat3& rotation, const glm::dvec3& translation) {
    const glm::dquat real = glm::normalize(glm::quat_cast(rotation));
    const glm::dquat dual = 0.5 * (glm::dquat(0.0, translation.x, translation.y, translation.z) * real);
    const auto as_float = [](double number) { return static_cast<float>(number); };
    return {{as_float(real.x), as_float(real.y), as_float(real.z), as_float(real.w)},
            {as_float(dual.x), as_float(dual.y), as_float(dual.z), as_float(dual.w)}};
}

// p -> centre + stretch * (p - centre)
PackedAffine pack_stretch(const glm::dmat3& stretch, const glm::dvec3& centre) {
    PackedAffine packed{};
    const glm::dvec3 offset = centre - stretch * centre;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) packed.rows[row][column] = static_cast<float>(stretch[column][row]);
        packed.rows[row][3] = static_cast<float>(offset[row]);
    }
    return packed;
}

}  // namespace

void pack_joints_dual(std::span<const Affine> skin_from_mesh, std::span<const glm::vec3> centres,
                      std::span<const uint8_t> is_used, PackedJoints* packed) {
    const size_t count = skin_from_mesh.size();
    assert(centres.size() == count && is_used.size() == count);
    packed->skinning = Skinning::kDualQuaternion;
    packed->is_finite = true;
    packed->motions.resize(count);
    packed->affines.resize(count);
    const double scale = common_scale(skin_from_mesh, is_used, &packed->scratch);
    packed->common_scale = static_cast<float>(scale);
    bool is_stretched = false;
    for (size_t k = 0; k < count; ++k) {
        const glm::dmat3 linear = glm::dmat3(skin_from_mesh[k].linear) / scale;
        const glm::dvec3 translation = glm::dvec3(skin_from_mesh[k].translation) / scale, centre(centres[k]);
        if (!is_finite(skin_from_mesh[k])) {
            std::fill_n(packed->motions[k].real, 4, std::numeric_limits<float>::quiet_NaN());
            std::fill_n(packed->motions[k].dual, 4, std::numeric_limits<float>::quiet_NaN());
            packed->affines[k] = pack_stretch(glm::dmat3(1.0), centre);
        } else if (is_rotation(linear)) {
            packed->motions[k] = pack_motion(linear, translation);
            packed->affines[k] = pack_stretch(glm::dmat3(1.0), centre);
        } else {
            const Polar split = polar(linear);
            packed->motions[k] = pack_motion(split.rotation, translation + linear * centre - split.rotation * centre);
            packed->affines[k] = pack_stretch(split.stretch, centre);
            is_stretched |= is_used[k] != 0;
        }
    }
    if (!is_stretched) packed->affines.clear();
    packed->is_finite = std::ranges::all_of(packed->affines, [](const PackedAffine& affine) {
        return std::all_of(affine.rows[0], affine.rows[0] + 12, [](float number) { return std::isfinite(number); });
    });
}

}  // namespace zoe
