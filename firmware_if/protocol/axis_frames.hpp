// SPDX-License-Identifier: Apache-2.0
// Axis positions to CAN frames and back, in the formats of core/machine/wire_format.hpp: set-up
// gives a frame set the codec of its format, and no cycle compares formats. Byte by byte:
// docs/reference/protocol.md. No allocation, no state of the bus: the receiver decides whether a
// frame may be used (axis_receiver.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/machine/axis_snapshot.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/look_ahead_path.hpp"
#include "firmware_if/can/can_frame.hpp"

namespace axg {

inline constexpr std::uint32_t kFramesPerSnapshotMax =
    kAxisFramesMax + 4;  // with SYNC, heartbeat, look-ahead path and session
inline constexpr std::int32_t kNoPosition24 = -(1 << 23);  // marker: no position
inline constexpr std::int32_t kNoPosition32 = INT32_MIN;
inline constexpr double kAngleUnitDeg = 1.0e-4;
inline constexpr std::uint8_t kHeartbeatOperational = 5;
inline constexpr std::int64_t kHeartbeatPeriodUs = 10000;
inline constexpr std::int64_t kSessionPeriodUs = 100'000;

struct AxisCodec;

/// Places of all values in the frames, derived once from a Machine: fixed arrays, so that coding
/// needs no heap and no Machine.
struct AxisFrameSet {
    struct AxisWire {
        AxisKind kind = AxisKind::linear;
        bool unlimited = false;
        double unit = 0;  // mm or rad of one count on the wire (signals: |factor| in these units)
        double still_speed = 0;  // mm/s or deg/s: a drive that reports no more is at rest
    };
    const WireFormat* wire = &kWireFormats[0];
    const AxisCodec* codec = nullptr;  // null in an empty set
    std::uint32_t axis_count = 0;      // 0: the set is empty
    std::uint32_t frame_count = 0;     // axis frames a snapshot
    std::uint32_t sample_us = 0;
    std::uint8_t sync_counter_max = kSyncCounterMax;  // 0: SYNC is empty
    std::array<std::uint32_t, kAxisFramesMax> ids{};  // as core/machine/can_id.hpp marks them
    std::array<std::uint16_t, kAxisFramesMax> data_ids{};
    std::array<AxisWire, kAxesMax> axes{};
    std::array<std::uint8_t, kAxisFramesMax> frame_bytes{};  // exact length of each
    std::array<bool, kAxisFramesMax> is_flexible{};
    std::array<std::uint16_t, kAxisFramesMax> counter_modulus{};  // 0: the frame counts nothing
    std::array<SignalSelector, kAxisFramesMax> selectors{};       // which frames of an id are this
    std::array<CanSignal, kSignalsMax> signals{};
    std::array<std::uint8_t, kSignalsMax> signal_slots{};  // the frame that contains each
    std::uint32_t signal_count = 0;
    std::uint32_t sync_id = 0, heartbeat_id = 0;
    std::uint32_t look_ahead_samples = 0;  // 0: no such frame
    std::uint32_t look_ahead_id = 0;
    std::uint16_t look_ahead_data_id = 0;
    std::uint8_t look_ahead_bytes = 0;
    std::uint32_t session_id = 0;  // of the board's session frame; 0: none is read
};
/// @param machine  as a machine file states it: config/can checks ids, signals and look-ahead path
/// @return         empty if the layout of another machine does not fit the arrays
[[nodiscard]] AxisFrameSet make_frame_set(const Machine& machine) noexcept;

/// mm or rad of one count of each axis on the bus; 0 in an empty set.
[[nodiscard]] std::array<double, kAxesMax> axis_units(const Machine& machine) noexcept;

/// The content of one axis frame. It has raw counts in addition to the values: tests for equality
/// and markers use them.
struct AxisFrameContent {
    std::uint8_t counter = 0;          // classical 0..15, fd 0..255, others where they have one
    std::uint8_t sample_index = 0;     // (SYNC counter - 1) modulo WireFormat::index_modulus
    std::uint32_t sender_time_us = 0;  // fd only
    bool has_status = false;           // mode, flags and tool below are valid
    bool has_tool = false;             // tool is valid; classical frames carry its low byte only
    std::uint8_t mode = 0, flags = 0;
    std::uint16_t tool = 0;
    std::uint32_t drive_in_fault = kNoIndex;  // the axis whose drive reports a fault
    std::uint32_t value_count = 0;
    struct Value {
        std::uint32_t axis = 0;
        std::int64_t raw = 0;
        bool known = false;   // false: the "no position" marker
        double position = 0;  // mm or rad; endless axes in [0, one turn)
    };
    std::array<Value, kAxesMax> values{};
};

enum class FrameStatus : std::uint8_t { ok, not_ours, bad_length, bad_format, raw_dlc, bad_crc };

/// How both ends code the axis frames of a format.
struct AxisCodec {
    FrameStatus (*decode)(const AxisFrameSet& set, std::uint32_t slot, const CanFrame& frame,
                          AxisFrameContent& out) noexcept;
    /// Writes all axis frames of a snapshot; returns the axis that does not fit, or kNoIndex.
    /// @param last  the snapshot before: drives report speeds
    std::uint32_t (*fill)(const AxisFrameSet& set, const AxisSnapshot& snapshot,
                          const AxisSnapshot& last, std::uint32_t counter,
                          std::span<CanFrame> out) noexcept;
    // Of own frames. CAN FD pads them to its next length.
    std::uint16_t counter_modulus = 0;
    bool is_flexible = false;
    std::uint8_t bytes = 8, bytes_an_axis = 0;
};
[[nodiscard]] const AxisCodec& axis_codec(const WireFormat& wire) noexcept;

/// Number of the set's axis frame with this id, and with this selector where frames share an id;
/// frame_count: none. An id of 11 bits never matches one of 29.
[[nodiscard]] std::uint32_t slot_of(const AxisFrameSet& set, const CanFrame& frame) noexcept;

/// Decodes axis frame number `slot` of the set. Refuses every other frame; does not judge counters.
[[nodiscard]] FrameStatus decode_axis_frame(const AxisFrameSet& set, std::uint32_t slot,
                                            const CanFrame& frame, AxisFrameContent& out) noexcept;

/// The content of the frame of the look-ahead path.
struct LookAheadFrameContent {
    std::uint8_t counter = 0;
    std::uint8_t sync_counter = 0;  // of the sample that was latched when it was sent
    std::uint32_t samples = 0;      // `position` is of so many samples later
    std::array<double, kAxesMax> position{}, before{};
};

/// Decodes the frame of the look-ahead path. Also bad_format: another number of samples than the
/// set has, or a position with the marker.
[[nodiscard]] FrameStatus decode_look_ahead_frame(const AxisFrameSet& set, const CanFrame& frame,
                                                  LookAheadFrameContent& out) noexcept;

/// SYNC with a counter 1..240, and the heartbeat of a node.
[[nodiscard]] CanFrame encode_sync(std::uint32_t id, std::uint8_t counter,
                                   std::int64_t time_us) noexcept;
[[nodiscard]] CanFrame encode_heartbeat(std::uint32_t id, std::uint8_t state,
                                        std::int64_t time_us) noexcept;

/// The SYNC counter of the sample-th sample: 1..240, and again.
[[nodiscard]] constexpr std::uint8_t sync_counter_of(
    std::uint64_t sample, std::uint8_t counter_max = kSyncCounterMax) noexcept {
    return static_cast<std::uint8_t>(sample % counter_max + 1);
}

/// Time a frame occupies the bus, worst-case stuffing and inter-frame space included: 55 + 10 n
/// bits for a classical frame, 41 + 2 n us for a flexible one at 1/5 Mbit/s (approximation; n =
/// payload bytes). Source: can-utils canframelen.
[[nodiscard]] std::int64_t bus_time_us(const CanFrame& frame, std::uint32_t bit_rate) noexcept;

enum class EncodeStatus : std::uint8_t {
    ok,
    bad_layout,     // the frame set is empty
    bad_snapshot,   // another number of axes than the machine
    out_of_range,   // a position does not fit its field, or is not finite
    out_too_small,  // `out` holds fewer than the frames needed
};
[[nodiscard]] const char* to_text(EncodeStatus status) noexcept;

struct EncodeResult {
    EncodeStatus status = EncodeStatus::ok;
    std::uint32_t axis = kNoIndex;  // which axis did not fit
    std::uint32_t frame_count = 0;  // frames written; 0 unless ok
};

struct EncoderOptions {
    std::uint32_t bit_rate = 1'000'000;  // arbitration rate; fd data at five times that
    std::int64_t spacing_us = 0;         // idle time the board leaves between its frames
    // Sends the session of a board that a person armed once. False: the caller sends it.
    bool says_session = true;
    std::uint32_t nonce = 0x5E5510;
};

/// Plays the motion board: SYNC, the axis frames, the heartbeat every 10 ms, the session every 100
/// ms and with each lap (signals: the axis frames only; cia402: no heartbeat). SYNC ends at
/// snapshot.latched_us; the others follow by their bus time, or evenly spread where they do not fit
/// into one sample period, which is possible only in a simulation.
class AxisEncoder {
  public:
    explicit AxisEncoder(const Machine& machine, EncoderOptions options = {}) noexcept;

    /// @param out    room for kFramesPerSnapshotMax frames; in order of time. Untouched counters
    /// unless ok.
    /// @param look_ahead  command of the board look_ahead_samples later; null: not announced
    [[nodiscard]] EncodeResult encode(const AxisSnapshot& snapshot, std::span<CanFrame> out,
                                      const PathPoints* look_ahead = nullptr) noexcept;
    [[nodiscard]] const AxisFrameSet& frame_set() const noexcept { return set_; }

  private:
    [[nodiscard]] bool is_session_due(const AxisSnapshot& snapshot) const noexcept;

    AxisFrameSet set_;
    EncoderOptions options_;
    std::uint32_t counter_ = 0;  // of snapshots; each format uses the bits of its field
    bool has_heartbeat_ = false;
    std::int64_t heartbeat_us_ = 0;
    bool has_session_ = false;
    std::int64_t session_us_ = 0;
    std::uint8_t session_counter_ = 0;
    AxisSnapshot last_;  // drives report speeds: how far each axis came since
};

}  // namespace axg
