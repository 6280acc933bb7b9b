// SPDX-License-Identifier: Apache-2.0
// Decides which frames may be used. Their assembly to one snapshot: axis_assembly.cpp.
#include "firmware_if/receiver/axis_receiver.hpp"

#include <algorithm>
#include <cmath>

#include "core/machine/can_id.hpp"

namespace axg {
namespace {

// Values of linux/can/error.h: the id contains the classes, data[1] the details.
constexpr std::uint32_t kErrorController = 0x004, kErrorBusOff = 0x040, kErrorRestarted = 0x100;
constexpr std::uint8_t kControllerRxOverflow = 0x01, kControllerRxPassive = 0x10,
                       kControllerTxPassive = 0x20;

// With a smaller modulus, half of all older counter values would count as lost frames.
constexpr std::uint16_t kWideCounter = 14;
constexpr std::uint8_t kNarrowSteps = 3;

// At least one of so many SYNCs in a row is late by no more than a period.
constexpr std::uint32_t kSyncUnit = 8;
// Without a stated jitter two samples may be numbered so many periods short (arrival_anchor.hpp).
constexpr std::int64_t kNumbersOff = 2;

std::int64_t latch_jitter_us(const Machine& machine) noexcept {
    return std::lround(std::ceil(machine.guard.latch_jitter_s * 1e6));
}

/// A sender's clock that is read at the latch proves the period within its jitter. One that is read
/// later refutes nothing while rule 6 tolerates it.
PeriodTerms sender_terms(const Machine& machine) noexcept {
    const std::int64_t period_us = machine.can.sample_us;
    const std::int64_t off_us = latch_jitter_us(machine) + 1;
    return {.period_us = period_us, .right_us = off_us, .wrong_us = off_us + period_us / 5};
}

/// @param modulus  of the counter; 0: the frame has none
SequenceCheck sequence_of(const CanLayout& can, std::uint16_t modulus) noexcept {
    const std::uint8_t steps = modulus < kWideCounter
                                   ? std::min(kNarrowSteps, can.counter_delta_max)
                                   : can.counter_delta_max;
    return {std::max<std::uint16_t>(2, modulus), steps, can.sync_counter_init};
}

}  // namespace

ReceiverFault fault_of(FrameStatus status) noexcept {
    switch (status) {
        case FrameStatus::ok:
            return ReceiverFault::none;
        case FrameStatus::bad_length:
            return ReceiverFault::bad_length;
        case FrameStatus::raw_dlc:
            return ReceiverFault::raw_dlc;
        case FrameStatus::bad_crc:
            return ReceiverFault::bad_crc;
        case FrameStatus::not_ours:
        case FrameStatus::bad_format:
            return ReceiverFault::bad_format;
    }
    return ReceiverFault::bad_format;
}

PeriodTerms sync_terms(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    const std::int64_t period_us = can.sample_us;
    const std::int64_t numbered_us =
        can.arrival_jitter_us != 0 ? can.arrival_jitter_us : (1 + kNumbersOff) * period_us;
    const std::int64_t late_us = can.format == CanFormat::signals ? numbered_us : period_us;
    const std::int64_t off_us = late_us + latch_jitter_us(machine) + 1;
    return {.period_us = period_us, .right_us = off_us, .wrong_us = off_us, .unit = kSyncUnit};
}

bool measures_period(const CanLayout& can) noexcept {
    return !can.guard_sends_sync;
}

std::string_view unmeasured_period(const CanLayout& can) noexcept {
    return measures_period(can) ? ""
                                : "can.sample_us: with can.sync: guard no frame shows in which "
                                  "period the drives latch; expected: at each SYNC";
}

const char* to_text(ReceiverState state) noexcept {
    switch (state) {
        case ReceiverState::invalid:
            return "INVALID";
        case ReceiverState::init:
            return "INIT";
        case ReceiverState::valid:
            return "VALID";
    }
    return "INVALID";
}

ReceiverCounters operator+(ReceiverCounters a, const ReceiverCounters& b) noexcept {
    a.frames += b.frames;
    a.foreign += b.foreign;
    a.snapshots += b.snapshots;
    a.look_ahead += b.look_ahead;
    a.late += b.late;
    a.samples_lost += b.samples_lost;
    a.estimated += b.estimated;
    a.clock_steps += b.clock_steps;
    a.ignored_invalid += b.ignored_invalid;
    a.measured_period_ns = b.measured_period_ns != 0 ? b.measured_period_ns : a.measured_period_ns;
    for (std::size_t i = 0; i < a.faults.size(); ++i) {
        a.faults[i] += b.faults[i];
    }
    return a;
}

AxisReceiver::AxisReceiver(const Machine& machine, ReceiverOptions options) noexcept
    : set_(make_frame_set(machine)), check_(machine, set_, options.takes_jumps), options_(options) {
    const CanLayout& can = machine.can;
    for (std::uint32_t i = 0; i < set_.frame_count; ++i) {
        slots_[i].sequence = sequence_of(can, set_.counter_modulus[i]);
    }
    look_ahead_slot_.sequence = sequence_of(can, 256);
    session_slot_.sequence = sequence_of(can, 16);
    sync_sequence_ = sequence_of(can, set_.sync_counter_max);
    init_snapshots_ = std::max<std::uint8_t>(1, can.sync_counter_init);
    stale_after_us_ = can.stale_after_us;
    heartbeat_timeout_us_ = can.heartbeat_timeout_us;
    index_modulus_ = can.format == CanFormat::fd ? kSyncCounterMax : 16;
    sync_window_us_ = can.sync_window_us != 0 ? can.sync_window_us : can.sample_us;
    sync_period_.terms = sync_terms(machine);
    sender_period_.terms = sender_terms(machine);
    measures_period_ = measures_period(can);
    arrivals_.period_us = can.sample_us;
    arrivals_.jitter_us = can.arrival_jitter_us != 0
                              ? can.arrival_jitter_us
                              : static_cast<std::int64_t>(kArrivalJitterShareMax * can.sample_us);
    acknowledge();
}

void AxisReceiver::acknowledge() noexcept {
    const bool is_fit = set_.axis_count != 0;
    state_ = is_fit ? ReceiverState::init : ReceiverState::invalid;
    stop_cause_ = is_fit ? ReceiverFault::none : ReceiverFault::bad_layout;
    has_heartbeat_ = false;
    loss_level_ = 0;
    window_us_ = INT64_MIN;
    forget();
}

/// Clears all references: the next frames count as the first ones.
void AxisReceiver::forget() noexcept {
    for (Slot& slot : slots_) {
        slot.sequence.reset();
    }
    look_ahead_slot_.sequence.reset();
    session_slot_.sequence.reset();
    session_ = {};
    sync_sequence_.reset();
    sync_stamps_.fill({});
    last_sync_ = {};
    check_.reset();
    seen_ = 0;
    drives_ = {};
    arrivals_.has_sample = false;
    arrival_steps_ = 0;
    restart(sync_period_);
    restart(sender_period_);
    shows_sync_period_ = shows_sender_period_ = false;
    has_last_ = has_sender_ = false;
    good_in_row_ = estimates_ = 0;
}

ReceiverEvent AxisReceiver::event() const noexcept {
    ReceiverEvent event;
    event.state = state_;
    event.time_us = now_us_;
    return event;
}

ReceiverEvent AxisReceiver::fault(ReceiverFault kind, std::uint32_t frame_id,
                                  std::uint32_t axis) noexcept {
    const FaultRow& row = fault_row(kind);
    ++counters_.faults[static_cast<std::size_t>(row.fault)];
    if (row.severity == Severity::stop) {
        state_ = ReceiverState::invalid;
        stop_cause_ = row.fault;
    }
    ReceiverEvent event = this->event();
    event.kind = ReceiverEvent::Kind::fault;
    event.fault = row.fault;
    event.severity = row.severity;
    event.frame_id = frame_id;
    event.axis = axis;
    return event;
}

/// Also stores that the period was shown to be right.
bool AxisReceiver::is_period_wrong(PeriodWatch& watch, std::int64_t steps,
                                   std::int64_t stamp_us) noexcept {
    if (options_.period == PeriodUse::ignored || !measures_period_) {
        return false;
    }
    const PeriodVerdict verdict = judge_stamp(watch, steps, stamp_us);
    if (verdict != PeriodVerdict::unknown) {
        counters_.measured_period_ns = watch.measured_ns;
    }
    bool& is_shown = &watch == &sender_period_ ? shows_sender_period_ : shows_sync_period_;
    is_shown = is_shown || verdict == PeriodVerdict::right;
    return verdict == PeriodVerdict::wrong;
}

void AxisReceiver::advance_clock(std::int64_t time_us) noexcept {
    if (time_us < now_us_) {
        ++counters_.clock_steps;  // never backwards: an age may only grow
        return;
    }
    now_us_ = time_us;
}

bool AxisReceiver::is_heartbeat_fresh() const noexcept {
    return !is_native() || (has_heartbeat_ && now_us_ - heartbeat_us_ <= heartbeat_timeout_us_);
}

ReceiverEvent AxisReceiver::check_clock() noexcept {
    const bool is_stale = has_last_ && now_us_ - last_latched_us_ > stale_after_us_;
    if (state_ == ReceiverState::valid) {
        if (is_stale) {
            return fault(ReceiverFault::stale);
        }
        if (!is_heartbeat_fresh()) {
            return fault(ReceiverFault::heartbeat_lost);
        }
    } else if (state_ == ReceiverState::init && is_stale) {
        forget();  // nothing was permitted yet: the board may have started again
    }
    return event();
}

ReceiverEvent AxisReceiver::on_time(std::int64_t now_us) noexcept {
    advance_clock(now_us);
    return check_clock();
}

ReceiverEvent AxisReceiver::on_frame(const CanFrame& frame) noexcept {
    ++counters_.frames;
    advance_clock(frame.time_us);
    const ReceiverEvent clock = check_clock();
    if (clock.kind != ReceiverEvent::Kind::none) {
        return clock;
    }
    if (state_ == ReceiverState::invalid) {
        ++counters_.ignored_invalid;
        return event();
    }
    if (frame.error) {
        return on_error_frame(frame);
    }
    const std::uint32_t slot = slot_of(set_, frame);
    const bool is_axis = slot < set_.frame_count;
    // Only axis frames may have ids of 29 bits; the sender of another one with our low bits may
    // have meant ours.
    const std::uint32_t low_bits = frame.id & kStandardIdMax;
    const bool is_other = !is_axis && (frame.extended || frame.id != low_bits);
    const auto axes_end = set_.ids.begin() + set_.frame_count;
    const bool is_like_axis =
        is_other && std::find(set_.ids.begin(), axes_end, low_bits) != axes_end;
    const auto is_low = [&](bool is_used, std::uint32_t id) {
        return !is_axis && is_used && low_bits == id;
    };
    const bool is_sync = is_low(set_.format != CanFormat::signals, set_.sync_id);
    const bool is_heartbeat = is_low(is_native(), set_.heartbeat_id);
    const bool is_look_ahead = is_low(set_.look_ahead_samples != 0, set_.look_ahead_id);
    const bool is_session = is_low(set_.session_id != 0, set_.session_id);
    if (!is_axis && !is_like_axis && !is_sync && !is_heartbeat && !is_look_ahead && !is_session) {
        ++counters_.foreign;
        return event();
    }
    if (is_other) {
        return fault(ReceiverFault::extended_id, frame.id);
    }
    if (frame.remote) {
        return fault(ReceiverFault::remote_frame, frame.id);
    }
    if (frame.sent_by_host && options_.refuse_local) {
        return fault(ReceiverFault::local_sender, frame.id);
    }
    if (is_sync) {
        return is_native() ? on_sync(frame) : on_drive_sync(frame);
    }
    if (is_heartbeat) {
        return on_heartbeat(frame);
    }
    if (is_session) {
        return on_session_frame(frame);
    }
    // More than twice a set of our frames in one period: another node sends them too.
    if (is_flood()) {
        return fault(ReceiverFault::flood, frame.id);
    }
    return is_look_ahead ? on_look_ahead_frame(frame) : on_axis_frame(frame, slot);
}

ReceiverEvent AxisReceiver::on_error_frame(const CanFrame& frame) noexcept {
    if ((frame.id & kErrorBusOff) != 0) {
        return fault(ReceiverFault::bus_off, frame.id);
    }
    if ((frame.id & kErrorRestarted) != 0) {
        return fault(ReceiverFault::bus_restarted, frame.id);
    }
    if ((frame.id & kErrorController) != 0) {
        if ((frame.data[1] & kControllerTxPassive) != 0) {
            return fault(ReceiverFault::tx_passive, frame.id);
        }
        if ((frame.data[1] & kControllerRxOverflow) != 0) {
            count_loss(1);
            return fault(
                loss_level_ > kLossLimit ? ReceiverFault::loss_limit : ReceiverFault::rx_overflow,
                frame.id);
        }
        if ((frame.data[1] & kControllerRxPassive) != 0) {
            return fault(ReceiverFault::rx_passive, frame.id);
        }
    }
    return fault(ReceiverFault::error_frame, frame.id);
}

/// The period starts anew with each SYNC, or by itself without SYNC.
bool AxisReceiver::is_flood() noexcept {
    if (window_us_ == INT64_MIN || now_us_ - window_us_ >= set_.sample_us) {
        window_us_ = now_us_;
        window_frames_ = 0;
    }
    const std::uint32_t set_frames = set_.frame_count + (set_.look_ahead_samples != 0 ? 1U : 0U);
    return ++window_frames_ > 2 * set_frames;
}

/// No event: the frame may be used.
ReceiverEvent AxisReceiver::check_counter(const CanFrame& frame, std::uint8_t counter,
                                          Slot& known) noexcept {
    if (known.sequence.is_repeat(counter)) {
        const auto* end = frame.data.data() + frame.length_bytes;
        const bool is_same = std::equal(frame.data.data(), end, known.payload.data());
        return fault(is_same ? ReceiverFault::repeated : ReceiverFault::spoofed, frame.id);
    }
    if (known.sequence.next(counter) == Sequence::wrong) {
        return fault(ReceiverFault::wrong_sequence, frame.id);
    }
    known.payload = frame.data;
    return event();
}

ReceiverEvent AxisReceiver::on_axis_frame(const CanFrame& frame, std::uint32_t slot) noexcept {
    AxisFrameContent content;
    const FrameStatus status = decode_axis_frame(set_, slot, frame, content);
    if (status != FrameStatus::ok) {
        return fault(fault_of(status), frame.id);
    }
    if (set_.counter_modulus[slot] != 0) {
        const ReceiverEvent counted = check_counter(frame, content.counter, slots_[slot]);
        if (counted.kind != ReceiverEvent::Kind::none) {
            return counted;
        }
    }
    for (std::uint32_t i = 0; i < content.value_count; ++i) {
        if (!content.values[i].known) {
            return fault(ReceiverFault::no_position, frame.id, content.values[i].axis);
        }
    }
    if (content.drive_in_fault != kNoIndex) {
        return fault(ReceiverFault::drive_fault, frame.id, content.drive_in_fault);
    }
    if (set_.format == CanFormat::cia402) {
        return assemble_drives(content, slot, frame);
    }
    return is_native() ? assemble(content, slot, frame.id)
                       : assemble_signals(content, slot, frame.id);
}

void AxisReceiver::count_loss(std::uint32_t lost) noexcept {
    counters_.samples_lost += lost;
    loss_level_ += kLossWeight * std::min<std::uint32_t>(lost, kLossLimit);
}

}  // namespace axg
