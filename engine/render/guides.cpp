#include "engine/render/guides.h"

#include <limits>

#include "engine/render/past_frame.h"

namespace zoe {

void Guides::start(int picture_width, int picture_height) {
    width = picture_width;
    height = picture_height;
    const size_t pixel_count = static_cast<size_t>(width) * static_cast<size_t>(height);
    albedo.assign(pixel_count, glm::vec3(0.0f));
    normal.assign(pixel_count, glm::vec3(0.0f));
    unfiltered.assign(pixel_count, glm::vec3(0.0f));
    depth.assign(pixel_count, std::numeric_limits<float>::infinity());
    node.assign(pixel_count, 0xffffffffu);
    was_at.assign(pixel_count, glm::vec2(std::numeric_limits<float>::quiet_NaN()));
    was_depth.assign(pixel_count, 0.0f);
}

void Guides::see_surface(size_t pixel, const Tlas& tlas, const View& view, const Hit& hit, const Surface& surface,
                         const glm::vec3& so_far) {
    albedo[pixel] = surface.base_color;
    normal[pixel] = surface.is_unlit ? glm::vec3(0.0f) : surface.ns;
    unfiltered[pixel] = so_far;
    depth[pixel] = zoe::depth(view, surface.position);
    node[pixel] = index(hit.node);
    glm::vec3 before;
    glm::vec2 at;
    if (past == nullptr || !past->find_point(tlas, hit, &before)) return;
    if (!project(past->view(), before - past->view().origin, false, width, height, &at)) return;
    was_at[pixel] = at;
    was_depth[pixel] = zoe::depth(past->view(), before);
}

}  // namespace zoe
