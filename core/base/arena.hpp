// SPDX-License-Identifier: Apache-2.0
// The one host allocation: divided at init, then sealed. Its parts are zeroed and aligned for the
// widest load.
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include "core/base/assert.hpp"

namespace axg {

class Arena {
  public:
    static constexpr std::size_t kAlignment = 64;

    /// Bytes that `count` items of T use, alignment included.
    template <class T>
    [[nodiscard]] static constexpr std::size_t size_bytes(std::size_t count) noexcept {
        return (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
    }

    /// Allocates and touches every page. `ok()` is false when there is not that much memory.
    explicit Arena(std::size_t size_bytes) noexcept;
    ~Arena();
    Arena(Arena&& other) noexcept;
    Arena& operator=(Arena&&) = delete;

    [[nodiscard]] bool ok() const noexcept { return begin_ != nullptr; }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    template <class T>
    [[nodiscard]] std::span<T> take(std::size_t count) noexcept {
        static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlignment);
        AXG_ASSERT(!sealed_);
        AXG_ASSERT(count <= size_ / sizeof(T));  // or the bytes below could wrap around
        AXG_ASSERT(size_bytes<T>(count) <= size_ - used_);
        T* const first = reinterpret_cast<T*>(begin_ + used_);
        used_ += size_bytes<T>(count);
        return {first, count};
    }
    void seal() noexcept { sealed_ = true; }

  private:
    std::byte* begin_ = nullptr;
    std::size_t size_ = 0, used_ = 0;
    bool sealed_ = false;
};

}  // namespace axg
