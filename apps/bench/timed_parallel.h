#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace zoe {

/// Calls `work(begin, end)` for tasks of `grain` items on all threads: what is timed where rays are traced.
/// Returns    ms.
/// Throws     Interrupted, before all tasks are done.
double timed_parallel(size_t count, size_t grain, const std::function<void(size_t, size_t)>& work);

/// Where the program runs under valgrind's callgrind, has it write a file under this label: of what `timed_parallel`
/// executed since the last one, and of nothing else where instrumentation is off at the start. Nothing otherwise, and in a
/// program that was built without valgrind's header.
void write_instruction_count(const std::string& label);

}  // namespace zoe
