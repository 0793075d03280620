#pragma once

#include "apps/common/choose_view.h"
#include "apps/demo/options.h"

namespace zoe {

/// The view that the command line asks for: a camera, a place, else the file's first camera, else the whole scene over the
/// time that it plays, so that what moves stays in the picture. The same for every frame range.
/// Throws     UsageError for an unknown camera.
ViewChoice first_view(Content& content, const Options& options);

}  // namespace zoe
