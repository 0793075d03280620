#include "engine/scene/gltf_view.h"

#include <algorithm>

namespace zoe {

namespace {

/// extras.shutter: this project's own word.
float shutter_of(const tinygltf::Value& extras, Scene& scene) {
    if (!extras.Has("shutter")) return 0.0f;
    const tinygltf::Value& word = extras.Get("shutter");
    const double share = word.IsNumber() ? word.GetNumberAsDouble() : -1.0;
    if (share >= 0.0 && share <= 1.0) return static_cast<float>(share);
    scene.warn("extras.shutter is no number from 0 to 1: ignored");
    return 0.0f;
}

}  // namespace

std::vector<Camera> read_cameras(const GltfFile& file, Scene& scene) {
    constexpr double kPi = 3.14159265358979323846;
    std::vector<Camera> cameras;
    for (size_t i = 0; i < file.model.cameras.size(); ++i) {
        const tinygltf::Camera& from = file.model.cameras[i];
        const std::string place = fmt::format("/cameras/{}", i);
        Camera camera;
        camera.name = from.name;
        camera.is_perspective = from.type == "perspective";
        if (camera.is_perspective) {
            const tinygltf::PerspectiveCamera& view = from.perspective;
            if (!(view.yfov > 0.0 && view.yfov < kPi)) file.fail(place + "/perspective/yfov", "it must be between 0 and pi");
            camera.yfov = static_cast<float>(view.yfov);
            if (!(view.aspectRatio >= 0.0)) file.fail(place + "/perspective/aspectRatio", "it must be above 0");
            camera.aspect = static_cast<float>(view.aspectRatio);
            camera.znear = static_cast<float>(view.znear);
            camera.zfar = static_cast<float>(view.zfar);
        } else {
            const tinygltf::OrthographicCamera& view = from.orthographic;
            if (view.xmag == 0.0 || view.ymag == 0.0) file.fail(place + "/orthographic", "xmag and ymag must not be 0");
            camera.xmag = static_cast<float>(view.xmag);
            camera.ymag = static_cast<float>(view.ymag);
            camera.znear = static_cast<float>(view.znear);
            camera.zfar = static_cast<float>(view.zfar);
        }
        if (camera.znear < 0.0f || (camera.zfar != 0.0f && camera.zfar <= camera.znear)) {
            scene.warn("a camera whose znear and zfar enclose nothing: they are not used");
        }
        camera.shutter = shutter_of(from.extras, scene);
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

std::vector<Light> read_lights(const GltfFile& file, Scene& scene) {
    std::vector<Light> lights;
    for (const tinygltf::Light& from : file.model.lights) {
        Light light;
        light.name = from.name;
        light.kind = from.type == "directional" ? LightKind::kDirectional
                     : from.type == "spot"      ? LightKind::kSpot
                                                : LightKind::kPoint;
        for (size_t c = 0; c < std::min<size_t>(from.color.size(), 3); ++c) {
            light.color[static_cast<int>(c)] = static_cast<float>(from.color[c]);
        }
        light.intensity = static_cast<float>(from.intensity);
        if (from.intensity < 0.0 || std::min({light.color.x, light.color.y, light.color.z}) < 0.0f) {
            scene.warn("a light that takes light away: switched off");
            light.intensity = 0.0f;
        }
        light.range = static_cast<float>(std::max(from.range, 0.0));
        light.inner_cone = static_cast<float>(from.spot.innerConeAngle);
        light.outer_cone = static_cast<float>(from.spot.outerConeAngle);
        if (!(light.inner_cone >= 0.0f && light.inner_cone <= light.outer_cone && light.outer_cone <= 1.5707964f)) {
            scene.warn("a spot light whose cones are not 0 <= inner <= outer <= pi / 2: clamped");
            light.outer_cone = std::clamp(light.outer_cone, 0.0f, 1.5707964f);
            light.inner_cone = std::clamp(light.inner_cone, 0.0f, light.outer_cone);
        }
        lights.push_back(std::move(light));
    }
    return lights;
}

}  // namespace zoe
