// The oracle's glTF reader and evaluator, against small files written here and values worked out by hand.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/support/gltf_oracle.h"
#include "tests/support/temp_folder.h"

namespace zoe::test {
namespace {

/// A buffer in the making.
struct Bytes {
    std::string bytes;
    template <typename T>
    Bytes& add(std::initializer_list<double> values) {
        for (const double value : values) {
            const T number = static_cast<T>(value);
            bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
        }
        return *this;
    }
    size_t size() const { return bytes.size(); }
};

/// A file in the making: `more` are the JSON members after asset, buffers and bufferViews (each view begins where the
/// last one ends).
struct File {
    Bytes data;
    std::vector<std::pair<size_t, int>> views;  ///< Where each begins, and its stride (0: none).
    std::string more;

    int view(const Bytes& bytes, int stride = 0) {
        views.push_back({data.size(), stride});
        data.bytes += bytes.bytes;
        return static_cast<int>(views.size()) - 1;
    }
    std::string json(const std::string& uri) const {
        std::string text = R"({"asset":{"version":"2.0"},"bufferViews":[)";
        for (size_t i = 0; i < views.size(); ++i) {
            const size_t end = i + 1 < views.size() ? views[i + 1].first : data.size();
            text += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", i == 0 ? "" : ",", views[i].first,
                                end - views[i].first,
                                views[i].second != 0 ? fmt::format(R"(,"byteStride":{})", views[i].second) : "");
        }
        const std::string buffer_uri = uri.empty() ? "" : fmt::format(R"("uri":"{}",)", uri);
        return text + fmt::format(R"(],"buffers":[{{{}"byteLength":{}}}],)", buffer_uri, data.size()) + more + "}";
    }
};

Document read(const File& file) {
    const TempFolder folder;
    folder.write("the data.bin", file.data.bytes);
    return read_document(folder.write("file.gltf", file.json("the%20data.bin")));
}

void expect_corners(const WorldTriangle& t, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const double error = glm::length(t.a - a) + glm::length(t.b - b) + glm::length(t.c - c);
    EXPECT_TRUE(error <= 1e-12) << fmt::format("({} {} {}) ({} {} {}) ({} {} {})", t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z,
                                               t.c.x, t.c.y, t.c.z);
}

const char* const kOneTriangleScene =
    R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)";

TEST(OracleGltf, ReadsStridedPositionsAndEveryIndexType) {
    for (const int type : {5121, 5123, 5125}) {
        File file;
        const int positions = file.view(Bytes().add<float>({0, 0, 0, 99, 1, 0, 0, 99, 0, 2, 0, 99}), 16);
        Bytes order;
        if (type == 5121) order.add<uint8_t>({2, 0, 1});
        if (type == 5123) order.add<uint16_t>({2, 0, 1});
        if (type == 5125) order.add<uint32_t>({2, 0, 1});
        const int indices = file.view(order);
        file.more = R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)";
        file.more += fmt::format(R"("accessors":[{{"bufferView":{},"componentType":5126,"count":3,"type":"VEC3"}},)"
                                 R"({{"bufferView":{},"componentType":{},"count":3,"type":"SCALAR"}}])",
                                 positions, indices, type);
        const auto triangles = world_triangles(read(file), 0.0);
        ASSERT_EQ(triangles.size(), 1u);
        expect_corners(triangles[0], {0, 2, 0}, {0, 0, 0}, {1, 0, 0});
    }
}

TEST(OracleGltf, ReadsNormalisedIntegers) {
    const auto corners = [](const Bytes& bytes, int type, bool is_normalised, int stride) {
        File file;
        file.view(bytes, stride);
        file.more = kOneTriangleScene;
        file.more +=
            fmt::format(R"("accessors":[{{"bufferView":0,"componentType":{},"normalized":{},"count":3,"type":"VEC3"}}])",
                        type, is_normalised);
        return world_triangles(read(file), 0.0).at(0);
    };
    expect_corners(corners(Bytes().add<int8_t>({127, -127, -128, 0, 0, 0, 0, 0, 127, 0, 0, 0}), 5120, true, 4), {1, -1, -1},
                   {0, 0, 0}, {1, 0, 0});
    expect_corners(corners(Bytes().add<uint8_t>({255, 51, 0, 0, 0, 0, 0, 0, 0, 0, 255, 0}), 5121, true, 4), {1, 0.2, 0},
                   {0, 0, 0}, {0, 0, 1});
    expect_corners(corners(Bytes().add<int16_t>({32767, -32768, 0, 0, 1, 2, 3, 0, 0, 0, 0, 0}), 5122, false, 8),
                   {32767, -32768, 0}, {1, 2, 3}, {0, 0, 0});
    expect_corners(corners(Bytes().add<uint16_t>({65535, 13107, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}), 5123, true, 8), {1, 0.2, 0},
                   {0, 0, 0}, {0, 0, 0});
}

