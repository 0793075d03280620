#include "tests/fuzz/entries.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <limits>

#include <fmt/format.h>

#include "engine/frame/frame.h"
#include "engine/math/rng.h"
#include "engine/scene/decode_image.h"
#include "engine/scene/gltf.h"
#include "engine/scene/image.h"
#include "engine/scene/sequence.h"
#include "tests/fuzz/files.h"

namespace zoe::test {
namespace {

namespace fs = std::filesystem;

// What is played: more than that takes seconds, and shows nothing that less does not.
constexpr size_t kMaxNodes = 2000, kMaxTriangles = 20000;
constexpr int kRaysAFrame = 6;

// Less than any user's: a file that is too much is refused as any other is, and sooner.
constexpr GltfOptions kOptions{.max_pixels = 1 << 18, .max_free_numbers = 1 << 16};

size_t shown_triangle_count(const Scene& scene) {
    size_t count = 0;
    for (const Node& node : scene.nodes) {
        size_t most = node.mesh == kNone<MeshId> ? 0 : scene[node.mesh].corners.size();
        if (node.sequence) {
            for (const MeshId mesh : node.sequence->meshes) most = std::max(most, scene[mesh].corners.size());
        }
        count += most;
    }
    return count;
}

// Towards what is shown from all around it, and from nowhere.
Ray ray_at(const Aabb& bounds, Rng& rng) {
    const auto random = [&] { return glm::vec3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)); };
    if (bounds.is_empty()) return {random(), random()};
    const glm::vec3 middle = 0.5f * bounds.lo + 0.5f * bounds.hi, half = 0.5f * bounds.hi - 0.5f * bounds.lo;
    const glm::vec3 target = middle + half * random();
    const glm::vec3 origin = middle + 2.0f * half * random() + random();
    return {origin, target - origin};
}

std::string fault_of(const Tlas& tlas, const Scene& scene, const Ray& ray) {
    const Hit hit = closest_hit(tlas, ray);
    if (any_hit(tlas, ray) != static_cast<bool>(hit)) return "closest_hit and any_hit do not agree";
    if (!hit) return "";
    if (!(hit.t >= 0.0f && std::isfinite(hit.t))) return fmt::format("a hit at t = {}", hit.t);
    if (!(hit.u >= 0.0f && hit.v >= 0.0f && hit.u <= 1.0f && hit.v <= 1.0f))
        return fmt::format("a hit at u = {}, v = {}", hit.u, hit.v);
    if (index(hit.node) >= scene.nodes.size()) return fmt::format("a hit of node {}", index(hit.node));
    if (!scene[hit.node].is_shown) return fmt::format("a hit of node {}, which is not shown", index(hit.node));
    const size_t triangle_count = tlas[hit.node].mesh->corners.size();
    if (hit.primitive >= triangle_count) return fmt::format("a hit of triangle {} of {}", hit.primitive, triangle_count);
    return "";
}

// Some frames of a scene that loaded, and some rays each.
std::string play(Scene& scene) {
    if (std::string broken = check(scene); !broken.empty()) return "it loaded, and check says: " + broken;
    if (scene.nodes.size() > kMaxNodes || shown_triangle_count(scene) > kMaxTriangles) return "";
    Rng rng(1);
    for (const double time_s : {0.0, 0.3, 1.0, -1e6}) {
        const Tlas& tlas = advance(scene, time_s);
        for (int k = 0; k < kRaysAFrame; ++k) {
            if (std::string fault = fault_of(tlas, scene, ray_at(tlas.bounds(), rng)); !fault.empty()) {
                return fmt::format("at {} s: {}", time_s, fault);
            }
        }
    }
    return "";
}

std::string fault_of_message(const std::string& message, const std::string& file) {
    const bool is_line = std::none_of(message.begin(), message.end(),
                                      [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; });
    if (!is_line) return "not one plain line: " + message;
    if (!message.starts_with(file)) return "a message that does not name the file: " + message;
    if (message.size() > 2000) return fmt::format("a message of {} bytes", message.size());
    return "";
}

