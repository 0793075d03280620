#include "tests/frame/rebuild_sequences.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "content/shapes.h"
#include "tests/frame/motion_class.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {
namespace {

constexpr int kFrames = 49;  // Of a clip of 4 s, 12 a second.

// The only mesh that deforms in a scene of the content.
Sequence from_content(const std::string& name, const std::string& scene) {
    Content content = make_content(scene);
    Sequence sequence{name, {}, {}};
    for (int frame = 0; frame < kFrames; ++frame) {
        const Tlas& tlas = play(content, frame / 12.0);
        const auto instance = std::ranges::find(tlas.instances, Motion::kDeforming, &Instance::motion);
        sequence.corners = instance->mesh->corners;
        sequence.frames.emplace_back(instance->positions.begin(), instance->positions.end());
    }
    return sequence;
}

// How far a sequence has gone: to its end, or to its end and back.
float gone(int frame, bool is_back) {
    const float share = static_cast<float>(frame) / (kFrames - 1);
    return is_back ? 1.0f - std::abs(2.0f * share - 1.0f) : share;
}

// A column with three ridges that is wrung: its top makes two turns.
Sequence twist(bool is_back) {
    constexpr float kHeight = 2.0f;
    std::vector<glm::vec3> path;
    for (int k = 0; k <= 40; ++k) path.push_back({0, kHeight * static_cast<float>(k) / 40.0f, 0});
    const Mesh column = make_tube(path, std::vector<float>(path.size(), 0.3f), 24);
    Sequence sequence{is_back ? "twist and back" : "twist", column.corners, {}};
    for (int frame = 0; frame < kFrames; ++frame) {
        std::vector<glm::vec3>& turned = sequence.frames.emplace_back(column.positions);
        for (glm::vec3& p : turned) {
            const float ridge = 1.0f + 0.5f * std::cos(3.0f * std::atan2(p.z, p.x));
            const float angle = 4.0f * std::numbers::pi_v<float> * gone(frame, is_back) * p.y / kHeight;
            const float x = ridge * p.x, z = ridge * p.z;
            p = {std::cos(angle) * x + std::sin(angle) * z, p.y, std::cos(angle) * z - std::sin(angle) * x};
        }
    }
    return sequence;
}

// A ball whose triangles fly apart, each its own way.
Sequence explosion(bool is_back) {
    const Mesh ball = from_triangles(make_sphere(1.0f, 32, 32));
    Sequence sequence{is_back ? "explosion and back" : "explosion", ball.corners, {}};
    std::vector<glm::vec3> ways;
    Rng rng(111);
    for (size_t k = 0; k < ball.corners.size(); ++k) ways.push_back(random_point(rng, 4.0f));
    for (int frame = 0; frame < kFrames; ++frame) {
        std::vector<glm::vec3>& moved = sequence.frames.emplace_back(ball.positions);
        for (size_t v = 0; v < moved.size(); ++v) moved[v] += gone(frame, is_back) * ways[v / 3];
    }
    return sequence;
}

// Triangles that each have vertices of their own change places.
void swap_triangles(Rng& rng, std::vector<glm::vec3>* positions) {
    for (auto k = static_cast<uint32_t>(positions->size() / 3); k > 1; --k) {
        const auto begin = positions->begin();
        const uint32_t other = rng.below(k);
        if (other + 1 < k) std::swap_ranges(begin + 3 * (k - 1), begin + 3 * k, begin + 3 * other);
    }
}

// A ball whose triangles change places, all of them, every so many frames.
// is_back    every other time they return to where they were at first.
Sequence permuted(bool is_back) {
    const Mesh ball = from_triangles(make_sphere(1.0f, 32, 32));
    Sequence sequence{is_back ? "permuted and back" : "permuted", ball.corners, {}};
    Rng rng(112);
    std::vector<glm::vec3> now = ball.positions;
    for (int frame = 0; frame < kFrames; ++frame) {
        if (frame % 8 == 4) {
            swap_triangles(rng, &now);
            if (is_back && frame % 16 == 12) now = ball.positions;
        }
        sequence.frames.push_back(now);
    }
    return sequence;
}

Sequence backwards(const std::string& name, Sequence sequence) {
    sequence.name = name;
    std::ranges::reverse(sequence.frames);
    return sequence;
}

// A ball of spikes that becomes round: the first pose says nothing of which triangles will lie side by side.
Sequence smoothed() {
    const Mesh ball = make_sphere(1.0f, 32, 32);
    Sequence sequence{"smoothed", ball.corners, {}};
    Rng rng(116);
    std::vector<glm::vec3> spikes;
    for (size_t v = 0; v < ball.positions.size(); ++v) spikes.push_back(random_point(rng, 1.5f));
    for (int frame = 0; frame < kFrames; ++frame) {
        const float left = std::max(0.0f, 1.0f - static_cast<float>(frame) / 12.0f);
        std::vector<glm::vec3>& moved = sequence.frames.emplace_back(ball.positions);
        for (size_t v = 0; v < moved.size(); ++v) moved[v] += left * spikes[v];
    }
    return sequence;
}

// Vertices of a ball change places, so that its triangles reach across it; then they return.
Sequence tangled() {
    const Mesh ball = make_sphere(1.0f, 32, 32);
    Sequence sequence{"tangled and back", ball.corners, {}};
    Rng rng(113);
    std::vector<glm::vec3> mixed = ball.positions;
    for (auto k = static_cast<uint32_t>(mixed.size()); k > 1; --k) std::swap(mixed[k - 1], mixed[rng.below(k)]);
    for (int frame = 0; frame < kFrames; ++frame) {
        sequence.frames.push_back(frame >= 8 && frame < 24 ? mixed : ball.positions);
    }
    return sequence;
}

}  // namespace

