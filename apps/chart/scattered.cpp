#include "apps/chart/scattered.h"

#include <cmath>

#include "apps/chart/closed_ball.h"

namespace zoe::chart {

Content make_scattered(int count) {
    Content content;
    Mesh ball = ClosedBall(10).mesh;
    const MeshId mesh = content.scene.add(std::move(ball));
    for (int k = 0; k < count; ++k) {
        Node node;
        node.mesh = mesh;
        content.scene.add(std::move(node));
    }
    // So that as many fill the cube equally well.
    const float largest = 8.0f / std::cbrt(static_cast<float>(count));
    content.write = [=](Scene& scene, double time_s) {
        Rng rng(static_cast<uint64_t>(std::llround(24.0 * time_s)));
        for (Node& node : scene.nodes) {
            node.local.translation = 20.0f * glm::vec3(rng.uniform(), rng.uniform(), rng.uniform());
            node.local.scale = glm::vec3(largest * std::pow(1e-3f, rng.uniform()));
        }
        scene.touch();
    };
    content.write(content.scene, 0.0);
    return content;
}

}  // namespace zoe::chart
