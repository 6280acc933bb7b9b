// SPDX-License-Identifier: Apache-2.0
// How many cases a random test takes: AXG_COUNT, else its usual number.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace axg::test {

inline std::uint64_t count_from_environment(std::uint64_t usual) {
    const char* const text = std::getenv("AXG_COUNT");
#ifdef NDEBUG
    const std::uint64_t otherwise = usual;
#else
    const std::uint64_t otherwise = usual / 4;  // unoptimised, ten times as slow
#endif
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// Cases of each kind that exact arithmetic judges; few where it is the slow one.
inline unsigned count_a_kind() {
    const char* const text = std::getenv("AXG_COUNT");
#ifdef AXG_EXACT_SLOW
    constexpr unsigned kUsual = 50U;
#else
    constexpr unsigned kUsual = 1000U;
#endif
    return text == nullptr ? kUsual : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

}  // namespace axg::test
