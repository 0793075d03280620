#include <cmath>

#include <gtest/gtest.h>

#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

/// Loads one triangle whose positions are the accessor, and returns them.
std::vector<glm::vec3> positions_of(GlbBuilder& glb, int accessor) {
    glb.push("nodes", {{"mesh", glb.mesh({{"attributes", {{"POSITION", accessor}}}})}});
    return glb.load().meshes[0].positions;
}

TEST(Accessor, FloatsComeAsTheyAre) {
    GlbBuilder glb;
    const auto p = positions_of(glb, glb.floats({0, 1, 2, 3, 4, 5, 6, 7, 8}, "VEC3"));
    ASSERT_EQ(p.size(), 3u);
    EXPECT_EQ(p[1], glm::vec3(3, 4, 5));
}

template <typename T>
void expect_quantized(int type, const std::vector<T>& values, bool is_normalized, const std::vector<float>& expected) {
    GlbBuilder glb;
    glb.json["extensionsUsed"] = glb.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    std::vector<T> padded;  // Elements of 3 bytes or shorts begin at multiples of 4 bytes.
    const size_t stride = (3 * sizeof(T) + 3) / 4 * 4;
    for (size_t i = 0; i < 3; ++i) {
        padded.insert(padded.end(), values.begin() + static_cast<ptrdiff_t>(3 * i),
                      values.begin() + static_cast<ptrdiff_t>(3 * i + 3));
        padded.resize((i + 1) * stride / sizeof(T));
    }
    const int view = glb.view(padded.data(), padded.size() * sizeof(T), static_cast<int>(stride));
    const auto p = positions_of(glb, glb.accessor_of(view, type, "VEC3", 3, is_normalized));
    ASSERT_EQ(p.size(), 3u);
    for (size_t i = 0; i < 9; ++i) EXPECT_FLOAT_EQ(p[i / 3][static_cast<int>(i % 3)], expected[i]) << i;
}

TEST(Accessor, QuantizedComponentsAreConverted) {
    expect_quantized<int8_t>(kByte, {-128, -127, 0, 1, 127, 64, 0, 0, 5}, false, {-128, -127, 0, 1, 127, 64, 0, 0, 5});
    expect_quantized<int16_t>(kShort, {-32768, 32767, 0, 1, 2, 3, 0, 0, 5}, false, {-32768, 32767, 0, 1, 2, 3, 0, 0, 5});
    expect_quantized<uint16_t>(kUshort, {65535, 0, 1, 2, 3, 4, 5, 6, 7}, false, {65535, 0, 1, 2, 3, 4, 5, 6, 7});
}

TEST(Accessor, NormalizedComponentsMapToUnitRange) {
    expect_quantized<int8_t>(kByte, {-128, -127, 127, 0, 1, 2, 3, 4, 5}, true,
                             {-1, -1, 1, 0, 1 / 127.f, 2 / 127.f, 3 / 127.f, 4 / 127.f, 5 / 127.f});
    expect_quantized<uint8_t>(kUbyte, {255, 0, 51, 0, 0, 0, 1, 1, 1}, true,
                              {1, 0, 0.2f, 0, 0, 0, 1 / 255.f, 1 / 255.f, 1 / 255.f});
    expect_quantized<int16_t>(kShort, {-32768, -32767, 32767, 0, 0, 0, 1, 1, 1}, true,
                              {-1, -1, 1, 0, 0, 0, 1 / 32767.f, 1 / 32767.f, 1 / 32767.f});
    expect_quantized<uint16_t>(kUshort, {65535, 0, 13107, 0, 0, 0, 0, 0, 0}, true, {1, 0, 0.2f, 0, 0, 0, 0, 0, 0});
}

TEST(Accessor, InterleavedAttributesFollowStrideAndOffset) {
    GlbBuilder glb;
    const std::vector<float> data{0, 0, 0, 9, 8, 1, 0, 0, 7, 6, 0, 1, 0, 5, 4};
    const int view = glb.view(data.data(), data.size() * 4, 20);
    const int positions = glb.accessor_of(view, kFloat, "VEC3", 3);
    const int uvs = glb.accessor_of(view, kFloat, "VEC2", 3);
    glb.json["accessors"][static_cast<size_t>(uvs)]["byteOffset"] = 12;
    glb.push("nodes", {{"mesh", glb.mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}})}});
    const Scene scene = glb.load();
    EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(1, 0, 0));
    EXPECT_EQ(scene.meshes[0].uvs[0][2], glm::vec2(5, 4));
}

