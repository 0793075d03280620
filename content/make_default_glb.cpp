// Writes the default scene: make_default_glb [FILE], content/default.glb of the current folder unless told.
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>

#include "content/make_default_parts.h"

namespace zoe {
namespace {

// The rotation of a camera that looks from one point at another, +Y up.
glm::quat look(const glm::vec3& eye, const glm::vec3& target) {
    const glm::vec3 d = target - eye;
    return glm::angleAxis(std::atan2(-d.x, -d.z), glm::vec3(0, 1, 0)) *
           glm::angleAxis(std::atan2(d.y, std::hypot(d.x, d.z)), glm::vec3(1, 0, 0));
}

void add_cameras(GlbWriter& glb) {
    const auto camera = [&](const char* name, float degrees) {
        glb.document()["cameras"].push_back(
            {{"name", name},
             {"type", "perspective"},
             {"perspective", {{"yfov", glm::radians(degrees)}, {"aspectRatio", 16.0 / 9.0}, {"znear", 0.05}}}});
        return static_cast<int>(glb.document()["cameras"].size() - 1);
    };
    const glm::vec3 eye(0.55f, 1.74f, 3.72f), target(0.0f, 0.98f, 0.0f);
    glb.node("view", -1, Trs{eye, look(eye, target), glm::vec3(1)}, -1, {{"camera", camera("view", 37.0f)}});

    // A slow swing around the drum, nearer.
    const int swing = glb.node("swing", -1, glm::vec3(0.0f), -1);
    glb.document()["nodes"][static_cast<size_t>(swing)]["camera"] = camera("swing", 34.0f);
    Sampler place{.width = 3}, turn{.is_rotation = true, .width = 4};
    for (int k = 0; k <= 48; ++k) {
        const float share = static_cast<float>(k) / 48.0f, phase = 2.0f * std::numbers::pi_v<float> * share;
        const float angle = 0.22f + 0.42f * std::sin(phase);
        const glm::vec3 from(2.3f * std::sin(angle), 1.68f + 0.12f * std::cos(phase), 2.3f * std::cos(angle));
        const glm::quat q = look(from, {-0.03f, 1.06f, 0.0f});
        place.times_s.push_back(GlbWriter::kDuration_s * share);
        turn.times_s.push_back(GlbWriter::kDuration_s * share);
        place.values.insert(place.values.end(), {from.x, from.y, from.z});
        turn.values.insert(turn.values.end(), {q.x, q.y, q.z, q.w});
    }
    glb.animate(swing, "translation", place);
    glb.animate(swing, "rotation", turn);
}

}  // namespace
}  // namespace zoe

int main(int argc, char** argv) {
    if (argc != 2 || argv[1][0] == '-') {
        std::fprintf(stderr, "usage: make_default_glb FILE.glb   writes the default scene\n");
        return 2;
    }
    try {
        zoe::GlbWriter glb;
        glb.material("paint by vertex", glm::vec3(1.0f));
        zoe::add_cameras(glb);
        zoe::add_room(glb);
        zoe::add_furniture(glb);
        zoe::add_zoetrope(glb);
        zoe::add_clock(glb);
        zoe::add_yarn(glb);
        zoe::add_cat(glb);
        zoe::add_flower(glb);
        zoe::add_jelly(glb);
        zoe::add_lava_lamp(glb);
        glb.write(argv[1]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make_default_glb: %s\n", error.what());
        return 1;
    }
    return 0;
}
