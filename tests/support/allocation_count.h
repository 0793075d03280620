#pragma once

#include <cstddef>

// A program that calls one of these has the global operator new and delete replaced.

namespace zoe::test {

/// Calls of operator new so far, on all threads.
size_t allocation_count();

/// From now on, operator new succeeds so many times on all threads together, and fails from then on. SIZE_MAX: it never
/// does.
void fail_allocations_after(size_t count);

/// What operator new has given out and not got back, in bytes, and the most that this was since `reset_peak_bytes`.
size_t live_bytes();
size_t peak_bytes();
void reset_peak_bytes();

}  // namespace zoe::test
