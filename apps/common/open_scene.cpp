#include "apps/common/open_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "apps/common/parse.h"
#include "apps/common/usage_error.h"

namespace zoe {
namespace {

bool looks_like_file(const std::string& name) {
    return std::filesystem::exists(name) || name.find('/') != std::string::npos ||
           std::filesystem::path(name).has_extension();
}

/// NAME and NAME-SIZE come before files and folders that are called so. "rigid-1.5" is a broken size, "rigid-1.glb" a file.
bool is_content(const std::string& name) {
    const std::string extension = std::filesystem::path(name).extension();
    const bool is_file_name = extension.size() > 1 && !(extension[1] >= '0' && extension[1] <= '9');
    return is_content_name(name) && name.find('/') == std::string::npos && !is_file_name;
}

/// Whether a shown mesh, be it only for a moment, is one that `matches`.
template <typename Matches>
bool shows(const Scene& scene, const Matches& matches) {
    const auto is_match = [&](MeshId mesh) { return mesh != kNone<MeshId> && matches(scene[mesh]); };
    return std::any_of(scene.nodes.begin(), scene.nodes.end(), [&](const Node& node) {
        if (!node.is_shown) return false;
        if (!node.sequence) return is_match(node.mesh);
        return std::any_of(node.sequence->meshes.begin(), node.sequence->meshes.end(), is_match);
    });
}

bool has_triangles(const Mesh& mesh) {
    return !mesh.corners.empty();
}

/// Only triangles with finite corners can be hit, and no motion makes a corner finite.
bool has_finite_triangles(const Mesh& mesh) {
    const auto is_finite = [&](uint32_t vertex) {
        const glm::vec3& p = mesh.positions[vertex];
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    };
    return std::any_of(mesh.corners.begin(), mesh.corners.end(), [&](const glm::uvec3& corner) {
        return is_finite(corner.x) && is_finite(corner.y) && is_finite(corner.z);
    });
}

void set_level(Scene& scene, int level) {
    bool has_surface = false;
    for (Mesh& mesh : scene.meshes) {
        if (!mesh.surface) continue;
        has_surface = true;
        mesh.surface->options.level = level;
        mesh.surface->pixels = 0.0f;
    }
    if (!has_surface) throw UsageError(fmt::format("--subdivide {}: the scene has no subdivision surface", level));
    if (const std::string broken = check(scene); !broken.empty()) throw SceneError(scene.file, "", broken);
}

}  // namespace

Content open_scene(const std::string& name, double fps, std::optional<int> level) {
    Content content;
    if (is_content(name)) {
        content = make_content(name);
    } else if (std::filesystem::is_directory(name)) {
        throw SceneError(name, "", "is a folder, not a scene");
    } else if (!std::filesystem::exists(name) && is_sequence_pattern(name)) {
        content.scene = load_sequence(name, fps);
    } else if (std::filesystem::path(name).extension() == ".obj") {
        content.scene = load_obj(name, {.subdivision_level = level});
    } else if (looks_like_file(name)) {
        content.scene = load_gltf(name);
    } else {
        content = make_content(name);  // its error lists the names
    }
    if (level) set_level(content.scene, *level);
    if (content.write) content.write(content.scene, 0.0);
    if (!shows(content.scene, has_triangles)) throw SceneError(name, "", "the scene shows no mesh");
    // What is written may be finite later.
    if (!content.write && !shows(content.scene, has_finite_triangles))
        throw SceneError(name, "", "the scene shows no triangle with finite corners");
    return content;
}

const Tlas& advance(Content& content, double time_s, FrameStats* stats) {
    if (content.write) content.write(content.scene, time_s);
    return advance(content.scene, time_s, stats);
}

std::string list_clips(const Scene& scene) {
    std::string list;
    for (size_t i = 0; i < scene.clips.size(); ++i) {
        list += fmt::format("{}{} '{}'", i ? ", " : "", i, one_line(scene.clips[i].name));
    }
    return list.empty() ? "none" : list;
}

void choose_clips(Scene& scene, const std::string& choice) {
    const size_t clip_count = scene.clips.size();
    std::vector<ClipId> clips;
    if (choice == "all") {
        for (size_t i = 0; i < clip_count; ++i) clips.push_back(ClipId{static_cast<uint32_t>(i)});
    } else {
        size_t found = 0;
        while (found < clip_count && scene.clips[found].name != choice) ++found;
        if (found == clip_count) found = static_cast<size_t>(parse_count(choice, 1 << 30).value_or(1 << 30));
        if (found >= clip_count) {
            throw UsageError(
                fmt::format("--clip {}: there is no such clip; the scene's clips are: {}", choice, list_clips(scene)));
        }
        clips.push_back(ClipId{static_cast<uint32_t>(found)});
    }
    scene.playback.clips = std::move(clips);
}

double duration_s(const Scene& scene, std::span<const ClipId> clips) {
    double duration = 0.0;
    for (const ClipId clip : clips) duration = std::max(duration, scene.clips.at(index(clip)).duration_s);
    for (const Node& node : scene.nodes) {
        if (node.sequence && node.is_shown) {
            duration = std::max(duration, static_cast<double>(node.sequence->meshes.size()) / node.sequence->fps);
        }
    }
    return duration;
}

void print_warnings(const std::string& program, const Scene& scene, std::vector<std::string>* printed) {
    for (const auto& [text, count] : scene.warnings()) {
        if (std::find(printed->begin(), printed->end(), text) != printed->end()) continue;
        printed->push_back(text);
        const std::string times = count > 1 ? fmt::format(" ({} times)", count) : "";
        fmt::print(stderr, "{}: warning: {}{}\n", program, one_line(text), times);
    }
}

std::string one_line(const std::string& text) {
    std::string line = text;
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    return line;
}

}  // namespace zoe
