#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace zoe::test {
namespace {

namespace fs = std::filesystem;
const fs::path kRoot = ZOETROPE_SOURCE_DIR;

struct Include {
    std::string path;
    bool is_system;
    int line;
};

struct Source {
    std::string name;  ///< From the root: "engine/bvh/refit.h".
    std::vector<std::string> lines;
    std::vector<Include> includes;

    bool is_header() const { return name.ends_with(".h"); }
    /// "engine/bvh", "apps/demo", "content".
    std::string folder() const { return fs::path(name).parent_path().generic_string(); }
};

std::vector<Source> sources_under(const std::vector<std::string>& folders) {
    std::vector<Source> sources;
    for (const std::string& folder : folders) {
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kRoot / folder)) {
            if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
            Source source{fs::relative(entry.path(), kRoot).generic_string(), {}, {}};
            std::ifstream in(entry.path());
            for (std::string line; std::getline(in, line);) {
                source.lines.push_back(line);
                if (!line.starts_with("#include ")) continue;
                const size_t begin = line.find_first_of("<\""), end = line.find_last_of(">\"");
                if (begin == std::string::npos || end <= begin) continue;
                source.includes.push_back(
                    {line.substr(begin + 1, end - begin - 1), line[begin] == '<', int(source.lines.size())});
            }
            sources.push_back(std::move(source));
        }
    }
    std::sort(sources.begin(), sources.end(), [](const Source& a, const Source& b) { return a.name < b.name; });
    return sources;
}

const std::vector<std::string> kAllFolders = {"engine", "content", "apps", "tests"};

/// What each folder may include besides itself: math <- bvh, deform <- scene <- frame <- render <- content, apps, tests.
const std::map<std::string, std::set<std::string>>& allowed_folders() {
    static const std::map<std::string, std::set<std::string>> allowed = {
        {"engine/math", {}},
        {"engine/bvh", {"engine/math"}},
        {"engine/deform", {"engine/math"}},
        {"engine/scene", {"engine/math", "engine/bvh", "engine/deform"}},
        {"engine/frame", {"engine/math", "engine/bvh", "engine/deform", "engine/scene"}},
        {"engine/render", {"engine/math", "engine/bvh", "engine/deform", "engine/scene", "engine/frame"}},
    };
    return allowed;
}

/// The oracle: the one thing of the tests that a program may ask, and only those that judge by it.
const std::set<std::string>& oracle_headers() {
    static const std::set<std::string> headers = {"tests/support/brute_force.h", "tests/support/point_distance.h",
                                                  "tests/support/world_triangle.h"};
    return headers;
}

/// What is wrong with an include by the layers; empty where nothing is.
std::string broken_layer(const std::string& folder, const std::string& included) {
    const std::string target = fs::path(included).parent_path().generic_string();
    if (folder == target) return "";
    if (const auto layer = allowed_folders().find(folder); layer != allowed_folders().end()) {
        return layer->second.contains(target) ? "" : folder + " must not know " + target;
    }
    if (folder == "engine") return target.starts_with("engine/") ? "" : "the engine must not know " + target;
    if (folder == "content") return target.starts_with("engine") ? "" : "content knows the engine only, not " + target;
    if (folder.starts_with("apps")) {
        if (!target.starts_with("tests")) return "";
        if (!oracle_headers().contains(included)) return "programs must not know tests";
        return folder == "apps/bench" || folder == "apps/chart"
                   ? ""
                   : "of all programs, only the benchmark and the charts ask the oracle";
    }
    return folder.starts_with("tests") ? "" : "unknown folder " + folder;
}

/// The files that may name a library, as beginnings of their names.
struct Owner {
    std::string library, header;
    std::vector<std::string> files;
};

