// SPDX-License-Identifier: Apache-2.0
// Prefetches memory that is read or written a little later: other programs may have used the caches
// since the last cycle, and an early request costs nothing. Changes no result.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/host_device.hpp"

namespace axg {

inline constexpr std::size_t kCacheLineBytes = 64;

template <class T>
AXG_HD void fetch(const T& what) noexcept {
    for (std::size_t at = 0; at < sizeof(T); at += kCacheLineBytes) {
        __builtin_prefetch(reinterpret_cast<const char*>(&what) + at);
    }
}

/// Prefetches the item in this place, if there is one, for a write.
template <class T>
AXG_HD void fetch_to_write(std::span<T> items, std::size_t place) noexcept {
    for (std::size_t at = 0; place < items.size() && at < sizeof(T); at += kCacheLineBytes) {
        __builtin_prefetch(reinterpret_cast<const char*>(&items.data()[place]) + at, 1);
    }
}

}  // namespace axg