Mesh from_triangles(const Mesh& mesh) {
    Mesh apart;
    apart.materials = mesh.materials;
    for (const glm::uvec3& corners : mesh.corners) {
        const auto first = static_cast<uint32_t>(apart.positions.size());
        apart.corners.push_back({first, first + 1, first + 2});
        for (int k = 0; k < 3; ++k) apart.positions.push_back(mesh.positions[corners[k]]);
    }
    return apart;
}

std::vector<Sequence> deforming_sequences() {
    const Mesh ball = make_sphere(1.0f, 32, 32);
    return {{"still", ball.corners, std::vector(kFrames, ball.positions)},
            from_content("ripple", "deforming-30"),
            from_content("walk cycle", "skinned-1"),
            twist(false),
            twist(true),
            explosion(false),
            explosion(true),
            permuted(false),
            tangled(),
            backwards("assembled", explosion(false)),
            backwards("untwisted", twist(false)),
            smoothed()};
}

Sequence permuted_and_back() {
    return permuted(true);
}

Sequence random_sequence(uint64_t seed) {
    struct Wave {
        glm::vec3 way, along;
        float turns_a_frame, start;
    };
    Rng rng(seed);
    const bool is_torn = seed % 3 == 0;
    const Mesh ball = is_torn ? from_triangles(make_sphere(1.0f, 28, 28)) : make_sphere(1.0f, 24, 32);
    std::vector<Wave> waves;
    for (int k = 0; k < 4; ++k) {
        waves.push_back({2.0f * rng.uniform() * random_point(rng, 1.0f), random_point(rng, 8.0f), 0.6f * rng.uniform(),
                         6.0f * rng.uniform()});
    }
    const int pause = 4 + static_cast<int>(rng.below(20));
    Sequence sequence{"seed " + std::to_string(seed), ball.corners, {}};
    std::vector<glm::vec3> rest = ball.positions;
    for (int frame = 0; frame < kFrames; ++frame) {
        if (is_torn && frame % pause == pause - 1) swap_triangles(rng, &rest);
        std::vector<glm::vec3>& moved = sequence.frames.emplace_back(rest);
        for (size_t v = 0; v < moved.size(); ++v) {
            for (const Wave& wave : waves) {
                const float turn = glm::dot(wave.along, rest[v]) + wave.turns_a_frame * static_cast<float>(frame);
                moved[v] += std::sin(turn + wave.start) * wave.way;
            }
        }
    }
    return sequence;
}

}  // namespace zoe::test