const std::vector<Owner>& owners() {
    static const std::vector<Owner> list = {
        {"tinygltf", "tiny_gltf.h", {"engine/scene/gltf"}},
        {"OpenImageIO", "OpenImageIO/", {"engine/scene/image.cpp", "engine/scene/decode_image.cpp"}},
        {"OpenSubdiv", "opensubdiv/", {"engine/deform/subdivide"}},
        {"Embree", "embree3/", {"apps/bench/embree_", "apps/bench/peer_embree"}},
        {"TBB", "tbb/", {"engine/math/parallel.cpp"}},
        {"Highway",
         "hwy/",
         {"engine/bvh/traverse", "engine/bvh/ploc_search", "engine/bvh/cluster_search", "engine/bvh/cluster_tree",
          "engine/bvh/wide_plan_range", "engine/deform/skin_kernels", "engine/deform/stencil_kernels",
          "engine/render/denoise_kernels"}},
        {"xxHash", "xxh", {"engine/bvh/hash.cpp"}},
        {"Valgrind", "valgrind/", {"apps/bench/timed_parallel.cpp"}},
        {"CLI11",
         "CLI/",
         {"apps/demo/options.cpp", "apps/bench/options.cpp", "apps/common/parse_command_line.cpp", "apps/chart/"}},
        {"GLFW", "GLFW/", {"apps/demo/"}},
        {"Dear ImGui", "imgui", {"apps/demo/", "tests/apps/interface.cpp"}},
        {"X11", "X11/", {"tests/apps/x_client.cpp"}},
    };
    return list;
}

TEST(Layering, EveryIncludePointsDown) {
    int count = 0;
    for (const Source& source : sources_under(kAllFolders)) {
        for (const Include& include : source.includes) {
            if (include.is_system) continue;
            ++count;
            const std::string broken = broken_layer(source.folder(), include.path);
            EXPECT_EQ(broken, "") << source.name << ":" << include.line << ": includes " << include.path;
        }
    }
    EXPECT_GT(count, 100);
}

TEST(Layering, TheCheckItselfCanFail) {
    EXPECT_NE(broken_layer("engine/math", "engine/bvh/bvh.h"), "");
    EXPECT_NE(broken_layer("engine/bvh", "engine/deform/skin.h"), "");
    EXPECT_NE(broken_layer("engine/bvh", "engine/scene/scene.h"), "");
    EXPECT_NE(broken_layer("engine/scene", "engine/frame/frame.h"), "");
    EXPECT_NE(broken_layer("engine/frame", "engine/render/path.h"), "");
    EXPECT_NE(broken_layer("engine/render", "content/content.h"), "");
    EXPECT_NE(broken_layer("content", "apps/common/parse.h"), "");
    EXPECT_NE(broken_layer("apps/demo", "tests/support/rays.h"), "");
    EXPECT_NE(broken_layer("apps/demo", "tests/support/brute_force.h"), "");
    EXPECT_NE(broken_layer("apps/common", "tests/support/world_triangle.h"), "");
    EXPECT_NE(broken_layer("apps/bench", "tests/support/compare.h"), "");
    EXPECT_NE(broken_layer("apps/bench", "tests/support/gltf_oracle.h"), "");
    EXPECT_NE(broken_layer("engine/frame", "tests/support/brute_force.h"), "");
    EXPECT_NE(broken_layer("content", "tests/support/brute_force.h"), "");
    EXPECT_EQ(broken_layer("engine/frame", "engine/bvh/bvh.h"), "");
    EXPECT_EQ(broken_layer("apps/bench", "tests/support/brute_force.h"), "");
    EXPECT_EQ(broken_layer("apps/bench", "tests/support/world_triangle.h"), "");
    EXPECT_EQ(broken_layer("apps/chart", "tests/support/brute_force.h"), "");
    EXPECT_NE(broken_layer("apps/chart", "tests/support/rays.h"), "");
}

/// Independent of what it judges, and nothing else of the tests comes along into the program that asks it.
TEST(Layering, TheOracleKnowsNeitherEngineNorTests) {
    size_t count = 0;
    for (const Source& source : sources_under({"tests/support"})) {
        const std::string header = fs::path(source.name).replace_extension(".h").generic_string();
        if (!oracle_headers().contains(header)) continue;
        ++count;
        for (const Include& include : source.includes) {
            const bool is_plain =
                include.is_system && !include.path.starts_with("gtest") && !include.path.starts_with("gmock");
            EXPECT_TRUE(is_plain || oracle_headers().contains(include.path))
                << source.name << ":" << include.line << ": includes " << include.path;
        }
    }
    EXPECT_EQ(count, 4u) << "three headers and a source";
}

