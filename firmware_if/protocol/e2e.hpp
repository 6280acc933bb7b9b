// SPDX-License-Identifier: Apache-2.0
// End-to-end protection of frames: checksums, the AUTOSAR E2E profile 5 header, and the counter
// rule with resync. Source: AUTOSAR E2E profiles 1, 2 and 5 as summed up in
// docs/reference/protocol.md; check values are in tests/unit/firmware_if/protocol/e2e_test.cpp.
#pragma once

#include <cstdint>
#include <span>

namespace axg {

/// CRC-8H2F: polynomial 0x2F, start 0xFF, final xor 0xFF. "123456789" gives 0xDF.
/// Guards the classical axis frames: every two-bit and every odd error of 8 bytes is seen.
[[nodiscard]] std::uint8_t crc8_h2f(std::span<const std::uint8_t> bytes) noexcept;

/// CRC-8 SAE J1850: polynomial 0x1D, start 0xFF, final xor 0xFF. "123456789" gives 0x4B.
[[nodiscard]] std::uint8_t crc8_j1850(std::span<const std::uint8_t> bytes) noexcept;

inline constexpr std::uint16_t kCrc16Start = 0xFFFF;

/// CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no reflection, no final xor. "123456789"
/// gives 0x29B1.
/// @param start  the checksum so far, so that a message can be fed in pieces
[[nodiscard]] std::uint16_t crc16_ccitt(std::span<const std::uint8_t> bytes,
                                        std::uint16_t start = kCrc16Start) noexcept;

inline constexpr std::size_t kP05HeaderBytes = 3;  // CRC low byte, CRC high byte, counter

/// The CRC of a classical axis frame: over bytes 1..7, then the Data ID, low byte first.
/// @param frame  8 bytes; byte 0 is not read
[[nodiscard]] std::uint8_t classical_crc(std::span<const std::uint8_t, 8> frame,
                                         std::uint16_t data_id) noexcept;

/// Writes the P05 header: CRC-16 little-endian over everything after it and then the Data ID, low
/// byte first.
/// @param frame  at least kP05HeaderBytes; the payload after the header is already in place
void p05_protect(std::span<std::uint8_t> frame, std::uint16_t data_id,
                 std::uint8_t counter) noexcept;

/// True if the header's CRC belongs to this payload, counter and Data ID. A frame shorter than the
/// header is false.
[[nodiscard]] bool p05_check(std::span<const std::uint8_t> frame, std::uint16_t data_id) noexcept;

enum class Sequence : std::uint8_t { ok, some_lost, repeated, wrong };

/// The counter rule: +1 is ok, up to `delta_max` some lost, 0 repeated, anything else wrong. A
/// wrong frame does not move the reference; only `init_count` frames in unbroken order after it do.
/// Counters run first..first + modulus - 1.
class SequenceCheck {
  public:
    constexpr SequenceCheck() noexcept = default;
    constexpr SequenceCheck(std::uint16_t modulus, std::uint8_t delta_max,
                            std::uint8_t init_count) noexcept
        : modulus_(modulus), delta_max_(delta_max), init_count_(init_count) {}

    /// Judges the next counter and moves the reference where the rule allows. The first counter is
    /// ok.
    [[nodiscard]] Sequence next(std::uint16_t counter) noexcept;
    /// Result of next() for this counter, without a change of state.
    [[nodiscard]] bool is_repeat(std::uint16_t counter) const noexcept {
        return has_reference_ && counter == reference_;
    }
    /// Forgets everything: the next counter is the first one.
    void reset() noexcept { has_reference_ = has_pending_ = false; }

  private:
    [[nodiscard]] std::uint16_t delta(std::uint16_t from, std::uint16_t to) const noexcept {
        return static_cast<std::uint16_t>((to + modulus_ - from) % modulus_);
    }

    std::uint16_t modulus_ = 256;
    std::uint8_t delta_max_ = 3;
    std::uint8_t init_count_ = 2;
    std::uint16_t reference_ = 0;
    std::uint16_t pending_ = 0;
    std::uint8_t pending_good_ = 0;
    bool has_reference_ = false;
    bool has_pending_ = false;
};

}  // namespace axg
