// The benchmark stops where it is told to, whatever it is at.

#include <array>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/apps/run_program.h"
#include "tests/apps/small_scene.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

using Json = nlohmann::json;

/// One triangle many times: every ray that meets it tests all of them.
void write_copies(const TempFolder& folder, size_t count) {
    const size_t index_bytes = 12 * count;
    std::string bytes = small_buffer().substr(0, 36);
    const std::array<uint32_t, 3> corners = {0, 1, 2};
    for (size_t k = 0; k < count; ++k) bytes.append(reinterpret_cast<const char*>(corners.data()), sizeof corners);
    const Json json = {{"asset", {{"version", "2.0"}}},
                       {"scene", 0},
                       {"scenes", {{{"nodes", {0}}}}},
                       {"nodes", {{{"mesh", 0}}}},
                       {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
                       {"buffers", {{{"uri", "copies.bin"}, {"byteLength", bytes.size()}}}},
                       {"bufferViews",
                        {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 36}},
                         {{"buffer", 0}, {"byteOffset", 36}, {"byteLength", index_bytes}}}},
                       {"accessors",
                        {{{"bufferView", 0},
                          {"componentType", 5126},
                          {"count", 3},
                          {"type", "VEC3"},
                          {"min", {-1e9, -1e9, -1e9}},
                          {"max", {1e9, 1e9, 1e9}}},
                         {{"bufferView", 1}, {"componentType", 5125}, {"count", 3 * count}, {"type", "SCALAR"}}}}};
    folder.write("copies.gltf", json.dump());
    folder.write("copies.bin", bytes);
}

TEST(Bench, TreesOverCopiesOfOneTriangleStopAtTheFirstSignal) {
    const TempFolder folder;
    write_copies(folder, 100'000);
    // What is left to do when the signal comes would take minutes.
    const Outcome outcome = run_program({"timeout", "--foreground", "--preserve-status", "--signal=TERM", "--kill-after=300",
                                         "3", ZOETROPE_BENCH, "copies.gltf", "--trees", "--size", "1024x1024"},
                                        folder.path());
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace zoe::test
