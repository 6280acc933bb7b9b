// SPDX-License-Identifier: Apache-2.0
// How many cases a random test takes: AXG_COUNT, else its usual number, divided by
// AXG_COUNT_DIVISOR where that is set (test.sh by day).
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace axg::test {

inline std::uint64_t divided_count(std::uint64_t usual) {
    const char* const text = std::getenv("AXG_COUNT_DIVISOR");
    const std::uint64_t divisor = text == nullptr ? 1 : std::strtoull(text, nullptr, 10);
    return std::max<std::uint64_t>(usual / std::max<std::uint64_t>(divisor, 1), 1);
}

/// @param least  of fewer cases the test could tell nothing, AXG_COUNT apart
inline std::uint64_t count_from_environment(std::uint64_t usual, std::uint64_t least = 1) {
    const char* const text = std::getenv("AXG_COUNT");
#ifdef NDEBUG
    const std::uint64_t otherwise = std::max(divided_count(usual), least);
#else
    const std::uint64_t otherwise =
        std::max(divided_count(usual) / 4, least);  // unoptimised, ten times as slow
#endif
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// How many cases exact arithmetic judges: AXG_COUNT, else `usual`, or `slow` where it is the slow
/// one.
inline unsigned exact_count([[maybe_unused]] unsigned usual, [[maybe_unused]] unsigned slow) {
    const char* const text = std::getenv("AXG_COUNT");
#ifdef AXG_EXACT_SLOW
    const unsigned otherwise = slow;
#else
    const auto otherwise = static_cast<unsigned>(divided_count(usual));
#endif
    return text == nullptr ? otherwise : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

/// Cases of each kind.
inline unsigned count_a_kind() {
    return exact_count(1000, 50);
}

}  // namespace axg::test
