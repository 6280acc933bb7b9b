// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace axg::cuda {

/// Divides one block of memory into arrays. Without a block it only counts the bytes needed.
class MemoryBlock {
  public:
    explicit MemoryBlock(std::byte* base) : base_(base) {}
    template <class T>
    T* take(std::size_t count) {
        used_ = (used_ + kAlignment - 1) / kAlignment * kAlignment;
        const std::size_t at = used_;
        used_ += count * sizeof(T);
        return base_ == nullptr ? nullptr : reinterpret_cast<T*>(base_ + at);
    }
    [[nodiscard]] std::size_t used() const { return used_; }

  private:
    static constexpr std::size_t kAlignment = 256;
    std::byte* base_;
    std::size_t used_ = 0;
};

}  // namespace axg::cuda
