#include "tests/support/allocation_count.h"

#include <atomic>
#include <cstdlib>
#include <new>

#include <malloc.h>

// Once inlined, malloc and free look like a mismatch of new and delete.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

namespace {

std::atomic<size_t> count{0}, live{0}, peak{0};

void* counted(void* memory) {
    if (!memory) return nullptr;
    ++count;
    const size_t now = live += malloc_usable_size(memory);
    for (size_t most = peak; now > most && !peak.compare_exchange_weak(most, now);) {
    }
    return memory;
}

void* counted_or_throw(void* memory) {
    if (!memory) throw std::bad_alloc();
    return counted(memory);
}

void* aligned(size_t size, std::align_val_t alignment) {
    const size_t step = static_cast<size_t>(alignment);
    return std::aligned_alloc(step, (size + step - 1) / step * step);
}

void release(void* memory) {
    if (memory) live -= malloc_usable_size(memory);
    std::free(memory);
}

}  // namespace

void* operator new(size_t size) {
    return counted_or_throw(std::malloc(size > 0 ? size : 1));
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
    return counted(std::malloc(size > 0 ? size : 1));
}
void* operator new(size_t size, std::align_val_t alignment) {
    return counted_or_throw(aligned(size > 0 ? size : 1, alignment));
}
void operator delete(void* memory) noexcept {
    release(memory);
}
void operator delete(void* memory, size_t) noexcept {
    release(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    release(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
    release(memory);
}

namespace zoe::test {

size_t allocation_count() {
    return count;
}

size_t live_bytes() {
    return live;
}

size_t peak_bytes() {
    return peak;
}

void reset_peak_bytes() {
    peak = live.load();
}

}  // namespace zoe::test
