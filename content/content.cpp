#include "content/content.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <system_error>

#include <fmt/format.h>

#include "content/scenes.h"
#include "engine/scene/gltf.h"

namespace zoe {
namespace {

struct Maker {
    ContentInfo info;
    Content (*make)(int size);
};

Content load_default(int) {
    Content content;
    content.scene = load_gltf(content_folder() / "default.glb");
    return content;
}

const std::array kMakers = {
    Maker{{"default", "a zoetrope in a room, from default.glb; it has one size", 1}, load_default},
    Maker{{"static", "a room of about SIZE triangles, half of them long and thin", 10000}, make_static_scene},
    Maker{{"rigid", "SIZE copies of a mesh of 1,000 triangles, each on its own way", 25}, make_rigid_scene},
    Maker{{"instances", "SIZE small copies of one mesh, in rows that move", 1000}, make_instances_scene},
    Maker{{"deforming", "a cloth of SIZE x SIZE quads in travelling waves (morph targets)", 100}, make_deforming_scene},
    Maker{{"skinned", "SIZE walking figures with 14 joints each", 8}, make_skinned_scene},
    Maker{{"arbitrary", "an exploding ball of SIZE triangles, written each frame", 5000}, make_arbitrary_scene},
    Maker{{"topology", "drops that meet and part, polygonised each frame in SIZE^3 cells", 32}, make_topology_scene},
    Maker{{"mixed", "a room, moving copies, a cloth and an explosion at once; SIZE scales all of them", 4},
          make_mixed_scene},
};

}  // namespace

std::span<const ContentInfo> content_list() {
    static const auto list = [] {
        std::array<ContentInfo, kMakers.size()> infos{};
        std::transform(kMakers.begin(), kMakers.end(), infos.begin(), [](const Maker& maker) { return maker.info; });
        return infos;
    }();
    return list;
}

Content make_content(const std::string& name, int size) {
    std::string names;
    for (const Maker& maker : kMakers) {
        if (name == maker.info.name) {
            if (size < 0) throw SceneError(name, "", fmt::format("a size of {} is below 0", size));
            return maker.make(size == 0 ? maker.info.default_size : size);
        }
        names += fmt::format("{}{}", names.empty() ? "" : ", ", maker.info.name);
    }
    throw SceneError(name, "", "no such scene; there are " + names);
}

std::filesystem::path content_folder() {
    if (const char* folder = std::getenv("ZOETROPE_CONTENT")) return folder;
    std::error_code ignored;
    const std::filesystem::path source = ZOETROPE_SOURCE_CONTENT;
    if (std::filesystem::exists(source / "default.glb", ignored)) return source;
    // Installed: bin/ is beside share/.
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", ignored);
    return program.parent_path().parent_path() / "share" / "zoetrope" / "content";
}

}  // namespace zoe
