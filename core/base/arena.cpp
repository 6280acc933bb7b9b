// SPDX-License-Identifier: Apache-2.0
#include "core/base/arena.hpp"

#include <cstdlib>
#include <cstring>
#include <utility>

namespace axg {

Arena::Arena(std::size_t size_bytes) noexcept {
    const std::size_t size = Arena::size_bytes<std::byte>(size_bytes == 0 ? 1 : size_bytes);
    begin_ = static_cast<std::byte*>(std::aligned_alloc(kAlignment, size));
    if (begin_ != nullptr) {
        std::memset(begin_, 0, size);
        size_ = size;
    }
}

Arena::Arena(Arena&& other) noexcept
    : begin_(std::exchange(other.begin_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      used_(std::exchange(other.used_, 0)),
      sealed_(other.sealed_) {}

Arena::~Arena() {
    std::free(begin_);  // NOLINT(cppcoreguidelines-no-malloc): the pair of aligned_alloc above
}

}  // namespace axg
