// SPDX-License-Identifier: Apache-2.0
// State of board and guard from the frames on the bus, for a display: positions, permit, hints,
// stop, heartbeat, hashes. Garbage is counted and changes nothing else. No clock, no I/O; us.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/machine/configuration_hashes.hpp"
#include "core/machine/machine.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/hints_frame.hpp"
#include "firmware_if/protocol/permit_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"

namespace axg {

inline constexpr std::int64_t kNeverSeen = INT64_MIN;

/// Whether a permit answers for the board's session.
enum class PermitAnswer : std::uint8_t { unknown = 0, right, wrong };

struct BusState {
    std::uint64_t frames = 0;            // data frames with an id of the machine file
    std::uint64_t bad = 0;               // of the guard's ids, without the content of that id
    std::int64_t guard_us = kNeverSeen;  // last good frame of the guard
    std::int64_t board_us = kNeverSeen;  // last complete sample
    std::optional<AxisSnapshot> axes;    // of that sample
    std::optional<Hints> hints;          // of a pair of the machine, or of none
    std::int64_t hints_us = kNeverSeen;
    std::optional<Permit> permit;  // newest; without nonce and lap
    PermitAnswer answer = PermitAnswer::unknown;
    std::int64_t permit_us = kNeverSeen;
    std::int64_t permit_end_us = kNeverSeen;  // latest t_k + n T of all that answer right
    std::optional<GuardHeartbeat> heartbeat;
    std::int64_t heartbeat_us = kNeverSeen;
    std::optional<GuardPhase> phase;  // of the status for an operator
    std::int64_t phase_us = kNeverSeen;
    std::optional<Emergency> emergency;  // of the newest stop; none after its reset
    std::int64_t stop_us = kNeverSeen;   // last stop frame
    std::uint32_t other_hashes = 0;      // a bit for each part that the guard has otherwise
    ReceiverFault input_fault = ReceiverFault::none;  // newest that ended the reading of samples
    std::int64_t input_fault_us = kNeverSeen;
};

class BusView {
  public:
    /// `machine` must outlive it.
    BusView(const Machine& machine, const ConfigurationHashes& hashes) noexcept;

    /// In order of arrival.
    void on_frame(const CanFrame& frame) noexcept;
    /// Now and then: finds silence, and begins to read samples again after a fault.
    void on_time(std::int64_t now_us) noexcept;
    [[nodiscard]] const BusState& state() const noexcept { return state_; }

  private:
    void on_event(const ReceiverEvent& event) noexcept;
    [[nodiscard]] bool read_guard_frame(const CanFrame& frame) noexcept;
    [[nodiscard]] bool read_permit(const CanFrame& frame) noexcept;
    void note_permit(const Permit& permit, std::int64_t now_us) noexcept;
    [[nodiscard]] bool note_hints(const CanFrame& frame) noexcept;
    [[nodiscard]] bool read_hash(const CanFrame& frame) noexcept;
    [[nodiscard]] bool read_emergency(const CanFrame& frame) noexcept;
    [[nodiscard]] bool read_heartbeat(const CanFrame& frame) noexcept;
    [[nodiscard]] bool read_phase(const CanFrame& frame) noexcept;

    const Machine& machine_;
    ConfigurationHashes hashes_;
    AxisReceiver receiver_;
    CanFrame plain_;  // waits for its twin
    bool has_plain_ = false;
    std::array<std::int64_t, kSyncCounterMax + 1> latched_us_;  // by SYNC counter
    BusState state_;
};

}  // namespace axg
