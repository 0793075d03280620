#include "engine/scene/gltf.h"

#include "engine/scene/check_surface.h"
#include "engine/scene/gltf_animation.h"
#include "engine/scene/gltf_file.h"
#include "engine/scene/gltf_material.h"
#include "engine/scene/gltf_mesh.h"
#include "engine/scene/gltf_node.h"
#include "engine/scene/gltf_skin.h"
#include "engine/scene/gltf_surface.h"
#include "engine/scene/gltf_view.h"
#include "engine/scene/tangents.h"

namespace zoe {
namespace {

/// Tangents for triangles with a normal texture, where the file has none.
void add_tangents(Mesh& mesh, const Scene& scene) {
    for (const MaterialRange& range : mesh.materials) {
        if (range.material == kNone<MaterialId>) continue;
        const Material& material = scene.materials[index(range.material)];
        for (const TextureRef* ref : {&material.normal_texture, &material.coat_normal_texture}) {
            // Those of the coat's texture only where the other has none.
            if (ref->image != kNone<ImageId>) derive_tangents(&mesh, range, ref->uv_set);
        }
    }
}

}  // namespace

Scene load_gltf(const std::filesystem::path& path, const GltfOptions& options) {
    Scene scene;
    scene.file = path.string();
    GltfFile file = open_gltf(path, options, scene);
    scene.materials = read_materials(file, scene);
    scene.images = read_images(file, options, scene);
    for (size_t i = 0; i < file.model.meshes.size(); ++i) {
        scene.meshes.push_back(read_mesh(file, i, scene));
        normalize_weights(scene.meshes.back(), scene);
        read_surface(file, i, scene.meshes.back(), scene);
        add_tangents(scene.meshes.back(), scene);
    }
    scene.skins = read_skins(file, scene);
    scene.cameras = read_cameras(file, scene);
    scene.lights = read_lights(file, scene);
    read_nodes(file, options, scene);
    check_skin_use(file, scene);
    scene.clips = read_clips(file, scene);
    decompose_animated(scene);
    add_instances(file, scene);
    check_zeros_shown(file, scene);
    if (!scene.clips.empty()) scene.playback.clips = {ClipId{0}};

    std::string broken = check(scene);
    if (broken.empty()) broken = check_surface_size(scene, options.max_triangles);
    if (!broken.empty()) throw SceneError(scene.file, "", broken);
    return scene;
}

}  // namespace zoe
