// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/protocol/e2e.hpp"

#include <array>

namespace axg {
namespace {

template <class Word>
constexpr std::array<Word, 256> make_table(Word polynomial) noexcept {
    constexpr int kTopBit = static_cast<int>(sizeof(Word) * 8) - 1;
    std::array<Word, 256> table{};
    for (unsigned i = 0; i < 256; ++i) {
        unsigned crc = i << (kTopBit - 7);
        for (int bit = 0; bit < 8; ++bit) {
            const bool carry = ((crc >> kTopBit) & 1U) != 0;
            crc = (crc << 1U) ^ (carry ? polynomial : 0U);
        }
        table[i] = static_cast<Word>(crc);
    }
    return table;
}

constexpr auto kTable2F = make_table<std::uint8_t>(0x2F);
constexpr auto kTable1D = make_table<std::uint8_t>(0x1D);
constexpr auto kTable1021 = make_table<std::uint16_t>(0x1021);

std::uint8_t crc8(const std::array<std::uint8_t, 256>& table, std::span<const std::uint8_t> bytes,
                  std::uint8_t crc) noexcept {
    for (const std::uint8_t byte : bytes) {
        crc = table[crc ^ byte];
    }
    return crc;
}

std::array<std::uint8_t, 2> low_first(std::uint16_t value) noexcept {
    return {static_cast<std::uint8_t>(value & 0xFFU), static_cast<std::uint8_t>(value >> 8U)};
}

std::uint16_t p05_crc(std::span<const std::uint8_t> frame, std::uint16_t data_id) noexcept {
    return crc16_ccitt(low_first(data_id), crc16_ccitt(frame.subspan(2)));
}

}  // namespace

std::uint8_t crc8_h2f(std::span<const std::uint8_t> bytes) noexcept {
    return crc8(kTable2F, bytes, 0xFF) ^ 0xFF;
}

std::uint8_t crc8_j1850(std::span<const std::uint8_t> bytes) noexcept {
    return crc8(kTable1D, bytes, 0xFF) ^ 0xFF;
}

std::uint16_t crc16_ccitt(std::span<const std::uint8_t> bytes, std::uint16_t start) noexcept {
    unsigned crc = start;
    for (const std::uint8_t byte : bytes) {
        crc = ((crc << 8U) & 0xFFFFU) ^ kTable1021[(crc >> 8U) ^ byte];
    }
    return static_cast<std::uint16_t>(crc);
}

std::uint8_t classical_crc(std::span<const std::uint8_t, 8> frame, std::uint16_t data_id) noexcept {
    const std::uint8_t crc = crc8(kTable2F, frame.subspan(1), 0xFF);
    return crc8(kTable2F, low_first(data_id), crc) ^ 0xFF;
}

void p05_protect(std::span<std::uint8_t> frame, std::uint16_t data_id,
                 std::uint8_t counter) noexcept {
    frame[2] = counter;
    const auto crc = low_first(p05_crc(frame, data_id));
    frame[0] = crc[0];
    frame[1] = crc[1];
}

bool p05_check(std::span<const std::uint8_t> frame, std::uint16_t data_id) noexcept {
    if (frame.size() < kP05HeaderBytes) {
        return false;
    }
    const auto crc = low_first(p05_crc(frame, data_id));
    return frame[0] == crc[0] && frame[1] == crc[1];
}

Sequence SequenceCheck::next(std::uint16_t counter) noexcept {
    if (!has_reference_) {
        has_reference_ = true;
        reference_ = counter;
        return Sequence::ok;
    }
    const std::uint16_t step = delta(reference_, counter);
    if (step == 0) {
        return Sequence::repeated;
    }
    if (step == 1 || step <= delta_max_) {
        reference_ = counter;
        has_pending_ = false;
        return step == 1 ? Sequence::ok : Sequence::some_lost;
    }
    const bool follows = has_pending_ && delta(pending_, counter) == 1;
    pending_good_ = follows ? static_cast<std::uint8_t>(pending_good_ + 1) : std::uint8_t{0};
    pending_ = counter;
    has_pending_ = true;
    if (pending_good_ < init_count_ || init_count_ == 0) {
        return Sequence::wrong;
    }
    reference_ = counter;
    has_pending_ = false;
    return Sequence::ok;
}

}  // namespace axg
