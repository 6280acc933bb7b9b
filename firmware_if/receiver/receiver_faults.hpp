// SPDX-License-Identifier: Apache-2.0
// Every way in which frames can fail the receiver, and the one reaction to each:
// docs/reference/protocol.md prints this table.
#pragma once

#include <cstdint>

namespace axg {

/// Reaction to a fault. Zeroed memory means stop.
enum class Severity : std::uint8_t {
    stop = 0,  // the receiver is INVALID until a person acknowledges: no more snapshots, no permit
    drop,      // the frame is not used; if that lasts, the age of the last snapshot stops
    ignore,    // only counted: the frame was not for us, or is no reason to distrust data
};

enum class ReceiverFault : std::uint8_t {
    none,
    // ignore
    extended_id,
    remote_frame,
    error_frame,
    rx_passive,
    sync_early_or_late,
    // drop
    bad_length,
    bad_format,
    raw_dlc,
    bad_crc,
    repeated,
    wrong_sequence,
    torn,
    late_sample,
    sample_repeated,
    sync_missing,
    sender_clock,
    too_old,
    rx_overflow,
    // stop
    spoofed,
    no_position,
    out_of_travel,
    jump,
    frozen,
    not_homed,
    drive_fault,
    stale,
    loss_limit,
    flood,
    heartbeat_lost,
    heartbeat_state,
    tx_passive,
    bus_off,
    bus_restarted,
    local_sender,
    arrival_jitter,
    bad_layout,
    held_up,
    sync_period,
    count,
};
inline constexpr std::uint32_t kReceiverFaults = static_cast<std::uint32_t>(ReceiverFault::count);

struct FaultRow {
    ReceiverFault fault;
    Severity severity;
    const char* name;     // as the enumerator
    const char* meaning;  // one clause, for messages
};

/// The table's row; for an unknown value that of bad_layout, which stops.
[[nodiscard]] const FaultRow& fault_row(ReceiverFault fault) noexcept;
[[nodiscard]] const char* to_text(Severity severity) noexcept;

}  // namespace axg
