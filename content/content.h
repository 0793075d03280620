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
    int default_size;         ///< What the size knob is unless told; its meaning is in the description. 0: no knob.
    int max_size;             ///< Larger ones are refused, so that a slip does not fill the memory. 0: no knob.
};

/// Every scene there is: "default" (the zoetrope, from its .glb) and one maker or more a motion class.
std::span<const ContentInfo> content_list();

/// What a user's name means: NAME or NAME-SIZE, such as "rigid" or "instances-100000".
struct ContentName {
    const ContentInfo* info = nullptr;
    int size = 0;  ///< 0: the default size.
};

/// Reads NAME or NAME-SIZE, without making anything.
/// Throws     SceneError for an unknown name, and for a size that is not a whole number from 1 to the scene's largest; the
///            message lists the names and the form.
ContentName parse_content_name(const std::string& name);

/// Tells whether a text is meant as NAME or NAME-...: whatever its size, good or bad.
bool is_content_name(const std::string& name);

/// Makes a scene of the list. Deterministic. Each has a camera node `view`.
/// name       NAME, or NAME-SIZE where `size` is 0.
/// size       0: the name's, else the default size.
/// Throws     SceneError as `parse_content_name` does.
Content make_content(const std::string& name, int size = 0);

/// The folder with this project's .glb files: $ZOETROPE_CONTENT, beside the sources, or where it was installed.
std::filesystem::path content_folder();

}  // namespace zoe