TEST(Layering, IncludesAreGivenFromTheRootAndExist) {
    for (const Source& source : sources_under(kAllFolders)) {
        for (const Include& include : source.includes) {
            if (include.is_system) continue;
            EXPECT_TRUE(fs::exists(kRoot / include.path)) << source.name << ":" << include.line << ": " << include.path;
        }
    }
}

TEST(Layering, LibrariesStayInTheFilesThatOwnThem) {
    for (const Source& source : sources_under({"engine", "content", "apps"})) {
        for (const Include& include : source.includes) {
            for (const Owner& owner : owners()) {
                if (!include.path.starts_with(owner.header)) continue;
                const bool is_owner = std::any_of(owner.files.begin(), owner.files.end(),
                                                  [&](const std::string& file) { return source.name.starts_with(file); });
                EXPECT_TRUE(is_owner) << source.name << ":" << include.line << ": names " << owner.library;
            }
        }
    }
}

TEST(Layering, PublicHeadersNameNoLibraryButGlm) {
    std::map<std::string, Source> by_name;
    for (Source& source : sources_under({"engine"})) by_name.emplace(source.name, source);
    std::vector<std::string> open = {"engine/zoetrope.h", "engine/render/path.h", "engine/render/film.h",
                                     "engine/render/view.h"};
    std::set<std::string> seen(open.begin(), open.end());
    while (!open.empty()) {
        ASSERT_TRUE(by_name.contains(open.back())) << open.back();
        const Source source = by_name.at(open.back());
        open.pop_back();
        for (const Include& include : source.includes) {
            if (!include.is_system) {
                if (seen.insert(include.path).second) open.push_back(include.path);
                continue;
            }
            const bool is_standard = include.path.find_first_of("./") == std::string::npos;
            EXPECT_TRUE(is_standard || include.path.starts_with("glm/"))
                << source.name << ":" << include.line << ": " << include.path;
        }
    }
    EXPECT_GT(seen.size(), 15u);
}

/// A header is read in a minute, a source in five. Long ones are listed; much too long ones fail.
TEST(Layering, FilesHoldOneConceptEach) {
    std::ostringstream reported;
    for (const Source& source : sources_under(kAllFolders)) {
        // Tables are data, read by searching.
        const bool is_short_form = source.is_header() && !source.name.ends_with("_table.h");
        const size_t target = is_short_form ? 160 : 300, limit = is_short_form ? 200 : 400;
        if (source.lines.size() > target) reported << "  " << source.lines.size() << "  " << source.name << "\n";
        EXPECT_LE(source.lines.size(), limit) << source.name << " holds two concepts";
    }
    if (!reported.str().empty())
        std::printf("longer than 160 (headers) or 300 (sources) lines:\n%s", reported.str().c_str());
}

TEST(Layering, HeadersGuardThemselves) {
    for (const Source& source : sources_under(kAllFolders)) {
        if (!source.is_header()) continue;
        const auto& lines = source.lines;
        EXPECT_NE(std::find(lines.begin(), lines.end(), "#pragma once"), lines.end()) << source.name;
    }
}

TEST(Layering, NothingIsLeftForLater) {
    const std::vector<std::string> marks = {std::string("TO") + "DO", std::string("FIX") + "ME", std::string("#if ") + "0"};
    for (const Source& source : sources_under(kAllFolders)) {
        for (size_t k = 0; k < source.lines.size(); ++k) {
            for (const std::string& mark : marks) {
                EXPECT_EQ(source.lines[k].find(mark), std::string::npos) << source.name << ":" << k + 1 << ": " << mark;
            }
        }
    }
}

}  // namespace
}  // namespace zoe::test
