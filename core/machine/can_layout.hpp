// SPDX-License-Identifier: Apache-2.0
// Which frame carries which axis: plain data from the machine file, read by both ends of the wire.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/limits.hpp"
#include "core/machine/wire_format.hpp"

namespace axg {

inline constexpr std::uint32_t kLookAheadAxesMax = 7;   // 6 + 8 * 7 = 62 bytes
inline constexpr std::uint32_t kSignalsMax = 96;        // of all frames together
inline constexpr std::uint32_t kSelectorLevelsMax = 3;  // a multiplexor within a page, twice
inline constexpr std::uint32_t kSelectorRangesMax = 8;  // of values, of all levels together
// Axis frames of a sample. Drives: separate positions and status words; signals: one a frame, and
// four of the board itself.
inline constexpr std::uint32_t kAxisFramesMax = 2 * kAxesMax + 4;

enum class ByteOrder : std::uint8_t { little, big };
enum class SignalType : std::uint8_t { integer, float32, float64 };  // IEEE 754

/// Meaning of a signal. Boolean signals are true at one raw value, CanSignal::mark.
enum class SignalRole : std::uint8_t {
    position,     // of an axis
    velocity,     // of an axis: whether it moves
    tool,         // the tool number
    moving,       // yes: the board reports that axes move
    tool_change,  // yes: the tool may change
    homed,        // anything but yes: an axis has no reference
    counter,      // counts the frames of its message; mark is its modulus
    drive_status  // of an axis: status word 0x6041; mark is the bit mask for homed, 0: always
};

/// A frame carries a signal only while each of these runs of bits has one of its values (a DBC
/// file's multiplexors, the outermost first). Ranges are sorted and do not touch, so that equal
/// selectors are of the same frames.
struct SignalSelector {
    struct Level {
        std::uint16_t start_bit = 0;
        std::uint8_t length_bits = 0;
        ByteOrder order = ByteOrder::little;
        std::uint8_t range_count = 0;  // of `ranges`, after those of the levels before

        friend bool operator==(const Level&, const Level&) = default;
    };
    struct Range {
        std::uint32_t least = 0, most = 0;

        friend bool operator==(const Range&, const Range&) = default;
    };
    std::uint8_t level_count = 0;  // 0: the signal is in every frame
    std::array<Level, kSelectorLevelsMax> levels{};
    std::array<Range, kSelectorRangesMax> ranges{};

    friend bool operator==(const SignalSelector&, const SignalSelector&) = default;
};

/// One value inside a frame that is not ours. Bits are numbered as a DBC file numbers them:
/// `start_bit` is the least significant bit (little) or the most significant (big).
struct CanSignal {
    std::uint32_t id = 0;    // bit 31: of 29 bits, see can_id.hpp
    std::uint32_t axis = 0;  // index into Machine::axes, for roles of an axis
    std::uint16_t start_bit = 0;
    std::uint8_t length_bits = 0;
    ByteOrder order = ByteOrder::little;
    bool is_signed = true;
    double factor = 1.0;  // raw * factor + offset = mm or degrees (a unit in the file is folded in)
    double offset = 0.0;
    SignalType type = SignalType::integer;
    SignalRole role = SignalRole::position;
    std::uint8_t frame_bytes = 0;  // exact length of its frame; 0: CanLayout::signal_frame_bytes
    bool is_flexible = false;      // CAN FD; frames of more than 8 bytes are in any case
    std::uint32_t mark = 1;        // see SignalRole
    SignalSelector selector;
};

/// A permit for sample k is valid to k + n. n is one of these: the longest that is proven.
struct PermitSamples {
    std::uint8_t least = 3, most = 3;

    friend bool operator==(const PermitSamples&, const PermitSamples&) = default;
};
/// Whether a cycle queries each pair twice: with the least n, and with a longer one.
[[nodiscard]] constexpr bool tries_longer(PermitSamples samples) noexcept {
    return samples.most > samples.least;
}
inline constexpr PermitSamples kPermitSamplesUsual{3, 12};  // if the permit states its n
// With these a lost frame never costs the only permit. They are used if that costs little: with
// guard.cap the machine slows down where no longer permit is proven, and a look-ahead path states
// where the axes go.
inline constexpr PermitSamples kPermitSamplesLonger{8, 12};

/// Age of the positions of a sample at its latch. Each position has an age of its own.
struct ValueAge {
    std::uint32_t least_us = 0, most_us = 0;

