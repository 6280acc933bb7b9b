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

}  // namespace axg::test
