// SPDX-License-Identifier: Apache-2.0
// What a cycle finds in the caches: nothing of its data, nothing of its code, or a copier beside it
// that takes memory and shared caches.
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

    /// Drives what lies in the caches out of them.
    void write_through() noexcept;
    /// The same of this memory alone, out of every cache, whatever its size. No effect where
    /// programs may not do so.
    static void flush(std::span<const std::byte> memory) noexcept;
    /// And of all code of this program and its libraries.
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
