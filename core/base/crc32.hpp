// SPDX-License-Identifier: Apache-2.0
// A checksum against accidents: CRC-32 as in IEEE 802.3 and zlib.
#pragma once

#include <cstdint>
#include <span>

namespace axg {

/// Reflected 0x04C11DB7, start and final xor all ones; "123456789" gives 0xCBF43926.
/// @param before  checksum of the data before `bytes`, to continue from
[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes,
                                  std::uint32_t before = 0) noexcept;

}  // namespace axg
