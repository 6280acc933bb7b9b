// SPDX-License-Identifier: Apache-2.0
// Eight bytes at a time ("slicing by 8", Kounavis and Berry, 2005): a compiled machine holds
// megabytes, and one byte at a time would need as long as the rest of its loading.
#include "core/base/crc32.hpp"

#include <array>
#include <cstddef>

namespace axg {
namespace {

using Table = std::array<std::uint32_t, 256>;

/// [k][byte]: contribution of the byte to the checksum k bytes later.
constexpr std::array<Table, 8> kTables = [] {
    std::array<Table, 8> tables{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t rest = i;
        for (int bit = 0; bit < 8; ++bit) {
            rest = (rest >> 1U) ^ ((rest & 1U) != 0 ? 0xEDB88320U : 0U);
        }
        tables[0][i] = rest;
    }
    for (std::size_t k = 1; k < tables.size(); ++k) {
        for (std::size_t i = 0; i < 256; ++i) {
            const std::uint32_t rest = tables[k - 1][i];
            tables[k][i] = tables[0][rest & 0xFFU] ^ (rest >> 8U);
        }
    }
    return tables;
}();

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t before) noexcept {
    std::uint32_t rest = ~before;
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
        std::uint32_t next = 0;
        for (std::size_t i = 0; i < 8; ++i) {
            const std::uint32_t old = i < 4 ? rest >> (8 * i) : 0;
            next ^= kTables[7 - i][(old ^ bytes[i]) & 0xFFU];
        }
        rest = next;
    }
    for (const std::uint8_t byte : bytes) {
        rest = kTables[0][(rest ^ byte) & 0xFFU] ^ (rest >> 8U);
    }
    return ~rest;
}

}  // namespace axg
