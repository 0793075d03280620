#include "engine/math/huge_allocator.h"

#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace zoe::detail {

namespace {

constexpr size_t kLine = 64;
constexpr size_t kHugePage = size_t(2) << 20;
// Smaller arrays fit into few enough pages of the usual size.
constexpr size_t kSmallestHuge = 2 * kHugePage;

std::align_val_t alignment(size_t size) {
    return std::align_val_t(size < kSmallestHuge ? kLine : kHugePage);
}

}  // namespace

void* allocate_huge(size_t size) {
    void* memory = ::operator new(size, alignment(size));
#ifdef __linux__
    // A hint: where the system has no huge pages to give, the usual ones serve.
    if (size >= kSmallestHuge) madvise(memory, size / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
    return memory;
}

void free_huge(void* memory, size_t size) {
    ::operator delete(memory, alignment(size));
}

}  // namespace zoe::detail