    friend bool operator==(const ValueAge&, const ValueAge&) = default;
};

/// Ids default to docs/reference/protocol.md: motion board = node 1, guard = node 2.
struct CanLayout {
    CanFormat format{};              // see wire_of
    std::uint32_t sample_us = 1000;  // the board's period T
    std::uint32_t sync_id = 0x080;
    std::vector<std::uint32_t> axis_ids{0x181, 0x281, 0x381};  // classical: in slot order; fd: one
    std::vector<std::uint16_t> data_ids{0x0181, 0x0281, 0x0381};  // E2E Data ID of each axis frame
    // Format fd: periods by which the board's look-ahead path is ahead; 0: the board sends none.
    std::uint32_t look_ahead_samples = 0;
    std::uint32_t look_ahead_id = 0x481;
    std::uint16_t look_ahead_data_id = 0x0481;
    std::vector<CanSignal> signals;                   // formats signals and cia402
    std::uint8_t signal_frame_bytes = 8;              // of signals that state none
    std::uint8_t sync_counter_max = kSyncCounterMax;  // cia402; 0: SYNC is empty
    bool guard_sends_sync = false;     // cia402: the guard is the producer, every sample_us
    std::uint32_t sync_window_us = 0;  // cia402: process data later than this are not of this SYNC;
                                       // 0: sample_us
    ValueAge latched_age;
    // signals: how much later one arrival may be than another; 0: see arrival_jitter_us_of
    std::uint32_t arrival_jitter_us = 0;
    std::uint32_t heartbeat_in_id = 0x701;
    std::uint32_t permit_id = 0x103;  // its bit-inverted twin is permit_id + 1
    std::uint32_t stop_id = 0x001;    // GFC
    std::uint32_t emergency_id = 0x082;
    std::uint32_t heartbeat_out_id = 0x702;
    // The next four ids are of boards with a sample counter: see has_sample_counter.
    std::uint32_t session_in_id = 0x583;
    std::uint32_t hints_id =
        0x682;  // of CANopen's free ids; on the bus only heartbeats yield to it
    std::uint32_t operator_in_id = 0x584, operator_out_id = 0x604;
    // Received and sent configuration hashes; both 0: board and guard do not exchange them.
    std::uint32_t hashes_in_id = 0, hashes_out_id = 0;
    std::vector<std::uint32_t> quick_stop_ids;  // of the quick stop commands to drives
    PermitSamples permit_samples;
    // Receiver rules, docs/reference/protocol.md (5d).
    std::uint8_t counter_delta_max = 6;   // 2..this = OK, some lost
    std::uint8_t sync_counter_init = 2;   // good frames before a wrong sequence is believed again
    std::uint32_t stale_after_us = 3000;  // age of the complete snapshot
    std::uint32_t frozen_samples = 100;   // mode is moving, positions bit-equal
    std::uint32_t heartbeat_timeout_us = 65'000;  // of the board; formats of our own only
};

[[nodiscard]] inline const WireFormat& wire_of(const CanLayout& can) noexcept {
    return wire_format(can.format);
}
[[nodiscard]] inline bool is_native(const CanLayout& can) noexcept {
    return is_native(wire_of(can));
}

/// Frames that carry the signals: one for each id and selector.
[[nodiscard]] inline std::size_t signal_frames(const std::vector<CanSignal>& signals) noexcept {
    std::size_t count = 0;
    for (auto at = signals.begin(); at != signals.end(); ++at) {
        count += std::none_of(signals.begin(), at, [&](const CanSignal& other) {
            return other.id == at->id && other.selector == at->selector;
        });
    }
    return count;
}

/// Whether SYNC counts the samples from 1 to 240. Without it no permit can name its sample: signals
/// have no SYNC, and a counter that wraps earlier gives an old permit the number of a new sample.
/// The guard then sends no permits, and the board has no session.
[[nodiscard]] inline bool has_sample_counter(const CanLayout& can) noexcept {
    return has_sync(wire_of(can)) && can.sync_counter_max == kSyncCounterMax;
}

/// The time between two samples may be off by this where their arrival dates them; 0: SYNC does.
/// Without a stated limit of jitter two samples may be numbered a period short
/// (firmware_if/receiver/arrival_anchor.hpp).
[[nodiscard]] inline std::uint32_t arrival_jitter_us_of(const CanLayout& can) noexcept {
    const std::uint32_t limit_us =
        can.arrival_jitter_us != 0 ? can.arrival_jitter_us : 2 * can.sample_us;
    return has_sync(wire_of(can)) ? 0 : limit_us;
}

/// Whether the frames themselves report motion: by a mode, or by the speeds of all axes.
[[nodiscard]] inline bool reports_motion(const CanLayout& can, std::size_t axis_count) noexcept {
    if (wire_of(can).rest == RestReport::mode) {
        return true;
    }
    std::uint32_t with_speed = 0;
    for (const CanSignal& signal : can.signals) {
        if (signal.role == SignalRole::moving) {
            return true;
        }
        with_speed |= signal.role == SignalRole::velocity ? 1U << signal.axis : 0U;
    }
    return with_speed == (1U << axis_count) - 1U;
}

}  // namespace axg
