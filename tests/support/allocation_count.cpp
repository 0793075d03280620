#include "tests/support/allocation_count.h"

#include <atomic>
#include <cstdlib>
#include <new>

// Once inlined, malloc and free look like a mismatch of new and delete.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

namespace {
std::atomic<size_t> count{0};
}

void* operator new(size_t size) {
    ++count;
    if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
    throw std::bad_alloc();
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
    ++count;
    return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
    std::free(memory);
}

namespace zoe::test {

size_t allocation_count() {
    return count;
}

}  // namespace zoe::test
