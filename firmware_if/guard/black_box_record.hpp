// SPDX-License-Identifier: Apache-2.0
// What a black box holds, record by record, and the bytes of it: each with its length, its sequence
// and a checksum, so that a reader knows the first one that is damaged. us of the monotonic clock.
// Bytes: docs/guide/black-box.md.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <variant>

#include "core/base/crc32.hpp"
#include "core/machine/cycle_work.hpp"
#include "firmware_if/can/can_transport.hpp"
#include "firmware_if/guard/live_messages.hpp"
#include "firmware_if/guard/spsc_queue.hpp"

namespace axg {

/// A frame passed to the kernel, and its result. `time_us`: creation time of the frame.
struct SentFrame {
    CanFrame frame;
    SendStatus status = SendStatus::failed;
};

/// The logger was slow: number of missing records.
struct LostRecords {
    std::uint32_t count = 0;
};

/// Nothing was left out behind: a dump that does not end with it was cut short.
struct BlackBoxEnd {};

/// A turn of the bus thread without other records: only its time.
struct EmptyTurn {};

/// What came to the guard between two turns, from a person or from elsewhere in the process.
struct LiveCall {
    enum class Kind : std::uint8_t { arm, reset, report };
    Kind kind = Kind::arm;
    GuardFault fault = GuardFault::none;  // report
};

/// In this order on disk as well, counted from 1. ReadStatus: the wire was down, gone or failed.
using BlackBoxContent = std::variant<CanArrival, SentFrame, ReadStatus, LiveQuery, LiveResult,
                                     LiveNote, LostRecords, BlackBoxEnd, EmptyTurn, LiveCall>;

/// `time_us`: the turn of the bus thread in which it happened.
struct BlackBoxEntry {
    std::int64_t time_us = 0;
    BlackBoxContent content;
};
using BlackBoxQueue = SpscQueue<BlackBoxEntry, 4096>;

/// Of the whole dump.
struct BlackBoxHeader {
    std::array<char, 64> configuration{};  // SHA-256 in hexadecimal, as `axguard check` says it
    bool is_stoppable = false;             // contact mode otherwise
    bool accepts_local = false;            // frames of the guard's own host were the board's
    std::int64_t time_us = 0;              // of the dump
    std::int64_t unix_us = 0;              // the same instant on the wall clock
    CyclePlan plan{};                      // stoppable mode: what every certificate was proven by
};

inline constexpr std::array<std::uint8_t, 8> kBlackBoxMagic{'A', 'X', 'G',  'B',
                                                            'O', 'X', 0x1A, '\n'};
inline constexpr std::uint8_t kBlackBoxVersion = 8;
inline constexpr std::size_t kBlackBoxHeaderBytes = 172;
inline constexpr std::size_t kBlackBoxRecordBytesMin = 20;  // without content
inline constexpr std::size_t kBlackBoxRecordBytesMax = 320;

enum class BlackBoxStatus : std::uint8_t {
    ok = 0,
    cut_short,     // fewer bytes than it says, or than its kind has
    bad_magic,     // no black box
    bad_version,   // of another version of the program
    bad_length,    // not that of its kind
    bad_checksum,  // torn or flipped
    bad_content,   // a value that nobody writes
};
[[nodiscard]] const char* to_text(BlackBoxStatus status) noexcept;

void encode_black_box_header(const BlackBoxHeader& header,
                             std::span<std::uint8_t, kBlackBoxHeaderBytes> out) noexcept;
[[nodiscard]] BlackBoxStatus decode_black_box_header(std::span<const std::uint8_t> bytes,
                                                     BlackBoxHeader& out) noexcept;

/// Bytes written. Of a query its look-ahead path is left out: the frames have it.
[[nodiscard]] std::size_t encode_black_box_record(
    const BlackBoxEntry& entry, std::uint32_t sequence,
    std::span<std::uint8_t, kBlackBoxRecordBytesMax> out) noexcept;

struct BlackBoxRecord {
    BlackBoxEntry entry;  // the words of a note point into the bytes that were read
    std::uint32_t sequence = 0;
    std::size_t size_bytes = 0;
};
/// The record at the beginning of `bytes`.
[[nodiscard]] BlackBoxStatus decode_black_box_record(std::span<const std::uint8_t> bytes,
                                                     BlackBoxRecord& out) noexcept;

}  // namespace axg
