#include "engine/render/layers.h"

#include "engine/render/past_frame.h"
#include "engine/render/surface.h"

namespace zoe {

void Layers::start(int picture_width, int picture_height) {
    width = picture_width;
    height = picture_height;
    const size_t pixel_count = static_cast<size_t>(width) * static_cast<size_t>(height);
    albedo.assign(pixel_count, glm::vec3(0.0f));
    normal.assign(pixel_count, glm::vec3(0.0f));
    motion.assign(pixel_count, glm::vec2(0.0f));
}

void Layers::see(size_t pixel, const Scene& scene, const Tlas& tlas, const View& view, const Ray& ray, const Hit& hit) {
    if (hit) {
        const Surface surface = surface_at(scene, tlas, ray, hit);
        albedo[pixel] = surface.base_color;
        normal[pixel] = surface.ns;
    }
    if (past == nullptr || !past->is_kept()) return;
    const View& view_then = past->view();
    glm::vec3 now = ray.direction, then = now;
    if (hit) {
        const glm::vec3 point = point_of(tlas, hit);
        glm::vec3 before = point;
        past->find_point(tlas, hit, &before);
        now = point - view.origin;
        then = before - view_then.origin;
    }
    glm::vec2 at, was_at;
    if (!project(view, now, !hit, width, height, &at) || !project(view_then, then, !hit, width, height, &was_at)) return;
    motion[pixel] = {at.x - was_at.x, was_at.y - at.y};
}

}  // namespace zoe
