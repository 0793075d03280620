#pragma once

/// Everything a program needs to load, animate and trace a scene.
#include "engine/bvh/cache.h"
#include "engine/frame/frame.h"
#include "engine/math/parallel.h"
#include "engine/scene/gltf.h"
#include "engine/scene/obj.h"
#include "engine/scene/sequence.h"
