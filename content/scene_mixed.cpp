#include <algorithm>
#include <cmath>

#include "content/scenes.h"

namespace zoe {

// All classes in one room: a cloth over the floor, a swarm of tori, a ball that bursts.
Content make_mixed_scene(int size) {
    Content content;
    Scene& scene = content.scene;
    add_room(scene, 72000 * size);
    const int copy_count = 5 * size;
    const glm::vec3 swarm = orbit_lattice(copy_count).extent();
    const float scale = 2.4f / std::max({swarm.x, swarm.y, swarm.z});
    add_orbits(scene, copy_count,
               {.translation = {-1.6f, 2.1f, -1.2f}, .rotation = {1, 0, 0, 0}, .scale = glm::vec3(scale)});
    add_wave(scene, static_cast<int>(std::lround(std::sqrt(2500.0f * static_cast<float>(size)))), {0, 0.5f, 0});
    content.write = add_explosion(scene, 1000 * size,
                                  {.translation = {1.5f, 1.9f, 0.2f}, .rotation = {1, 0, 0, 0}, .scale = glm::vec3(0.7f)});
    add_view(scene, {1.0f, 2.2f, 3.9f}, {-0.2f, 1.4f, -1.0f}, 60.0f);
    return content;
}

}  // namespace zoe
