#pragma once

#include <cstddef>

namespace zoe {

namespace detail {
void* allocate_huge(size_t size);
void free_huge(void* memory, size_t size);
}  // namespace detail

/// Memory that rays walk through at random: aligned to cache lines, and to huge pages where it is large, so that an address
/// is found by one look into the processor's page table cache instead of several.
template <typename T>
struct HugeAllocator {
    using value_type = T;
    HugeAllocator() = default;
    template <typename U>
    HugeAllocator(const HugeAllocator<U>&) {}
    /// Throws     std::bad_alloc.
    T* allocate(size_t count) { return static_cast<T*>(detail::allocate_huge(count * sizeof(T))); }
    void deallocate(T* memory, size_t count) { detail::free_huge(memory, count * sizeof(T)); }
    friend bool operator==(const HugeAllocator&, const HugeAllocator&) { return true; }
};

}  // namespace zoe
