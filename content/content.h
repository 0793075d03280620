#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "engine/scene/scene.h"

namespace zoe {

/// A scene made by this project, and what writes its meshes each frame.
struct Content {
    Scene scene;
    std::function<void(Scene&, double time_s)> write;  ///< Call before `advance`; empty where nothing is written.
};

struct ContentInfo {
    const char* name;         ///< What `--list` and the programs call it.
    const char* description;  ///< One line.
    int default_size;         ///< What the size knob is unless told; its meaning is in the description.
};

/// Every scene there is: "default" (the zoetrope, from its .glb) and one maker or more a motion class.
std::span<const ContentInfo> content_list();

/// Makes a scene of the list. Deterministic.
/// size       0: the default size.
/// Throws     SceneError for an unknown name; the message lists the names.
Content make_content(const std::string& name, int size = 0);

/// The folder with this project's .glb files: $ZOETROPE_CONTENT, beside the sources, or where it was installed.
std::filesystem::path content_folder();

}  // namespace zoe
