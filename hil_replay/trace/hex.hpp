// SPDX-License-Identifier: Apache-2.0
// Hexadecimal digits by table: the scanners of traces live on it.
#pragma once

#include <array>
#include <cstdint>

namespace axg::detail {

inline constexpr std::array<std::int8_t, 256> kNibble = [] {
    std::array<std::int8_t, 256> table{};
    table.fill(-1);
    for (std::size_t i = 0; i < 10; ++i) {
        table['0' + i] = static_cast<std::int8_t>(i);
    }
    for (std::size_t i = 0; i < 6; ++i) {
        table['A' + i] = static_cast<std::int8_t>(10 + i);
        table['a' + i] = static_cast<std::int8_t>(10 + i);
    }
    return table;
}();

/// 0..15, or negative where `c` is no hexadecimal digit.
[[nodiscard]] inline int nibble(char c) noexcept {
    return kNibble[static_cast<unsigned char>(c)];
}

}  // namespace axg::detail
