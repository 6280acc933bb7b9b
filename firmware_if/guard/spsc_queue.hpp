// SPDX-License-Identifier: Apache-2.0
// A queue of fixed size from one thread to one other, without a lock: neither can make the other
// wait. Full: the newest is rejected, and the caller handles that.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <type_traits>

namespace axg {

template <class Item, std::size_t kSize>
class SpscQueue {
    static_assert((kSize & (kSize - 1)) == 0, "places are counted modulo a power of two");
    static_assert(std::is_trivially_copyable_v<Item>);

  public:
    /// The writing thread. False: full, nothing was written.
    [[nodiscard]] bool push(const Item& item) noexcept {
        const std::size_t end = end_.load(std::memory_order_relaxed);
        if (end - begin_.load(std::memory_order_acquire) == kSize) {
            return false;
        }
        items_[end % kSize] = item;
        end_.store(end + 1, std::memory_order_release);
        return true;
    }

    /// The reading thread. False: empty, `item` is untouched.
    [[nodiscard]] bool pop(Item& item) noexcept {
        const std::size_t begin = begin_.load(std::memory_order_relaxed);
        if (begin == end_.load(std::memory_order_acquire)) {
            return false;
        }
        item = items_[begin % kSize];
        begin_.store(begin + 1, std::memory_order_release);
        return true;
    }

  private:
    std::array<Item, kSize> items_{};
    alignas(64) std::atomic<std::size_t> begin_{0};  // a cache line for each writer
    alignas(64) std::atomic<std::size_t> end_{0};
};

}  // namespace axg
