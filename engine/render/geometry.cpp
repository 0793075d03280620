#include "engine/render/geometry.h"

#include <limits>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/math/parallel.h"

namespace zoe {

void record_geometry(const View& view, const Ray& ray, const Hit& hit, size_t pixel, Film* film) {
    film->depth[pixel] = hit ? depth(view, ray.origin) - hit.t * glm::dot(ray.direction, view.axis_z)
                             : std::numeric_limits<float>::infinity();
    film->node[pixel] = index(hit.node);
    film->primitive[pixel] = hit.primitive;
}

void see_geometry(const Scene& scene, const Tlas& tlas, const View& view, Film* film, Layers* layers) {
    constexpr size_t kRowGrain = 8;
    const RayBatch batch(tlas.watch.get());
    const size_t row = static_cast<size_t>(film->width);
    if (layers != nullptr) layers->start(film->width, film->height);
    parallel_for(0, static_cast<size_t>(film->height), kRowGrain, [&](size_t begin, size_t end) {
        static thread_local std::vector<Ray> rays;
        static thread_local std::vector<Hit> hits;
        rays.clear();
        for (size_t k = begin * row; k < end * row; ++k) {
            rays.push_back(camera_ray(view, static_cast<float>(k % row) + 0.5f, static_cast<float>(k / row) + 0.5f,
                                      film->width, film->height));
        }
        hits.resize(rays.size());
        closest_hits(tlas, rays, hits);
        for (size_t i = 0; i < rays.size(); ++i) {
            record_geometry(view, rays[i], hits[i], begin * row + i, film);
            if (layers != nullptr) layers->see(begin * row + i, scene, tlas, view, rays[i], hits[i]);
        }
    });
}

}  // namespace zoe
