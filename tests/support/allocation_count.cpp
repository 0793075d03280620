#include "tests/support/allocation_count.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

// Once inlined, malloc and free look like a mismatch of new and delete.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

namespace {

std::atomic<size_t> count{0}, live{0}, peak{0};
std::atomic<size_t> left{SIZE_MAX};  // Allocations until they fail; SIZE_MAX: no end.

// What was asked for stands right before the memory: what malloc makes of it may differ from run to run, by as much as the
// alignment.
constexpr size_t kHeader = alignof(std::max_align_t);

void* counted(void* whole, size_t header, size_t size) {
    if (!whole) return nullptr;
    std::byte* const memory = static_cast<std::byte*>(whole) + header;
    std::memcpy(memory - sizeof size, &size, sizeof size);
    ++count;
    const size_t now = live += size;
    for (size_t most = peak; now > most && !peak.compare_exchange_weak(most, now);) {
    }
    return memory;
}

bool may_allocate() {
    size_t now = left;
    while (now > 0 && now != SIZE_MAX && !left.compare_exchange_weak(now, now - 1)) {
    }
    return now > 0;
}

void* allocate(size_t size) {
    if (size > PTRDIFF_MAX) return nullptr;  // as malloc does
    if (!may_allocate()) return nullptr;
    return counted(std::malloc(kHeader + size), kHeader, size);
}

void* allocate_aligned(size_t size, std::align_val_t alignment) {
    if (size > PTRDIFF_MAX) return nullptr;
    if (!may_allocate()) return nullptr;
    const size_t step = std::max(static_cast<size_t>(alignment), kHeader);
    return counted(std::aligned_alloc(step, step + (size + step - 1) / step * step), step, size);
}

void release(void* memory, size_t header) {
    if (!memory) return;
    size_t size;
    std::memcpy(&size, static_cast<std::byte*>(memory) - sizeof size, sizeof size);
    live -= size;
    std::free(static_cast<std::byte*>(memory) - header);
}

void* or_throw(void* memory) {
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(size_t size) {
    return or_throw(allocate(size));
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
    return allocate(size);
}
void* operator new(size_t size, std::align_val_t alignment) {
    return or_throw(allocate_aligned(size, alignment));
}
void operator delete(void* memory) noexcept {
    release(memory, kHeader);
}
void operator delete(void* memory, size_t) noexcept {
    release(memory, kHeader);
}
void operator delete(void* memory, std::align_val_t alignment) noexcept {
    release(memory, std::max(static_cast<size_t>(alignment), kHeader));
}
void operator delete(void* memory, size_t, std::align_val_t alignment) noexcept {
    operator delete(memory, alignment);
}

namespace zoe::test {

size_t allocation_count() {
    return count;
}

void fail_allocations_after(size_t allocation_count) {
    left = allocation_count;
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
