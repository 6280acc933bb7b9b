// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/receiver/receiver_faults.hpp"

namespace axg {
namespace {

using F = ReceiverFault;
using S = Severity;

constexpr FaultRow kRows[] = {
    {F::none, S::ignore, "none", "no fault"},
    {F::extended_id, S::ignore, "extended_id",
     "the low bits of an extended id equal one of our ids"},
    {F::remote_frame, S::ignore, "remote_frame", "a remote frame requests one of our ids"},
    {F::error_frame, S::ignore, "error_frame", "the controller reports an error on the bus"},
    {F::rx_passive, S::ignore, "rx_passive", "the controller is error-passive as a receiver"},
    {F::sync_early_or_late, S::ignore, "sync_early_or_late",
     "SYNC was more than a fifth of a period early or late"},
    {F::bad_length, S::drop, "bad_length", "the frame has not exactly the length of its id"},
    {F::bad_format, S::drop, "bad_format", "classical and flexible mixed up, or a reserved value"},
    {F::raw_dlc, S::drop, "raw_dlc", "a classical frame states a length code above 8"},
    {F::bad_crc, S::drop, "bad_crc", "the checksum does not match payload and id"},
    {F::repeated, S::ignore, "repeated", "the frame was received twice"},
    {F::wrong_sequence, S::drop, "wrong_sequence", "the counter did not advance by one"},
    {F::torn, S::drop, "torn", "a new sample began before the last one was complete"},
    {F::late_sample, S::drop, "late_sample", "a frame of a sample older than the newest"},
    {F::sample_repeated, S::drop, "sample_repeated", "new counter, old sample index"},
    {F::sync_missing, S::drop, "sync_missing", "no SYNC dates this sample"},
    {F::sender_clock, S::drop, "sender_clock", "the sender's clock did not advance by the period"},
    {F::too_old, S::drop, "too_old", "the snapshot was complete only after the age limit"},
    {F::rx_overflow, S::drop, "rx_overflow", "frames were lost in a receive queue"},
    {F::spoofed, S::stop, "spoofed", "same counter, other payload: a second sender uses this id"},
    {F::no_position, S::stop, "no_position", "the board reports an unknown position"},
    {F::out_of_travel, S::stop, "out_of_travel", "a position outside the travel range"},
    {F::jump, S::stop, "jump", "a position moved faster than its axis can"},
    {F::frozen, S::stop, "frozen", "positions do not change although the board reports motion"},
    {F::not_homed, S::stop, "not_homed", "the board reports an axis without reference"},
    {F::drive_fault, S::stop, "drive_fault", "a drive reports a fault in its status word"},
    {F::stale, S::stop, "stale", "no complete snapshot within the age limit"},
    {F::loss_limit, S::stop, "loss_limit", "too many samples lost, each within the age limit"},
    {F::flood, S::stop, "flood", "more than twice the frames of a sample in one period"},
    {F::heartbeat_lost, S::stop, "heartbeat_lost", "no heartbeat of the board in time"},
    {F::heartbeat_state, S::stop, "heartbeat_state", "the board is no longer operational"},
    {F::tx_passive, S::stop, "tx_passive", "error-passive as a sender: our stop may not arrive"},
    {F::bus_off, S::stop, "bus_off", "the controller has left the bus"},
    {F::bus_restarted, S::stop, "bus_restarted", "the controller was restarted after bus-off"},
    {F::local_sender, S::stop, "local_sender", "a program on this host sends with one of our ids"},
    {F::arrival_jitter, S::stop, "arrival_jitter",
     "snapshots without SYNC arrived with more jitter than the speed bounds allow"},
    {F::bad_layout, S::stop, "bad_layout", "the CAN layout does not fit the machine"},
    {F::held_up, S::stop, "held_up", "the board's session frame counts other laps of SYNC"},
    {F::sync_period, S::stop, "sync_period",
     "the board's period is not can.sample_us to 1 percent"},
};
static_assert(sizeof kRows / sizeof kRows[0] == kReceiverFaults, "one row a fault");

constexpr bool is_in_order() noexcept {
    for (std::uint32_t i = 0; i < kReceiverFaults; ++i) {
        if (kRows[i].fault != static_cast<ReceiverFault>(i)) {
            return false;
        }
    }
    return true;
}
static_assert(is_in_order(), "rows stand in the order of the enumeration");

}  // namespace

const FaultRow& fault_row(ReceiverFault fault) noexcept {
    const auto index = static_cast<std::uint32_t>(fault);
    return kRows[index < kReceiverFaults ? index : static_cast<std::uint32_t>(F::bad_layout)];
}

const char* to_text(Severity severity) noexcept {
    switch (severity) {
        case Severity::stop:
            return "stop";
        case Severity::drop:
            return "drop";
        case Severity::ignore:
            return "ignore";
    }
    return "stop";
}

}  // namespace axg
