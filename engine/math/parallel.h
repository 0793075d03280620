#pragma once

#include <cstddef>
#include <type_traits>

namespace zoe {

/// How many threads `parallel_for` may use. 0 means one a core.
/// Requires   that no parallel_for is running.
void set_thread_count(int count);
int thread_count();

namespace detail {
using RangeFunction = void (*)(void* context, size_t begin, size_t end);
void parallel_ranges(size_t begin, size_t end, size_t grain, RangeFunction function, void* context);
}  // namespace detail

/// Calls `body(begin, end)` on disjoint ranges that cover [begin, end), each of at most `grain` indices, on several
/// threads. Ranges start at begin + k * grain whatever the number of threads. Calls may be nested.
/// Requires   that the body writes only what belongs to its indices. The first exception is rethrown to the caller.
template <typename Body>
void parallel_for(size_t begin, size_t end, size_t grain, Body&& body) {
    using Plain = std::remove_reference_t<Body>;
    detail::parallel_ranges(
        begin, end, grain, [](void* context, size_t b, size_t e) { (*static_cast<Plain*>(context))(b, e); },
        const_cast<std::remove_const_t<Plain>*>(&body));
}

}  // namespace zoe
