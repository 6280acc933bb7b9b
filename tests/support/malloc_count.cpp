// SPDX-License-Identifier: Apache-2.0
#include "tests/support/malloc_count.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdlib>

// The C library's own functions under their other names: ours, defined below, stand in front.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace axg::test {
std::atomic<std::uint64_t> allocations{0};
}

#if AXG_COUNTS_MALLOC
extern "C" {
void* malloc(std::size_t size) noexcept {
    ++axg::test::allocations;
    return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
    ++axg::test::allocations;
    return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
    ++axg::test::allocations;
    return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
    ++axg::test::allocations;
    return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
    ++axg::test::allocations;
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
    ++axg::test::allocations;
    *out = __libc_memalign(alignment, size);
    return *out == nullptr ? ENOMEM : 0;
}
void free(void* memory) noexcept {
    axg::test::allocations +=
        memory != nullptr ? 1 : 0;  // freeing is work for the allocator as well
    __libc_free(memory);
}
}
#endif
