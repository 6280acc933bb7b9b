// SPDX-License-Identifier: Apache-2.0
// Cache states for the measurement of a cycle: without its data, without its code, or with a thread
// that copies memory and so uses bandwidth and shared caches.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

namespace axg {

class ColdCaches {
  public:
    /// Memory of twice the largest cache that this processor reports, within 8 and 64 MiB.
    ColdCaches();

    /// Evicts all other data from the caches.
    void write_through() noexcept;
    /// Evicts only this memory, from every cache, whatever its size. No effect on processors other
    /// than x86-64 and AArch64.
    static void flush(std::span<const std::byte> memory) noexcept;
    /// Evicts all code of this program and its libraries.
    static void flush_code() noexcept;

  private:
    std::vector<std::byte> memory_;
    std::uint8_t value_ = 0;
};

/// Copies memory on a thread of its own, for as long as it lives.
class MemoryCopier {
  public:
    MemoryCopier();
    MemoryCopier(const MemoryCopier&) = delete;
    MemoryCopier& operator=(const MemoryCopier&) = delete;
    ~MemoryCopier();

  private:
    std::atomic<bool> is_over_{false};
    std::vector<std::byte> memory_;
    std::thread thread_;
};

}  // namespace axg
