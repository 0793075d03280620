#include <gtest/gtest.h>

#include "tests/scene/glb_builder.h"

namespace zoe::test {
namespace {

TEST(NodeReader, TrsAndMatrixAreRead) {
    GlbBuilder glb;
    glb.push("nodes", {{"translation", {1, 2, 3}}, {"rotation", {0, 0, 1, 0}}, {"scale", {2, 2, 2}}, {"children", {1}}});
    glb.push("nodes", {{"matrix", {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 4, 5, 6, 1}}});
    const Scene scene = glb.load();
    EXPECT_EQ(scene.nodes[0].local.translation, glm::vec3(1, 2, 3));
    EXPECT_EQ(scene.nodes[0].local.rotation.z, 1.0f);
    EXPECT_EQ(scene.nodes[1].parent, NodeId{0});
    ASSERT_TRUE(scene.nodes[1].matrix);
    EXPECT_EQ(scene.nodes[1].matrix->linear[2][2], 3.0f);
    EXPECT_EQ(scene.nodes[1].matrix->translation, glm::vec3(4, 5, 6));
}

TEST(NodeReader, AnimatedMatricesAreDecomposed) {
    GlbBuilder glb;
    glb.push("nodes", {{"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 4, 5, 6, 1}}});
    const int times = glb.floats({0, 1}, "SCALAR"), values = glb.floats({0, 0, 0, 1, 1, 1}, "VEC3");
    glb.push("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
    const Scene scene = glb.load();
    EXPECT_FALSE(scene.nodes[0].matrix);
    EXPECT_NEAR(scene.nodes[0].local.scale.x, 2.0f, 1e-6f);
    EXPECT_EQ(scene.nodes[0].local.translation, glm::vec3(4, 5, 6));
    EXPECT_EQ(scene.warnings().size(), 1u);
}

TEST(NodeReader, CyclesAndSecondParentsAreRefused) {
    GlbBuilder cycle;
    cycle.json["nodes"] = {{{"children", {1}}}, {{"children", {0}}}};
    EXPECT_NE(cycle.error().find("/nodes/0: it is its own ancestor"), std::string::npos);
    GlbBuilder self;
    self.json["nodes"] = {{{"children", {0}}}};
    EXPECT_NE(self.error().find("/nodes/0: it is its own ancestor"), std::string::npos);
    GlbBuilder second;
    second.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, nlohmann::json::object()};
    EXPECT_NE(second.error().find("/nodes/1/children/0"), std::string::npos);
}

TEST(NodeReader, AHundredThousandNodesDeepLoads) {
    constexpr uint32_t kDepth = 100000;
    GlbBuilder glb;
    for (uint32_t i = 0; i + 1 < kDepth; ++i) glb.push("nodes", {{"children", {i + 1}}});
    glb.push("nodes", nlohmann::json::object());
    glb.push("scenes", {{"nodes", {0}}});
    const Scene scene = glb.load();
    EXPECT_EQ(scene.parents_first().back(), NodeId{kDepth - 1});
    EXPECT_TRUE(scene.nodes.back().is_shown);
}

TEST(NodeReader, OnlyTheChosenSceneIsShown) {
    GlbBuilder glb;
    glb.json["nodes"] = {{{"children", {1}}}, nlohmann::json::object(), nlohmann::json::object()};
    glb.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {2}}}};
    const auto shown = [](const Scene& scene) {
        return std::vector<bool>{scene.nodes[0].is_shown, scene.nodes[1].is_shown, scene.nodes[2].is_shown};
    };
    EXPECT_EQ(shown(glb.load()), (std::vector<bool>{true, true, false}));
    EXPECT_EQ(shown(glb.load({.scene = 1})), (std::vector<bool>{false, false, true}));
    glb.json["scene"] = 1;
    EXPECT_EQ(shown(glb.load()), (std::vector<bool>{false, false, true}));
    EXPECT_THROW(glb.load({.scene = 2}), SceneError);
    EXPECT_THROW(glb.load({.scene = -1}), SceneError);
    glb.json.erase("scenes");
    glb.json.erase("scene");
    EXPECT_EQ(shown(glb.load()), (std::vector<bool>{true, true, true}));
}

TEST(NodeReader, ExtrasAskForMotionAndMeshSequences) {
    GlbBuilder glb;
    glb.triangle();
    glb.triangle();
    glb.json["nodes"][0]["extras"] = {{"motion", "deforming"}, {"anything", {1, 2}}};
    glb.json["nodes"][1]["extras"] = {{"motion", "sideways"}, {"mesh_sequence", {{"meshes", {1, 0}}, {"fps", 12}}}};
    const Scene scene = glb.load();
    EXPECT_EQ(scene.nodes[0].motion, Motion::kDeforming);
    EXPECT_EQ(scene.nodes[1].motion, std::nullopt);
    EXPECT_EQ(scene.warnings().size(), 1u);
    ASSERT_TRUE(scene.nodes[1].sequence);
    EXPECT_EQ(scene.nodes[1].sequence->meshes, (std::vector<MeshId>{MeshId{1}, MeshId{0}}));
    EXPECT_EQ(scene.nodes[1].sequence->fps, 12.0);
    glb.json["nodes"][1]["extras"]["mesh_sequence"]["meshes"] = {2};
    EXPECT_NE(glb.error().find("/nodes/1/extras/mesh_sequence/meshes/0"), std::string::npos);
}

TEST(NodeReader, SkinsAndWeightsOfMeshSequencesAreCounted) {
    GlbBuilder glb = make_rich_glb();
    glb.json["nodes"][0]["extras"]["mesh_sequence"]["meshes"] = {0};
    const std::string skin = "a node with extras.mesh_sequence and a skin: the skin is ignored";
    const std::string weights = "a node with extras.mesh_sequence and morph weights: the weights are ignored";
    EXPECT_EQ(glb.load().warnings().count(skin), 1u);
    EXPECT_EQ(glb.load().warnings().count(weights), 0u);
    glb.json["nodes"][0]["weights"] = {0.5};
    EXPECT_EQ(glb.load().warnings().count(weights), 1u);
}

TEST(NodeReader, InstancesBecomeChildrenThatShowTheMesh) {
    GlbBuilder glb;
    glb.triangle();
    glb.push("nodes", {{"name", "last"}});
    const int translations = glb.floats({1, 0, 0, 2, 0, 0}, "VEC3");
    const int rotations = glb.accessor(std::vector<int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0}, kShort, "VEC4", 2, true);
    glb.json["nodes"][0]["name"] = "tree";
    glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", translations},
                                                                                   {"ROTATION", rotations}};
    glb.json["extensionsUsed"] = glb.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const Scene scene = glb.load();
    ASSERT_EQ(scene.nodes.size(), 4u);
    EXPECT_EQ(scene.nodes[0].mesh, kNone<MeshId>);
    EXPECT_EQ(scene.nodes[1].name, "last");
    EXPECT_EQ(scene.nodes[2].name, "tree[0]");
    EXPECT_EQ(scene.nodes[3].parent, NodeId{0});
    EXPECT_EQ(scene.nodes[3].mesh, MeshId{0});
    EXPECT_EQ(scene.nodes[3].local.translation, glm::vec3(2, 0, 0));
    EXPECT_NEAR(scene.nodes[3].local.rotation.z, 1.0f, 1e-6f);

