// A program outside of the project that uses the installed package: a scene made in code, and one from a file.
#include <cstdio>

#include "engine/zoetrope.h"

int main(int argc, char** argv) {
    zoe::Scene scene;
    zoe::Mesh mesh;
    mesh.positions = {{-1, -1, -2}, {1, -1, -2}, {0, 1, -2}};
    mesh.corners = {{0, 1, 2}};
    zoe::Node node;
    node.name = "triangle";
    node.mesh = scene.add(mesh);
    scene.add(node);
    const zoe::Hit hit = zoe::closest_hit(zoe::advance(scene, 0.0), {.origin = {0, 0, 0}, .direction = {0, 0, -1}});
    if (!hit || hit.t != 2.0f) {
        std::fprintf(stderr, "expected a hit at 2, found %f\n", hit.t);
        return 1;
    }
    std::printf("hit %s at %.3f\n", scene[hit.node].name.c_str(), hit.t);
    if (argc < 2) return 0;
    zoe::Scene loaded = zoe::load_gltf(argv[1]);
    const zoe::Tlas& tlas = zoe::advance(loaded, 0.5);
    std::printf("%s: %zu instances\n", argv[1], tlas.instances.size());
    return tlas.instances.empty() ? 1 : 0;
}
