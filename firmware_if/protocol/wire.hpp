// SPDX-License-Identifier: Apache-2.0
// Integers in and out of frame bytes, by arithmetic and not by overlay: the same on every
// processor.
#pragma once

#include <bit>
#include <cstdint>

#include "core/machine/can_layout.hpp"

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

/// Position of bits in a frame, as CanSignal counts them.
struct BitRun {
    unsigned start_bit, length_bits;
    ByteOrder order;
};
[[nodiscard]] constexpr BitRun bits_of(const CanSignal& signal) noexcept {
    return {signal.start_bit, signal.length_bits, signal.order};
}
[[nodiscard]] constexpr BitRun bits_of(const SignalSelector::Level& level) noexcept {
    return {level.start_bit, level.length_bits, level.order};
}

/// Position of bit number i, counted from the start bit in the direction of the byte order:
/// little-endian runs climb from the least significant bit, big-endian ones fall from the most
/// significant bit.
[[nodiscard]] constexpr unsigned bit_position(const BitRun& run, unsigned i) noexcept {
    if (run.order == ByteOrder::little) {
        return run.start_bit + i;
    }
    const unsigned serial = run.start_bit / 8U * 8U + (7U - run.start_bit % 8U) + i;
    return serial / 8U * 8U + (7U - serial % 8U);
}

[[nodiscard]] constexpr std::uint64_t get_bits(const BitRun& run,
                                               const std::uint8_t* data) noexcept {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < run.length_bits; ++i) {
        const unsigned at = bit_position(run, i);
        const std::uint64_t bit = (data[at / 8U] >> (at % 8U)) & 1U;
        value |= bit << (run.order == ByteOrder::little ? i : run.length_bits - 1U - i);
    }
    return value;
}

constexpr void put_bits(const BitRun& run, std::uint64_t bits, std::uint8_t* data) noexcept {
    for (unsigned i = 0; i < run.length_bits; ++i) {
        const unsigned at = bit_position(run, i);
        const unsigned weight = run.order == ByteOrder::little ? i : run.length_bits - 1U - i;
        const auto mask = static_cast<std::uint8_t>(1U << (at % 8U));
        const bool is_set = ((bits >> weight) & 1U) != 0;
        data[at / 8U] =
            static_cast<std::uint8_t>(is_set ? data[at / 8U] | mask : data[at / 8U] & ~mask);
    }
}

/// Whether a frame is of the selector: each level has one of its values.
[[nodiscard]] constexpr bool selects(const SignalSelector& selector,
                                     const std::uint8_t* data) noexcept {
    std::uint32_t range = 0;
    for (std::uint32_t level = 0; level < selector.level_count; ++level) {
        const std::uint64_t value = get_bits(bits_of(selector.levels[level]), data);
        bool is_of_level = false;
        for (std::uint32_t i = 0; i < selector.levels[level].range_count; ++i, ++range) {
            is_of_level |=
                selector.ranges[range].least <= value && value <= selector.ranges[range].most;
        }
        if (!is_of_level) {
            return false;
        }
    }
    return true;
}

/// Makes a frame one of the selector, by the least value of each level.
constexpr void put_selector(const SignalSelector& selector, std::uint8_t* data) noexcept {
    std::uint32_t range = 0;
    for (std::uint32_t level = 0; level < selector.level_count; ++level) {
        put_bits(bits_of(selector.levels[level]), selector.ranges[range].least, data);
        range += selector.levels[level].range_count;
    }
}

/// The bits of an integer signal, widened; those of a floating-point one as they are.
[[nodiscard]] constexpr std::int64_t get_signal(const CanSignal& signal,
                                                const std::uint8_t* data) noexcept {
    const std::uint64_t bits = get_bits(bits_of(signal), data);
    return signal.is_signed && signal.type == SignalType::integer
               ? sign_extend(bits, signal.length_bits)
               : static_cast<std::int64_t>(bits);
}

/// The number in a signal's raw bits, without factor and offset. Not finite if a float is not.
[[nodiscard]] constexpr double number_of(const CanSignal& signal, std::int64_t raw) noexcept {
    switch (signal.type) {
        case SignalType::integer:
            return static_cast<double>(raw);
        case SignalType::float32:
            return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
        case SignalType::float64:
            return std::bit_cast<double>(raw);
    }
    return 0;
}

[[nodiscard]] constexpr double value_of(const CanSignal& signal, std::int64_t raw) noexcept {
    return number_of(signal, raw) * signal.factor + signal.offset;
}

constexpr void put_signal(const CanSignal& signal, std::int64_t value,
                          std::uint8_t* data) noexcept {
    put_bits(bits_of(signal), static_cast<std::uint64_t>(value), data);
}

/// Whether `value` can be stored in the signal's bits.
[[nodiscard]] constexpr bool fits_signal(const CanSignal& signal, std::int64_t value) noexcept {
    const unsigned bits = signal.is_signed ? signal.length_bits - 1U : signal.length_bits;
    const std::int64_t end = std::int64_t{1} << bits;
    return value < end && value >= (signal.is_signed ? -end : 0);
}

}  // namespace axg::detail
