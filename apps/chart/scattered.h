#pragma once

#include "content/content.h"

namespace zoe::chart {

/// Copies of one small mesh all over a cube of 20 m, their sizes spread over three powers of ten: what the content's rows of
/// equal copies are not. Each frame at 24 a second scatters them anew.
Content make_scattered(int count);

}  // namespace zoe::chart