    glb.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = glb.floats({1, 1, 1}, "VEC3");
    EXPECT_NE(glb.error().find("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes"), std::string::npos);
}

TEST(NodeReader, CamerasWithoutTheirDescriptionAreNamed) {
    GlbBuilder glb = make_rich_glb();
    glb.push("cameras", {{"type", "orthographic"}});
    EXPECT_NE(glb.error().find("/cameras/1: 'orthographic' is missing"), std::string::npos);
    glb.json["cameras"][0].erase("perspective");
    EXPECT_NE(glb.error().find("/cameras/0: 'perspective' is missing"), std::string::npos);
}

TEST(NodeReader, CamerasAndLightsAreRead) {
    GlbBuilder glb = make_rich_glb();
    glb.push("cameras", {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 1}, {"znear", 0}, {"zfar", 9}}}});
    glb.json["extensions"]["KHR_lights_punctual"]["lights"].push_back(
        {{"type", "spot"}, {"color", {1, 0.5, 0}}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}});
    const Scene scene = glb.load();
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_FLOAT_EQ(scene.cameras[0].yfov, 0.8f);
    EXPECT_FALSE(scene.cameras[1].is_perspective);
    EXPECT_EQ(scene.cameras[1].xmag, 2.0f);
    EXPECT_EQ(scene.nodes[1].light, LightId{0});
    EXPECT_EQ(scene.lights[0].intensity, 40.0f);
    EXPECT_EQ(scene.lights[1].kind, LightKind::kSpot);
    EXPECT_FLOAT_EQ(scene.lights[1].outer_cone, 0.2f);
}