template <typename Load>
FuzzOutcome load_and_play(const std::string& file, Load&& load) {
    FuzzOutcome outcome;
    try {
        Scene scene = load();
        outcome.is_accepted = true;
        for (const auto& [text, count] : scene.warnings()) {
            if (outcome.broken.empty()) outcome.broken = fault_of_message(text, "");
        }
        if (outcome.broken.empty()) outcome.broken = play(scene);
    } catch (const SceneError& error) {
        outcome.broken =
            outcome.is_accepted ? std::string("it loaded, and ") + error.what() : fault_of_message(error.what(), file);
    } catch (const std::exception& error) {
        outcome.broken = std::string("another exception than SceneError: ") + error.what();
    }
    return outcome;
}

/// A folder with what scenes may name, for as long as the program runs.
const TempFolder& scene_folder() {
    static const TempFolder folder(memory_folder());
    static const bool is_filled = [] {
        std::vector<uint8_t> pixels(4 * 4 * 4, 200);
        write_png(folder / "a.png", 4, 4, pixels);
        folder.write("a.bin", std::string(4096, '\0'));
        return true;
    }();
    static_cast<void>(is_filled);
    return folder;
}

}  // namespace

FuzzOutcome fuzz_gltf(FuzzBytes bytes) {
    static const fs::path file = scene_folder() / "scene.gltf";
    overwrite(file, bytes);
    return load_and_play(file.string(), [] { return load_gltf(file, kOptions); });
}

FuzzOutcome fuzz_image(FuzzBytes bytes) {
    FuzzOutcome outcome;
    Image image;
    std::string error;
    try {
        outcome.is_accepted = decode_image(bytes, &image, &error, kOptions.max_pixels);
    } catch (const std::exception& exception) {
        return {false, std::string("an exception: ") + exception.what()};
    }
    const size_t pixel_count = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
    if (outcome.is_accepted) {
        const bool is_sound =
            image.width > 0 && image.height > 0 && image.texel_bytes() * pixel_count <= 4 * kOptions.max_pixels;
        if (!is_sound || image.pixels.size() != image.texel_bytes() * pixel_count) {
            outcome.broken = fmt::format("{} bytes for {} x {} pixels", image.pixels.size(), image.width, image.height);
        }
    } else if (error.empty() || !image.pixels.empty()) {
        outcome.broken = "refused without a reason, or with pixels";
    } else {
        outcome.broken = fault_of_message(error, "");
    }
    return outcome;
}

FuzzOutcome fuzz_sequence(FuzzBytes bytes) {
    static const TempFolder folder(memory_folder());
    static const std::string pattern = (folder / "a_%d.glb").string();
    const size_t file_count = bytes.empty() ? 0 : std::to_integer<size_t>(bytes[0]) % 3 + 1;
    if (!bytes.empty()) bytes = bytes.subspan(1);
    for (size_t k = 0; k < 3; ++k) {
        const fs::path file = folder / fmt::format("a_{}.glb", k);
        if (k >= file_count) {
            fs::remove(file);
            continue;
        }
        size_t size = bytes.size();
        if (k + 1 < file_count && size >= 4) {
            uint32_t length = 0;
            std::memcpy(&length, bytes.data(), sizeof length);
            bytes = bytes.subspan(4);
            size = std::min<size_t>(length, bytes.size());
        }
        overwrite(file, bytes.first(size));
        bytes = bytes.subspan(size);
    }
    return load_and_play(folder.path().string(), [] { return load_sequence(pattern, 24.0, kOptions); });
}

std::string join_sequence(std::span<const std::string> files) {
    std::string joined(1, static_cast<char>(files.size() - 1));
    for (size_t k = 0; k < files.size(); ++k) {
        const uint32_t length = static_cast<uint32_t>(files[k].size());
        if (k + 1 < files.size()) joined.append(reinterpret_cast<const char*>(&length), sizeof length);
        joined += files[k];
    }
    return joined;
}

}  // namespace zoe::test
