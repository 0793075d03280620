#pragma once

#include <cstddef>

namespace zoe::test {

/// Calls of operator new in this program so far, on all threads. A program that calls this has the global ones replaced.
size_t allocation_count();

}  // namespace zoe::test
