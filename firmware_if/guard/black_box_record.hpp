// SPDX-License-Identifier: Apache-2.0
// Records of a black box and their bytes. Each has its length, sequence number and checksum, so
// that a reader detects the first damaged one. Times: us of the monotonic clock.
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

/// The end of a complete dump: a dump that does not end with it was cut short.
struct BlackBoxEnd {};

/// A turn of the bus thread without other records: only its time.
struct EmptyTurn {};

/// A call to the guard between two turns, by a person or another part of the process.
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

/// Header of the whole dump.
struct BlackBoxHeader {
    std::array<char, 64> configuration{};  // SHA-256 in hexadecimal, as `axguard check` prints it
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
    cut_short,     // fewer bytes than its length field states, or than its kind has
    bad_magic,     // no black box
    bad_version,   // of another version of the program
    bad_length,    // not the length of its kind
    bad_checksum,  // torn or flipped
    bad_content,   // a value that no encoder writes
};
[[nodiscard]] const char* to_text(BlackBoxStatus status) noexcept;

void encode_black_box_header(const BlackBoxHeader& header,
                             std::span<std::uint8_t, kBlackBoxHeaderBytes> out) noexcept;
[[nodiscard]] BlackBoxStatus decode_black_box_header(std::span<const std::uint8_t> bytes,
                                                     BlackBoxHeader& out) noexcept;

/// Returns the bytes written. Omits the look-ahead path of a query: the frames contain it.
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
