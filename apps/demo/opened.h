#pragma once

#include <memory>
#include <string>

#include "apps/common/open_scene.h"
#include "apps/demo/options.h"

namespace zoe {

/// A scene that is ready to be shown. It stays where it is in memory: frames look at it.
struct Opened {
    Options options;  ///< That it was opened by; with what lights it.
    Content content;
};

/// Opens a scene as the command line says, and finds what lights it.
/// Throws     SceneError, UsageError, std::runtime_error: what is wrong with the file, the options, or the sky's picture.
std::unique_ptr<Opened> open(Options options);

/// The options for another scene: without what was said of the first one only.
Options options_for(const Options& options, const std::string& scene);

}  // namespace zoe
