// SPDX-License-Identifier: Apache-2.0
// An identifier of 11 or 29 bits in one number: bit 31 marks 29 bits, as a DBC file and SocketCAN
// write it. So an identifier of 11 bits never equals one of 29 bits.
#pragma once

#include <cstdint>

namespace axg {

inline constexpr std::uint32_t kExtendedIdBit = 0x80000000U;
inline constexpr std::uint32_t kStandardIdMax = 0x7FF, kExtendedIdMax = 0x1FFFFFFF;

[[nodiscard]] constexpr std::uint32_t wire_id(std::uint32_t number, bool is_extended) noexcept {
    return number | (is_extended ? kExtendedIdBit : 0U);
}
[[nodiscard]] constexpr bool is_extended_id(std::uint32_t wire_id) noexcept {
    return (wire_id & kExtendedIdBit) != 0;
}
/// The identifier without bit 31.
[[nodiscard]] constexpr std::uint32_t id_number(std::uint32_t wire_id) noexcept {
    return wire_id & ~kExtendedIdBit;
}
/// Whether a frame with this number, of 29 bits or not, has this id.
[[nodiscard]] constexpr bool is_id_of(std::uint32_t wire_id, std::uint32_t number,
                                      bool is_extended) noexcept {
    return id_number(wire_id) == number && is_extended_id(wire_id) == is_extended;
}
[[nodiscard]] constexpr bool is_wire_id(std::uint32_t wire_id) noexcept {
    return id_number(wire_id) <= (is_extended_id(wire_id) ? kExtendedIdMax : kStandardIdMax);
}

}  // namespace axg
