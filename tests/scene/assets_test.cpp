#include <map>

#include <gtest/gtest.h>

#include "tests/scene/glb_builder.h"
#include "tests/support/assets.h"

namespace zoe::test {
namespace {

/// Folders of files that are as the specification wants them.
bool is_valid_by_folder(const std::string& file) {
    return file.find("invalid/") == std::string::npos && file.find("asset-generator/") == std::string::npos;
}

TEST(Assets, EveryFileLoadsSoundOrIsRefusedWithItsReason) {
    const auto folder = assets_folder(ZOETROPE_SOURCE_DIR);
    if (!folder) GTEST_SKIP() << kNoAssets;
    const std::map<std::string, std::string> refused = {{"edge/Box-Draco/Box.gltf", "KHR_draco_mesh_compression"},
                                                        {"edge/BoxMeshopt.glb", "EXT_meshopt_compression"}};
    int loaded = 0;
    for (const std::string& file : gltf_files(*folder)) {
        SCOPED_TRACE(file);
        try {
            const Scene scene = load_gltf(*folder / file);
            EXPECT_EQ(check(scene), "");
            EXPECT_FALSE(refused.contains(file));
            ++loaded;
        } catch (const SceneError& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.find((*folder / file).string() + ": "), 0u) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            if (!is_valid_by_folder(file)) continue;
            ASSERT_TRUE(refused.contains(file)) << message;
            EXPECT_NE(message.find(refused.at(file)), std::string::npos) << message;
        }
    }
    EXPECT_GE(loaded, 190);
}

}  // namespace
}  // namespace zoe::test