TEST(NodeReader, CamerasSayHowLongTheirShutterIsOpen) {
    const auto load = [](const nlohmann::json& extras) {
        GlbBuilder glb;
        glb.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}, {"extras", extras}});
        return glb.load();
    };
    EXPECT_EQ(load({{"shutter", 0.25}}).cameras[0].shutter, 0.25f);
    EXPECT_EQ(load({{"shutter", 1}}).cameras[0].shutter, 1.0f);
    EXPECT_EQ(load({{"shutters", 1}}).warnings().size(), 0u);
    const nlohmann::json broken[] = {-0.1, 1.5, 1e300, "half", nlohmann::json::array({0.5})};
    for (const nlohmann::json& word : broken) {
        const Scene scene = load({{"shutter", word}});
        EXPECT_EQ(scene.cameras[0].shutter, 0.0f) << word;
        EXPECT_EQ(scene.warnings().size(), 1u) << word;
    }
}

TEST(MaterialReader, FactorsExtensionsAndTransformsAreRead) {
    GlbBuilder glb;
    glb.triangle();
    glb.push("images", {{"uri", "missing.png"}});
    glb.push("samplers", {{"magFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33648}});
    glb.push("textures", {{"source", 0}, {"sampler", 0}});
    const nlohmann::json transform = {
        {"offset", {0.25, 0.5}}, {"rotation", 1.5707963267948966}, {"scale", {2, 3}}, {"texCoord", 1}};
    glb.push("materials", {{"pbrMetallicRoughness",
                            {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                             {"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}},
                           {"emissiveFactor", {1, 0.5, 0}},
                           {"alphaMode", "MASK"},
                           {"extensions",
                            {{"KHR_materials_emissive_strength", {{"emissiveStrength", 10}}},
                             {"KHR_materials_unlit", nlohmann::json::object()}}}});
    const Scene scene = glb.load();
    const Material& material = scene.materials[0];
    EXPECT_FLOAT_EQ(material.base_color.w, 0.4f);
    EXPECT_EQ(material.emission, glm::vec3(10, 5, 0));
    EXPECT_TRUE(material.is_unlit);
    EXPECT_EQ(material.alpha_mode, AlphaMode::kMask);
    const TextureRef& texture = material.base_color_texture;
    EXPECT_EQ(texture.wrap_s, Wrap::kClamp);
    EXPECT_EQ(texture.wrap_t, Wrap::kMirror);
    EXPECT_TRUE(texture.is_nearest);
    EXPECT_EQ(texture.uv_set, 1);
    // Scaled to (2, 0), turned a quarter against the clock with v downwards to (0, -2), moved.
    const glm::vec3 uv = texture.image_from_uv * glm::vec3(1, 0, 1);
    EXPECT_NEAR(uv.x, 0.25f, 1e-6f);
    EXPECT_NEAR(uv.y, -1.5f, 1e-6f);
    EXPECT_EQ(scene.warnings().size(), 1u) << "the missing image";
    EXPECT_TRUE(scene.images[0].pixels.empty());
}

TEST(MaterialReader, APictureThatCannotBeDecodedIsAWarningAndWhite) {
    for (const std::string& bytes :
         {std::string("no picture"), std::string("\x89PNG\r\n\x1a\n and then nothing"), std::string()}) {
        GlbBuilder glb;
        glb.triangle();
        if (bytes.empty()) {
            glb.push("images", {{"uri", "data:image/png;base64,"}});
        } else {
            const int view = glb.view(bytes.data(), bytes.size());
            glb.push("images", {{"bufferView", view}, {"mimeType", "image/png"}});
        }
        glb.push("textures", {{"source", 0}});
        glb.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
        const Scene scene = glb.load();
        EXPECT_EQ(scene.warnings().size(), 1u) << bytes;
        ASSERT_EQ(scene.images.size(), 1u);
        EXPECT_TRUE(scene.images[0].pixels.empty()) << "as if there were none";
    }
}

/// A file with one image, texture and material.
Material read_material(const nlohmann::json& material) {
    GlbBuilder glb;
    glb.push("images", {{"uri", "missing.png"}});
    glb.push("textures", {{"source", 0}});
    glb.push("materials", material);
    return glb.load().materials[0];
}

TEST(MaterialReader, TheDefaultIsTheSpecifications) {
    const Material material = read_material(nlohmann::json::object());
    EXPECT_EQ(material, Material{});
    EXPECT_EQ(material.metallic, 1.0f);
    EXPECT_EQ(material.roughness, 1.0f);
    EXPECT_EQ(material.ior, 1.5f);
}

TEST(MaterialReader, EveryMemberOfEveryExtensionIsRead) {
    const nlohmann::json texture = {{"index", 0}, {"texCoord", 1}};
    const nlohmann::json moved = {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}};
    const nlohmann::json normal = {{"index", 0}, {"scale", 0.25}};
    const Material material =
        read_material({{"pbrMetallicRoughness",
                        {{"metallicFactor", 0.5}, {"roughnessFactor", 0.25}, {"metallicRoughnessTexture", texture}}},
                       {"normalTexture", normal},
                       {"extensions",
                        {{"KHR_materials_ior", {{"ior", 1.33}}},
                         {"KHR_materials_specular",
                          {{"specularFactor", 0.75},
                           {"specularTexture", texture},
                           {"specularColorFactor", {1, 2, 0.5}},
                           {"specularColorTexture", moved}}},
                         {"KHR_materials_transmission", {{"transmissionFactor", 0.5}, {"transmissionTexture", texture}}},
                         {"KHR_materials_volume",
                          {{"thicknessFactor", 2}, {"attenuationDistance", 3}, {"attenuationColor", {0.1, 0.2, 0.3}}}},
                         {"KHR_materials_clearcoat",
                          {{"clearcoatFactor", 0.9},
                           {"clearcoatTexture", texture},
                           {"clearcoatRoughnessFactor", 0.1},
                           {"clearcoatRoughnessTexture", moved},
                           {"clearcoatNormalTexture", normal}}},
                         {"KHR_materials_sheen",
                          {{"sheenColorFactor", {0.3, 0.2, 0.1}},
                           {"sheenColorTexture", texture},
                           {"sheenRoughnessFactor", 0.6},
                           {"sheenRoughnessTexture", texture}}}}}});
    EXPECT_EQ(material.metallic, 0.5f);
    EXPECT_EQ(material.roughness, 0.25f);
    EXPECT_EQ(material.normal_scale, 0.25f);
    EXPECT_EQ(material.ior, 1.33f);
    EXPECT_EQ(material.specular, 0.75f);
    EXPECT_EQ(material.specular_color, glm::vec3(1, 2, 0.5f));
    EXPECT_EQ(material.transmission, 0.5f);
    EXPECT_EQ(material.thickness, 2.0f);
    EXPECT_EQ(material.attenuation_distance, 3.0f);
    EXPECT_EQ(material.attenuation_color, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(material.coat, 0.9f);
    EXPECT_EQ(material.coat_roughness, 0.1f);
    EXPECT_EQ(material.coat_normal_scale, 0.25f);
    EXPECT_EQ(material.sheen_color, glm::vec3(0.3f, 0.2f, 0.1f));
    EXPECT_EQ(material.sheen_roughness, 0.6f);
    for (const TextureRef* ref :
         {&material.metallic_roughness_texture, &material.specular_texture, &material.transmission_texture,
          &material.coat_texture, &material.sheen_color_texture, &material.sheen_roughness_texture}) {
        EXPECT_EQ(ref->image, ImageId{0});
        EXPECT_EQ(ref->uv_set, 1);
    }
    EXPECT_EQ(material.specular_color_texture.image_from_uv[2].x, 0.5f);
    EXPECT_EQ(material.coat_roughness_texture.image_from_uv[2].x, 0.5f);
    int unread = 0;
    for (const TextureRef* ref : textures_of(material)) unread += ref->image == kNone<ImageId> ? 1 : 0;
    EXPECT_EQ(unread, 2) << "base colour and emission have none";
}

TEST(MaterialReader, FactorsOutOfRangeAreClampedAndToldOf) {
    GlbBuilder glb;
    glb.push("materials",
             {{"pbrMetallicRoughness", {{"roughnessFactor", 7}}}, {"extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}}}});
    glb.push("materials", {{"pbrMetallicRoughness", {{"metallicFactor", -1}}}});
    const Scene scene = glb.load();
    EXPECT_EQ(scene.materials[0].roughness, 1.0f);
    EXPECT_EQ(scene.materials[0].ior, 1.0f);
    EXPECT_EQ(scene.materials[1].metallic, 0.0f);
    ASSERT_EQ(scene.warnings().size(), 1u);
    EXPECT_EQ(scene.warnings().begin()->second, 2u);
}

TEST(MaterialReader, SamplersHaveTheirFilters) {
    struct Case {
        int filter;
        bool is_nearest;
        LevelFilter levels;
    };
    for (const Case& expected : {Case{9728, true, LevelFilter::kFinest}, Case{9729, false, LevelFilter::kFinest},
                                 Case{9984, true, LevelFilter::kNearest}, Case{9985, false, LevelFilter::kNearest},
                                 Case{9986, true, LevelFilter::kBlended}, Case{9987, false, LevelFilter::kBlended},
                                 Case{0, false, LevelFilter::kBlended}, Case{1, false, LevelFilter::kBlended}}) {
        GlbBuilder glb;
        glb.push("images", {{"uri", "missing.png"}});
        glb.push("samplers", nlohmann::json::object());
        if (expected.filter > 0) glb.json["samplers"][0]["minFilter"] = expected.filter;
        glb.push("textures", {{"source", 0}, {"sampler", 0}});
        glb.push("materials", {{"emissiveTexture", {{"index", 0}}}});
        for (const int magnified : {9728, 9729}) {
            glb.json["samplers"][0]["magFilter"] = magnified;
            const Scene scene = glb.load();
            const TextureRef& texture = scene.materials[0].emission_texture;
            EXPECT_EQ(texture.is_nearest, magnified == 9728) << expected.filter;
            EXPECT_EQ(texture.is_nearest_minified, expected.is_nearest) << expected.filter;
            EXPECT_EQ(texture.levels, expected.levels) << expected.filter;
            EXPECT_EQ(scene.warnings().size(), expected.filter == 1 ? 2u : 1u) << "the missing image";
        }
    }
}

}  // namespace
}  // namespace zoe::test
