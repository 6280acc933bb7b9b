// SPDX-License-Identifier: Apache-2.0
// The newest value of one thread for one other, without a lock: neither can make the other wait,
// the writer always has room, and the reader misses values that were replaced before its call.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace axg {

template <class Item>
class Newest {
    static_assert(std::is_trivially_copyable_v<Item>);

  public:
    /// The writing thread.
    void write(const Item& item) noexcept {
        items_[back_] = item;
        back_ = between_.exchange(back_ | kIsNew, std::memory_order_acq_rel) & kPlace;
    }

    /// The reading thread. False: none since the last call, `item` is untouched.
    [[nodiscard]] bool take(Item& item) noexcept {
        if ((between_.load(std::memory_order_relaxed) & kIsNew) == 0) {
            return false;
        }
        front_ = between_.exchange(front_, std::memory_order_acq_rel) & kPlace;
        item = items_[front_];
        return true;
    }

  private:
    static constexpr std::uint32_t kPlace = 3, kIsNew = 4;

    std::array<Item, 3> items_{};  // of the writer, of the reader, and between them
    alignas(64) std::uint32_t back_ = 0;
    alignas(64) std::uint32_t front_ = 1;
    alignas(64) std::atomic<std::uint32_t> between_{2};
};

}  // namespace axg
