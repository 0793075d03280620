#include "content/content.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>
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
    Maker{{"default", "a zoetrope in a room, from default.glb; it has one size", 0, 0}, load_default},
    Maker{{"static", "a room of about SIZE triangles, one in ten long and thin", 10000, 10'000'000}, make_static_scene},
    Maker{{"rigid", "SIZE copies of a mesh of 1,000 triangles, each on its own way", 25, 100'000}, make_rigid_scene},
    Maker{{"instances", "SIZE small copies of one mesh, in rows that move", 1000, 1'000'000}, make_instances_scene},
    Maker{{"deforming", "a cloth of SIZE x SIZE quads in travelling waves (morph targets)", 100, 2000},
          make_deforming_scene},
    Maker{{"skinned", "SIZE walking figures with 14 joints each", 8, 2000}, make_skinned_scene},
    Maker{{"character", "one walking figure of SIZE thousand triangles", 20, 1000}, make_character_scene},
    Maker{{"dancers", "SIZE dancing figures with creases: skinned cages of subdivision surfaces", 1, 2000},
          make_dancers_scene},
    Maker{{"surface", "a morphing ring: the subdivision surface of a cage of SIZE x SIZE quads", 24, 500},
          make_surface_scene},
    Maker{{"arbitrary", "an exploding ball of SIZE triangles, written each frame", 5000, 5'000'000}, make_arbitrary_scene},
    Maker{{"topology", "drops that meet and part, polygonised each frame in SIZE^3 cells", 32, 400}, make_topology_scene},
    Maker{{"mixed", "a room, moving copies, a cloth and an explosion at once; SIZE scales all of them", 1, 100},
          make_mixed_scene},
};

const Maker* find_maker(std::string_view name) {
    const auto found =
        std::find_if(kMakers.begin(), kMakers.end(), [&](const Maker& maker) { return name == maker.info.name; });
    return found == kMakers.end() ? nullptr : &*found;
}

// "rigid-50": "rigid" and "50"; no size where there is no dash.
struct Parts {
    std::string_view name;
    std::optional<std::string_view> size;
};

Parts split(std::string_view text) {
    const size_t dash = text.find('-');
    if (dash == text.npos) return {text, std::nullopt};
    return {text.substr(0, dash), text.substr(dash + 1)};
}

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
    std::string names;
    for (const Maker& maker : kMakers) names += fmt::format("{}{}", names.empty() ? "" : ", ", maker.info.name);
    throw SceneError(name, "", fmt::format("{}; there are {}: NAME or NAME-SIZE, such as rigid-50", reason, names));
}

void check_size(const std::string& name, const ContentInfo& info, int64_t size) {
    if (info.max_size == 0) refuse(name, fmt::format("{} has one size", info.name));
    if (size < 1 || size > info.max_size)
        refuse(name, fmt::format("{}'s size is a whole number from 1 to {}", info.name, info.max_size));
}

}  // namespace

std::span<const ContentInfo> content_list() {
    static const auto list = [] {
        std::array<ContentInfo, kMakers.size()> infos{};
        std::transform(kMakers.begin(), kMakers.end(), infos.begin(), [](const Maker& maker) { return maker.info; });
        return infos;
    }();
    return list;
}

bool is_content_name(const std::string& name) {
    return find_maker(split(name).name) != nullptr;
}

ContentName parse_content_name(const std::string& name) {
    const Parts parts = split(name);
    const Maker* maker = find_maker(parts.name);
    if (!maker) refuse(name, "no such scene");
    ContentName parsed{.info = &maker->info};
    if (parts.size) {
        uint32_t size = 0;  // Stays 0, which is refused, where the text is no such number.
        const char* const end = parts.size->data() + parts.size->size();
        const std::from_chars_result read = std::from_chars(parts.size->data(), end, size);
        check_size(name, maker->info, read.ec == std::errc{} && read.ptr == end ? size : 0);
        parsed.size = static_cast<int>(size);
    }
    return parsed;
}

Content make_content(const std::string& name, int size) {
    const ContentName parsed = parse_content_name(name);
    if (size != 0) {
        if (parsed.size != 0) refuse(name, fmt::format("its size is in its name, and yet {} was asked for", size));
        check_size(name, *parsed.info, size);
    }
    const int asked = size != 0 ? size : parsed.size;
    return find_maker(parsed.info->name)->make(asked != 0 ? asked : parsed.info->default_size);
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