TEST(OracleGltf, ReadsSparseAccessorsWithAndWithoutAView) {
    for (const std::string base : {"", R"("bufferView":0,)"}) {
        File file;
        file.view(Bytes().add<float>({5, 5, 5, 1, 0, 0, 0, 1, 0}));
        file.view(Bytes().add<uint8_t>({0, 2, 0, 0}));
        file.view(Bytes().add<float>({7, 8, 9, 1, 2, 3}));
        file.more = kOneTriangleScene;
        file.more += fmt::format(R"("accessors":[{{{}"componentType":5126,"count":3,"type":"VEC3","sparse":{{"count":2,)"
                                 R"("indices":{{"bufferView":1,"componentType":5121}},"values":{{"bufferView":2}}}}}}])",
                                 base);
        expect_corners(world_triangles(read(file), 0.0).at(0), {7, 8, 9}, base.empty() ? glm::dvec3(0) : glm::dvec3(1, 0, 0),
                       {1, 2, 3});
    }
}

/// Five vertices at (i, i * i, 0), shown by one primitive a mode.
File modes(const std::vector<int>& list) {
    File file;
    file.view(Bytes().add<float>({0, 0, 0, 1, 1, 0, 2, 4, 0, 3, 9, 0, 4, 16, 0}));
    file.more = R"("nodes":[{"mesh":0}],"accessors":[{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"}],)";
    file.more += R"("meshes":[{"primitives":[)";
    for (size_t i = 0; i < list.size(); ++i) {
        file.more += fmt::format(R"({}{{"attributes":{{"POSITION":0}},"mode":{}}})", i == 0 ? "" : ",", list[i]);
    }
    file.more += "]}]";
    return file;
}

TEST(OracleGltf, ExpandsStripsAndFansAndCountsAcrossPrimitives) {
    const auto triangles = world_triangles(read(modes({0, 5, 1, 6, 4, 3})), 0.0);
    const auto corner = [](double i) { return glm::dvec3(i, i * i, 0); };
    ASSERT_EQ(triangles.size(), 7u);
    for (uint32_t i = 0; i < 7; ++i) EXPECT_EQ(triangles[i].primitive, i);
    expect_corners(triangles[0], corner(0), corner(1), corner(2));
    expect_corners(triangles[1], corner(1), corner(3), corner(2));
    expect_corners(triangles[2], corner(2), corner(3), corner(4));
    expect_corners(triangles[3], corner(1), corner(2), corner(0));
    expect_corners(triangles[5], corner(3), corner(4), corner(0));
    expect_corners(triangles[6], corner(0), corner(1), corner(2));
}

/// A triangle (0,0,0), (1,0,0), (0,1,0), plus whatever nodes.
File triangle_file(const std::string& nodes) {
    File file;
    file.view(Bytes().add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
    file.more = R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)";
    file.more += R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)" + nodes;
    return file;
}

TEST(OracleGltf, ComposesNodesOfTheDefaultSceneOnly) {
    // Node 2 (a matrix: scaled by 2, moved by z = 1) hangs below node 0, which stands after it in no order that matters.
    const auto triangles = world_triangles(read(triangle_file(R"("scene":1,"scenes":[{"nodes":[1]},{"nodes":[3]}],"nodes":[
        {"mesh":0},{"mesh":0},{"mesh":0,"matrix":[2,0,0,0,0,2,0,0,0,0,2,0,0,0,1,1]},
        {"children":[2],"translation":[10,0,0],"scale":[1,-3,1]}])")),
                                           0.0);
    ASSERT_EQ(triangles.size(), 1u);
    EXPECT_EQ(triangles[0].node, 2u);
    expect_corners(triangles[0], {10, 0, 1}, {12, 0, 1}, {10, -6, 1});
    // 10 to the parent, 1 stretched by 3 to the node, then 1 stretched by 3 and by the matrix's norm.
    EXPECT_NEAR(triangles[0].magnitude, 10 + 3 + 3 * std::sqrt(12.0), 1e-12);
}

TEST(OracleGltf, NumbersInstancesAfterAllNodes) {
    File file = triangle_file("");
    file.view(Bytes().add<float>({1, 0, 0, 2, 0, 0}));
    file.view(Bytes().add<int8_t>({0, 0, 127, 0, 0, 0, 0, 127}));
    file.more.pop_back();
    file.more.insert(file.more.find("]"),
                     R"(,{"bufferView":1,"componentType":5126,"count":2,"type":"VEC3"})"
                     R"(,{"bufferView":2,"componentType":5120,"normalized":true,"count":2,"type":"VEC4"})");
    file.more += R"(,"nodes":[{"mesh":0,"scale":[10,10,10],"extensions":{"EXT_mesh_gpu_instancing":)"
                 R"({"attributes":{"TRANSLATION":1,"ROTATION":2}}}},{"mesh":0}])";
    const auto triangles = world_triangles(read(file), 0.0);
    ASSERT_EQ(triangles.size(), 3u);
    EXPECT_EQ(triangles[0].node, 2u);
    expect_corners(triangles[0], {10, 0, 0}, {0, 0, 0}, {10, -10, 0});  // Half a turn about z.
    EXPECT_EQ(triangles[1].node, 3u);
    expect_corners(triangles[1], {20, 0, 0}, {30, 0, 0}, {20, 10, 0});
    EXPECT_EQ(triangles[2].node, 1u);
}

