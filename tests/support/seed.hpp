// SPDX-License-Identifier: Apache-2.0
// The seed of a random test: printed, so that a failure can be had again; AXG_SEED overrides it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace axg::test {

inline std::uint64_t printed_seed(std::uint64_t usual) {
    const char* const text = std::getenv("AXG_SEED");
    const std::uint64_t seed = text == nullptr ? usual : std::strtoull(text, nullptr, 10);
    std::printf("seed %llu (AXG_SEED overrides it)\n", static_cast<unsigned long long>(seed));
    return seed;
}

}  // namespace axg::test
