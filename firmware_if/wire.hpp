// SPDX-License-Identifier: Apache-2.0
// Integers in and out of frame bytes, by arithmetic and not by overlay: the same on every
// processor.
#pragma once

#include <cstdint>

#include "core/can_layout.hpp"

namespace axg::detail {

/// Little-endian, `bytes` 1 to 8.
constexpr void put_little(std::uint8_t* to, std::uint64_t value, unsigned bytes) noexcept {
    for (unsigned i = 0; i < bytes; ++i) {
        to[i] = static_cast<std::uint8_t>(value >> (8U * i));
    }
}

[[nodiscard]] constexpr std::uint64_t get_little(const std::uint8_t* from,
                                                 unsigned bytes) noexcept {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < bytes; ++i) {
        value |= static_cast<std::uint64_t>(from[i]) << (8U * i);
    }
    return value;
}

/// Two's complement of `bits` bits (1 to 64), widened. Bits above must be 0. No bits: 0.
[[nodiscard]] constexpr std::int64_t sign_extend(std::uint64_t value, unsigned bits) noexcept {
    if (bits == 0) {
        return 0;
    }
    const std::uint64_t sign = std::uint64_t{1} << (bits - 1U);
    return static_cast<std::int64_t>((value ^ sign) - sign);
}

/// Position of a signal's bit number i, counted from its start bit in the direction of its byte
/// order: little-endian signals climb from the least significant bit, big-endian ones fall from the
/// most significant bit.
[[nodiscard]] constexpr unsigned bit_position(const CanSignal& signal, unsigned i) noexcept {
    if (signal.order == ByteOrder::little) {
        return signal.start_bit + i;
    }
    const unsigned serial = signal.start_bit / 8U * 8U + (7U - signal.start_bit % 8U) + i;
    return serial / 8U * 8U + (7U - serial % 8U);
}

[[nodiscard]] constexpr std::int64_t get_signal(const CanSignal& signal,
                                                const std::uint8_t* data) noexcept {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < signal.length_bits; ++i) {
        const unsigned at = bit_position(signal, i);
        const std::uint64_t bit = (data[at / 8U] >> (at % 8U)) & 1U;
        const unsigned weight = signal.order == ByteOrder::little ? i : signal.length_bits - 1U - i;
        value |= bit << weight;
    }
    return signal.is_signed ? sign_extend(value, signal.length_bits)
                            : static_cast<std::int64_t>(value);
}

constexpr void put_signal(const CanSignal& signal, std::int64_t value,
                          std::uint8_t* data) noexcept {
    const auto bits = static_cast<std::uint64_t>(value);
    for (unsigned i = 0; i < signal.length_bits; ++i) {
        const unsigned at = bit_position(signal, i);
        const unsigned weight = signal.order == ByteOrder::little ? i : signal.length_bits - 1U - i;
        const auto mask = static_cast<std::uint8_t>(1U << (at % 8U));
        const bool is_set = ((bits >> weight) & 1U) != 0;
        data[at / 8U] =
            static_cast<std::uint8_t>(is_set ? data[at / 8U] | mask : data[at / 8U] & ~mask);
    }
}

/// Whether `value` can be stored in the signal's bits.
[[nodiscard]] constexpr bool fits_signal(const CanSignal& signal, std::int64_t value) noexcept {
    const unsigned bits = signal.is_signed ? signal.length_bits - 1U : signal.length_bits;
    const std::int64_t end = std::int64_t{1} << bits;
    return value < end && value >= (signal.is_signed ? -end : 0);
}

}  // namespace axg::detail