GlbBuilder sparse_glb(int base_view, const std::vector<uint8_t>& indices) {
    GlbBuilder glb;
    const std::vector<float> base{1, 1, 1, 2, 2, 2, 3, 3, 3}, values{7, 8, 9};
    if (base_view >= 0) base_view = glb.view(base.data(), base.size() * 4);
    const int accessor = glb.accessor_of(base_view, kFloat, "VEC3", 3);
    glb.json["accessors"][static_cast<size_t>(accessor)]["sparse"] = {
        {"count", indices.size()},
        {"indices", {{"bufferView", glb.view(indices.data(), indices.size())}, {"componentType", kUbyte}}},
        {"values", {{"bufferView", glb.view(values.data(), 12)}}}};
    glb.push("nodes", {{"mesh", glb.mesh({{"attributes", {{"POSITION", accessor}}}})}});
    return glb;
}

TEST(Accessor, SparseValuesReplaceTheBase) {
    const Scene scene = sparse_glb(0, {1}).load();
    EXPECT_EQ(scene.meshes[0].positions[0], glm::vec3(1));
    EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(7, 8, 9));
}

TEST(Accessor, SparseWithoutAViewStandsOnZeros) {
    const Scene scene = sparse_glb(-1, {2}).load();
    EXPECT_EQ(scene.meshes[0].positions[0], glm::vec3(0));
    EXPECT_EQ(scene.meshes[0].positions[2], glm::vec3(7, 8, 9));
}

TEST(Accessor, SparseIndicesMustBeInRangeAndAscend) {
    EXPECT_NE(sparse_glb(0, {3}).error().find("/accessors/0/sparse/indices: entry 0 is 3"), std::string::npos);
    EXPECT_NE(sparse_glb(0, {1, 1}).error().find("/accessors/0/sparse"), std::string::npos);
}

TEST(Accessor, IndicesMayBeSparseWithoutAView) {
    GlbBuilder glb;
    const int positions = glb.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    const int indices = glb.accessor_of(-1, kUshort, "SCALAR", 3);
    const std::vector<uint8_t> where{1, 2};
    const std::vector<uint16_t> values{1, 2};
    glb.json["accessors"][static_cast<size_t>(indices)]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", glb.view(where.data(), 2)}, {"componentType", kUbyte}}},
        {"values", {{"bufferView", glb.view(values.data(), 4)}}}};
    glb.push("nodes", {{"mesh", glb.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
    EXPECT_EQ(glb.load().meshes[0].corners.at(0), glm::uvec3(0, 1, 2));
}

TEST(Accessor, CountsThatNoBytesBackAreRefused) {
    GlbBuilder with_view;
    with_view.triangle();
    with_view.json["accessors"][0]["count"] = 2147483647;
    EXPECT_NE(with_view.error().find("far more data than the file holds bytes"), std::string::npos);
    GlbBuilder without_view;
    without_view.triangle();
    without_view.json["accessors"][0]["count"] = 2147483647;
    without_view.json["accessors"][0].erase("bufferView");
    EXPECT_NE(without_view.error(), "");
}

TEST(Accessor, UnknownComponentTypesAndNarrowStridesAreRefused) {
    GlbBuilder type;
    type.triangle();
    type.json["accessors"][0]["componentType"] = 5124;
    EXPECT_NE(type.error().find("/accessors/0/componentType: 5124"), std::string::npos);
    GlbBuilder stride;
    stride.triangle();
    stride.json["bufferViews"][0]["byteStride"] = 8;
    EXPECT_NE(stride.error().find("/bufferViews/0/byteStride: 8"), std::string::npos);
}

TEST(Accessor, OffsetsThatWouldOverflowAreRefused) {
    for (const char* member : {"byteOffset", "byteLength"}) {
        for (const double value : {1e12, 1.8446744073709552e19, 1e300}) {
            GlbBuilder glb;
            glb.triangle();
            glb.json["bufferViews"][0][member] = value;
            EXPECT_NE(glb.error().find("/bufferViews/0"), std::string::npos) << member << " " << value;
        }
    }
}

}  // namespace
}  // namespace zoe::test
