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

/// Sizes an array that is about to be written anew, whatever is in it. Never at once in the old place and a new one. The
/// first time it gets the room that it needs and no more; where that was too little, an eighth more than it needs now: what
/// grows from frame to frame moves only now and then.
template <typename Vector>
void resize_anew(Vector* array, size_t count) {
    if (count > array->capacity()) {
        const size_t room = array->capacity() == 0 ? count : count + count / 8;
        Vector().swap(*array);
        array->reserve(room);
    }
    array->resize(count);
}

}  // namespace zoe
