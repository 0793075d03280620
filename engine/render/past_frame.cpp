#include "engine/render/past_frame.h"

namespace zoe {

namespace {

glm::vec3 point_on(const Mesh& mesh, const glm::vec3* positions, const Affine& world_from_local, const Hit& hit) {
    const glm::uvec3& corners = mesh.corners[hit.primitive];
    const glm::vec3 &a = positions[corners.x], &b = positions[corners.y], &c = positions[corners.z];
    return world_from_local.point((1.0f - hit.u - hit.v) * a + hit.u * b + hit.v * c);
}

}  // namespace

glm::vec3 point_of(const Tlas& tlas, const Hit& hit) {
    const Instance& instance = tlas[hit.node];
    return point_on(*instance.mesh, instance.positions.data(), instance.world_from_local, hit);
}

void PastFrame::keep(const Tlas& tlas, const View& view) {
    is_kept_ = true;
    view_ = view;
    places_.assign(tlas.instance_of_node.size(), {});
    positions_.clear();
    for (const Instance& instance : tlas.instances) {
        Place& place = places_[index(instance.node)];
        place.world_from_local = instance.world_from_local;
        place.mesh = instance.mesh;
        place.version = instance.mesh->version;
        place.vertex_count = instance.positions.size();
        if (instance.motion == Motion::kStatic || instance.motion == Motion::kRigid) continue;
        place.first = positions_.size();
        positions_.insert(positions_.end(), instance.positions.begin(), instance.positions.end());
    }
}

bool PastFrame::find_point(const Tlas& tlas, const Hit& hit, glm::vec3* point) const {
    const uint32_t node = index(hit.node);
    if (!is_kept_ || node >= places_.size()) return false;
    const Place& place = places_[node];
    const Instance& now = tlas[hit.node];
    const bool is_same =
        place.mesh == now.mesh && place.version == now.mesh->version && place.vertex_count == now.positions.size();
    if (!is_same) return false;
    const glm::vec3* const positions = place.first == kNotCopied ? now.positions.data() : positions_.data() + place.first;
    *point = point_on(*now.mesh, positions, place.world_from_local, hit);
    return true;
}

}  // namespace zoe
