// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/setup/cold_caches.hpp"

#include <link.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace axg {
namespace {

constexpr std::size_t kBytesMin = std::size_t{8} << 20U, kBytesMax = std::size_t{64} << 20U;
constexpr std::size_t kCopiedBytes = std::size_t{32} << 20U;
constexpr std::size_t kLineBytes = 64;

std::size_t cache_bytes() {
    std::size_t most = 0;
    for (const int name : {_SC_LEVEL2_CACHE_SIZE, _SC_LEVEL3_CACHE_SIZE, _SC_LEVEL4_CACHE_SIZE}) {
        most = std::max(most, static_cast<std::size_t>(std::max(0L, sysconf(name))));
    }
    return std::clamp(2 * most, kBytesMin, kBytesMax);
}

}  // namespace

ColdCaches::ColdCaches() : memory_(cache_bytes()) {}

void ColdCaches::write_through() noexcept {
    ++value_;
    volatile std::byte* const bytes = memory_.data();
    for (std::size_t i = 0; i < memory_.size(); i += kLineBytes) {
        bytes[i] = static_cast<std::byte>(value_);
    }
}

void ColdCaches::flush(std::span<const std::byte> memory) noexcept {
#if defined(__x86_64__)
    for (std::size_t i = 0; i < memory.size(); i += kLineBytes) {
        _mm_clflush(memory.data() + i);
    }
    _mm_mfence();
#elif defined(__aarch64__)
    for (std::size_t i = 0; i < memory.size(); i += kLineBytes) {
        asm volatile("dc civac, %0" : : "r"(memory.data() + i) : "memory");
    }
    asm volatile("dsb sy" : : : "memory");
#else
    static_cast<void>(memory);
#endif
}

void ColdCaches::flush_code() noexcept {
    const auto flush_segments = [](dl_phdr_info* of, std::size_t, void*) noexcept {
        for (int i = 0; i < of->dlpi_phnum; ++i) {
            const ElfW(Phdr)& segment = of->dlpi_phdr[i];
            if (segment.p_type == PT_LOAD && (segment.p_flags & PF_X) != 0) {
                // NOLINTNEXTLINE(performance-no-int-to-ptr): the loader tells addresses so
                auto* const begin = reinterpret_cast<char*>(of->dlpi_addr + segment.p_vaddr);
#if defined(__aarch64__)
                __builtin___clear_cache(begin, begin + segment.p_memsz);
#else
                flush(std::as_bytes(std::span(begin, segment.p_memsz)));
#endif
            }
        }
        return 0;
    };
    dl_iterate_phdr(flush_segments, nullptr);
}

MemoryCopier::MemoryCopier()
    : memory_(2 * kCopiedBytes), thread_([this] {
          while (!is_over_.load(std::memory_order_relaxed)) {
              std::memcpy(memory_.data(), memory_.data() + kCopiedBytes, kCopiedBytes);
              asm volatile("" : : "r"(memory_.data()) : "memory");  // not optimized out
          }
      }) {}

MemoryCopier::~MemoryCopier() {
    is_over_.store(true, std::memory_order_relaxed);
    thread_.join();
}

}  // namespace axg