TEST(OracleGltf, BlendsMorphTargetsThenJoints) {
    File file;
    file.view(Bytes().add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}));
    file.view(Bytes().add<float>({0, 0, 4, 0, 0, 4, 0, 0, 4}));                     // Target: z + 4.
    file.view(Bytes().add<uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}));          // Joints.
    file.view(Bytes().add<float>({1, 1, 0, 0, 0.5, 0, 0, 0, 0, 0, 0, 0}));          // Weights: sums 2, 0.5, 0.
    file.view(Bytes().add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 1,  // Inverse bind: z - 1; identity.
                                  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0,  1}));
    file.view(Bytes().add<float>({0, 2}));  // Key times.
    file.view(Bytes().add<float>({0, 1}));  // Weights.
    file.more = R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
        {"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"},
        {"bufferView":2,"componentType":5121,"count":3,"type":"VEC4"},
        {"bufferView":3,"componentType":5126,"count":3,"type":"VEC4"},
        {"bufferView":4,"componentType":5126,"count":2,"type":"MAT4"},
        {"bufferView":5,"componentType":5126,"count":2,"type":"SCALAR"},
        {"bufferView":6,"componentType":5126,"count":2,"type":"SCALAR"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":3},"targets":[{"POSITION":1}]}],
                   "weights":[9]}],
        "skins":[{"joints":[1,2],"inverseBindMatrices":4}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":5,"output":6}]}],
        "nodes":[{"mesh":0,"skin":0,"translation":[1000,0,0]},{"translation":[10,0,0]},{"scale":[2,2,2]}])";
    const Document document = read(file);
    // At 1 s the weight is 0.5, which lifts all by 2. Joint 0 maps p to p + (10, 0, -1), joint 1 to 2 p. The first vertex
    // has half of each, the second joint 0 only, the third no weights, which means the first joint.
    expect_corners(world_triangles(document, 1.0).at(0), {5, 0, 2.5}, {11, 0, 1}, {10, 1, 1});
    // The clip loops after 2 s; without it the mesh's own weight holds.
    expect_corners(world_triangles(document, 3.0).at(0), {5, 0, 2.5}, {11, 0, 1}, {10, 1, 1});
    expect_corners(world_triangles(document, 3.0, {.is_looping = false}).at(0), {5, 0, 5.5}, {11, 0, 3}, {10, 1, 3});
    expect_corners(world_triangles(document, 0.0, {.clips = {}}).at(0), {5, 0, 53.5}, {11, 0, 35}, {10, 1, 35});
}

TEST(OracleGltf, ReadsBinaryFilesAndDataUris) {
    File file = triangle_file(R"("nodes":[{"mesh":0}])");
    const TempFolder folder;
    // 36 bytes are 48 characters without padding: six zeroes are "AAAAAAAA", 1.0f is 00 00 80 3f.
    const std::string data = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    const auto from_text = world_triangles(read_document(folder.write("data.gltf", file.json(data))), 0.0);
    expect_corners(from_text.at(0), {0, 0, 0}, {1, 0, 0}, {0, 1, 0});

    std::string json = file.json("");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    Bytes glb;
    const double json_size = static_cast<double>(json.size()), size = static_cast<double>(file.data.size());
    glb.add<uint32_t>({0x46546c67, 2, 12 + 8 + json_size + 8 + size, json_size, 0x4e4f534a});
    glb.bytes += json;
    glb.add<uint32_t>({size, 0x004e4942});
    glb.bytes += file.data.bytes;
    const auto from_binary = world_triangles(read_document(folder.write("file.glb", glb.bytes)), 0.0);
    expect_corners(from_binary.at(0), {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
}

TEST(OracleGltf, LaterClipsWin) {
    File file = triangle_file(R"("nodes":[{"mesh":0}])");
    Document document = read(file);
    const DocumentChannel up{0, "translation", "LINEAR", 3, {0.0, 1.0}, {0, 0, 0, 0, 0, 1}};
    const DocumentChannel aside{0, "translation", "STEP", 3, {0.0, 4.0}, {5, 0, 0, 6, 0, 0}};
    document.clips = {{"up", {up}, 1.0}, {"aside", {aside}, 4.0}};
    expect_corners(world_triangles(document, 1.5).at(0), {0, 0, 0.5}, {1, 0, 0.5}, {0, 1, 0.5});
    expect_corners(world_triangles(document, 1.5, {.clips = {0, 1}}).at(0), {5, 0, 0}, {6, 0, 0}, {5, 1, 0});
    expect_corners(world_triangles(document, 1.5, {.clips = {1, 0}}).at(0), {0, 0, 0.5}, {1, 0, 0.5}, {0, 1, 0.5});
}

}  // namespace
}  // namespace zoe::test
