// Deformers, each beside a memcpy that moves as many bytes. Bytes count what is read and what is written, once.
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/deform/morph.h"
#include "engine/deform/skin.h"
#include "tests/bench/harness.h"
#include "tests/math/random_inputs.h"

namespace zoe::test {

namespace {

constexpr uint32_t kInfluences = 4, kJoints = 64;
constexpr size_t kTargets = 3;

SkinBinding binding_of(size_t vertex_count) {
    Rng rng(42);
    SkinBinding binding{kInfluences, {}, {}};
    for (size_t v = 0; v < vertex_count; ++v) {
        const float w = rng.uniform(0.2f, 0.7f);
        for (const float weight : {w, 0.5f * (1.0f - w), 0.3f * (1.0f - w), 0.2f * (1.0f - w)}) {
            binding.joints.push_back(static_cast<uint16_t>((v * kJoints / vertex_count + rng.below(4)) % kJoints));
            binding.weights.push_back(weight);
        }
    }
    return binding;
}

size_t skin_bytes(size_t vertex_count, bool has_normals) {
    return vertex_count * ((has_normals ? 4 : 2) * sizeof(glm::vec3) + kInfluences * (sizeof(uint16_t) + sizeof(float)));
}

struct Skinned {
    std::vector<glm::vec3> positions, normals;
    SkinBinding binding;
    std::vector<Affine> joints;
    std::vector<glm::vec3> skinned_positions, skinned_normals;

    Skinned(size_t vertex_count, bool has_normals, bool is_rigid)
        : positions(random_points(vertex_count, 41)),
          normals(has_normals ? random_points(vertex_count, 40) : std::vector<glm::vec3>()),
          binding(binding_of(vertex_count)),
          joints(kJoints),
          skinned_positions(vertex_count),
          skinned_normals(normals.size()) {
        Rng rng(43);
        for (Affine& joint : joints) {
            joint = random_affine(rng, 0.9, 1.1, 1.0f);
            if (is_rigid) joint.linear = glm::mat3_cast(random_rotation(rng));
        }
    }
    void move(const PackedJoints& packed) {
        skin(binding, packed, positions, normals, skinned_positions, skinned_normals);
        benchmark::DoNotOptimize(skinned_positions.data());
        benchmark::DoNotOptimize(skinned_normals.data());
        benchmark::ClobberMemory();
    }
};

void skin_linear(benchmark::State& state, size_t vertex_count, bool has_normals) {
    Skinned skinned(vertex_count, has_normals, false);
    PackedJoints packed;
    for (auto _ : state) {
        pack_joints(skinned.joints, &packed);
        skinned.move(packed);
    }
    count_per_second(state, "vertices", vertex_count);
    count_per_second(state, "bytes", skin_bytes(vertex_count, has_normals));
    for (size_t v = 0; v < vertex_count; ++v) {
        glm::dvec3 expected(0.0);
        for (size_t k = v * kInfluences; k < (v + 1) * kInfluences; ++k) {
            const Affine& joint = skinned.joints[skinned.binding.joints[k]];
            const glm::dvec3 moved =
                glm::dmat3(joint.linear) * glm::dvec3(skinned.positions[v]) + glm::dvec3(joint.translation);
            expected += double(skinned.binding.weights[k]) * moved;
        }
        if (!is_near(skinned.skinned_positions[v], expected)) {
            return fail(state, "vertex " + std::to_string(v) + " is in a wrong place");
        }
    }
}

void skin_positions(benchmark::State& state, size_t vertex_count) {
    skin_linear(state, vertex_count, false);
}
void skin_positions_and_normals(benchmark::State& state, size_t vertex_count) {
    skin_linear(state, vertex_count, true);
}

void skin_dual(benchmark::State& state, size_t vertex_count) {
    Skinned skinned(vertex_count, true, true);
    const std::vector<glm::vec3> centres(kJoints, glm::vec3(0.0f));
    const std::vector<uint8_t> is_used(kJoints, 1);
    PackedJoints packed;
    for (auto _ : state) {
        pack_joints_dual(skinned.joints, centres, is_used, &packed);
        skinned.move(packed);
    }
    count_per_second(state, "vertices", vertex_count);
    count_per_second(state, "bytes", skin_bytes(vertex_count, true));
    // A rigid motion keeps lengths.
    for (size_t v = 0; v < vertex_count; ++v) {
        const float length = glm::length(skinned.normals[v]);
        if (!(std::abs(glm::length(skinned.skinned_normals[v]) - length) < 1e-4f)) {
            return fail(state, "the normal of vertex " + std::to_string(v) + " has another length");
        }
    }
}

size_t morph_bytes(size_t vertex_count) {
    return vertex_count * (2 + kTargets) * sizeof(glm::vec3);
}

void morph(benchmark::State& state, size_t vertex_count) {
    const std::vector<glm::vec3> base = random_points(vertex_count, 44);
    std::vector<MorphTarget> targets(kTargets);
    for (size_t k = 0; k < kTargets; ++k) targets[k].positions = random_points(vertex_count, 45 + k);
    const std::vector<float> weights = {0.5f, 0.3f, 0.7f};
    std::vector<glm::vec3> out(vertex_count);
    for (auto _ : state) {
        morph_positions(base, targets, weights, out);
        benchmark::DoNotOptimize(out.data());
        benchmark::ClobberMemory();
    }
    count_per_second(state, "vertices", vertex_count);
    count_per_second(state, "bytes", morph_bytes(vertex_count));
    for (size_t v = 0; v < vertex_count; ++v) {
        glm::dvec3 expected(base[v]);
        for (size_t k = 0; k < kTargets; ++k) expected += double(weights[k]) * glm::dvec3(targets[k].positions[v]);
        if (!is_near(out[v], expected)) return fail(state, "vertex " + std::to_string(v) + " is in a wrong place");
    }
}

void add(const std::string& method, size_t vertex_count, void (*run)(benchmark::State&, size_t), size_t moved_bytes) {
    const std::string name = method + std::to_string(vertex_count);
    benchmark::RegisterBenchmark(name.c_str(), run, vertex_count)->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark((name + "/memcpy").c_str(), copy_bytes, moved_bytes)->Unit(benchmark::kMicrosecond);
}

}  // namespace

void register_deformers() {
    // A figure, which stays in the nearest caches; a fine one; and more than any cache holds.
    for (const size_t vertex_count : {10000, 100000, 1000000}) {
        add("skin_positions/", vertex_count, skin_positions, skin_bytes(vertex_count, false));
        add("skin_positions_and_normals/", vertex_count, skin_positions_and_normals, skin_bytes(vertex_count, true));
        add("skin_dual/", vertex_count, skin_dual, skin_bytes(vertex_count, true));
        add("morph_positions/", vertex_count, morph, morph_bytes(vertex_count));
    }
}

}  // namespace zoe::test
