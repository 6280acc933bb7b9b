// SPDX-License-Identifier: Apache-2.0
// Decides which frames may be used, and judges complete samples.
#include "firmware_if/receiver/axis_receiver.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/assert.hpp"
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
// A look-ahead path may overtake the positions of its sample, or replace those that were lost.
constexpr int kLookAheadSamplesLate = 2, kLookAheadSamplesEarly = 10;
constexpr std::size_t kLookAheadSlot = kAxisFramesMax;

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

/// std::visit without an exception: an assembler is never without a value.
template <class Use>
auto with_assembler(Assembler& assembler, Use use) noexcept {
    if (auto* const native = std::get_if<NativeAssembler>(&assembler)) {
        return use(*native);
    }
    if (auto* const drives = std::get_if<DriveAssembler>(&assembler)) {
        return use(*drives);
    }
    auto* const signals = std::get_if<SignalAssembler>(&assembler);
    AXG_ASSERT(signals != nullptr);
    return use(*signals);
}

}  // namespace

SequenceCheck sequence_of(const CanLayout& can, std::uint16_t modulus) noexcept {
    const std::uint8_t steps = modulus < kWideCounter
                                   ? std::min(kNarrowSteps, can.counter_delta_max)
                                   : can.counter_delta_max;
    return {std::max<std::uint16_t>(2, modulus), steps, can.sync_counter_init};
}

Assembler make_assembler(const CanLayout& can, const AxisFrameSet& set) noexcept {
    switch (set.wire->mark) {
        case SampleMark::index:
            break;
        case SampleMark::sync:
            return DriveAssembler{can, set};
        case SampleMark::arrival:
            return SignalAssembler{can};
    }
    return NativeAssembler{can, set};
}

PeriodTerms sync_terms(const Machine& machine) noexcept {
    const CanLayout& can = machine.can;
    const std::int64_t period_us = can.sample_us;
    const std::int64_t numbered_us =
        can.arrival_jitter_us != 0 ? can.arrival_jitter_us : (1 + kNumbersOff) * period_us;
    const std::int64_t late_us = has_sync(wire_of(can)) ? period_us : numbered_us;
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
    : set_(make_frame_set(machine)),
      check_(machine, set_, options.takes_jumps),
      assembler_(make_assembler(machine.can, set_)) {
    const CanLayout& can = machine.can;
    const bool measures = measures_period(can);
    rules_ = {.stale_after_us = can.stale_after_us,
              .init_snapshots = std::max<std::uint8_t>(1, can.sync_counter_init),
              .refuse_local = options.refuse_local,
              .needs_period = measures && options.period == PeriodUse::proven};
    const bool has_path = set_.look_ahead_samples != 0;
    ids_ = {has_sync(*set_.wire) ? set_.sync_id : kNoIndex,
            is_native(*set_.wire) ? set_.heartbeat_id : kNoIndex,
            set_.session_id != 0 ? set_.session_id : kNoIndex,
            has_path ? set_.look_ahead_id : kNoIndex};
    for (std::uint32_t i = 0; i < set_.frame_count; ++i) {
        last_frames_[i].sequence = sequence_of(can, set_.counter_modulus[i]);
    }
    last_frames_[kLookAheadSlot].sequence = sequence_of(can, 256);
    session_.frame.sequence = sequence_of(can, 16);
    heartbeat_ = {.is_awaited = is_native(*set_.wire), .timeout_us = can.heartbeat_timeout_us};
    flood_.period_us = set_.sample_us;
    flood_.set_frames = set_.frame_count + (has_path ? 1U : 0U);
    samples_.axis_count = set_.axis_count;
    samples_.period_us = set_.sample_us;
    samples_.set.whole = (std::uint64_t{1} << set_.frame_count) - 1U;
    samples_.judges_period = measures && options.period != PeriodUse::ignored;
    samples_.by_sync.watch.terms = sync_terms(machine);
    samples_.by_sender.watch.terms = sender_terms(machine);
    samples_.by_sender.is_needed = set_.wire->has_sender_clock;
    acknowledge();
}

void AxisReceiver::acknowledge() noexcept {
    const bool is_fit = set_.axis_count != 0;
    state_ = is_fit ? ReceiverState::init : ReceiverState::invalid;
    stop_cause_ = is_fit ? ReceiverFault::none : ReceiverFault::bad_layout;
    heartbeat_.is_operational = false;
    losses_.level = 0;
    flood_.begin_us = INT64_MIN;
    forget();
}

/// Clears all references: the next frames count as the first ones.
void AxisReceiver::forget() noexcept {
    for (LastFrame& frame : last_frames_) {
        frame.sequence.reset();
    }
    session_.forget();
    check_.reset();
    samples_.forget();
    with_assembler(assembler_, [](auto& assembler) { assembler.forget(); });
    losses_.good_in_row = 0;
}

ReceiverEvent AxisReceiver::event() const noexcept {
    ReceiverEvent event;
    event.state = state_;
    event.time_us = samples_.now_us;
    return event;
}

ReceiverEvent AxisReceiver::fault(ReceiverFault kind, std::uint32_t frame_id,
                                  std::uint32_t axis) noexcept {
    if (kind == ReceiverFault::none) {
        return event();
    }
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

void AxisReceiver::advance_clock(std::int64_t time_us) noexcept {
    if (time_us < samples_.now_us) {
        ++counters_.clock_steps;  // never backwards: an age may only grow
        return;
    }
    samples_.now_us = time_us;
}

ReceiverEvent AxisReceiver::check_clock() noexcept {
    const LastSample& last = samples_.last;
    const bool is_stale =
        last.is_known && samples_.now_us - last.latched_us > rules_.stale_after_us;
    if (state_ == ReceiverState::valid) {
        if (is_stale) {
            return fault(ReceiverFault::stale);
        }
        if (!heartbeat_.is_fresh(samples_.now_us)) {
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
    const auto row = std::find(ids_.begin(), ids_.end(), low_bits) - ids_.begin();
    const Kind kind = is_axis ? Kind::none : static_cast<Kind>(row);
    if (!is_axis && !is_like_axis && kind == Kind::none) {
        ++counters_.foreign;
        return event();
    }
    if (is_other) {
        return fault(ReceiverFault::extended_id, frame.id);
    }
    if (frame.remote) {
        return fault(ReceiverFault::remote_frame, frame.id);
    }
    if (frame.sent_by_host && rules_.refuse_local) {
        return fault(ReceiverFault::local_sender, frame.id);
    }
    switch (kind) {
        case Kind::sync:
            return conclude(
                with_assembler(assembler_, [&](auto& to) { return to.on_sync(frame, samples_); }),
                frame.id);
        case Kind::heartbeat:
            return on_heartbeat(frame);
        case Kind::session:
            return on_session_frame(frame);
        case Kind::look_ahead:
        case Kind::none:
            break;
    }
    if (flood_.is_flood(samples_.now_us)) {
        return fault(ReceiverFault::flood, frame.id);
    }
    return kind == Kind::look_ahead ? on_look_ahead_frame(frame) : on_axis_frame(frame, slot);
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
                losses_.level > kLossLimit ? ReceiverFault::loss_limit : ReceiverFault::rx_overflow,
                frame.id);
        }
        if ((frame.data[1] & kControllerRxPassive) != 0) {
            return fault(ReceiverFault::rx_passive, frame.id);
        }
    }
    return fault(ReceiverFault::error_frame, frame.id);
}

ReceiverEvent AxisReceiver::on_heartbeat(const CanFrame& frame) noexcept {
    const ReceiverFault shape = shape_of(frame, 1);
    if (shape != ReceiverFault::none) {
        return fault(shape, frame.id);
    }
    const std::uint8_t node_state = frame.data[0];
    if (node_state == kHeartbeatOperational) {
        heartbeat_.is_operational = true;
        heartbeat_.time_us = samples_.now_us;
        return event();
    }
    const bool is_known = node_state == 0 || node_state == 4 || node_state == 127;
    if (!is_known) {
        return fault(ReceiverFault::bad_format, frame.id);
    }
    heartbeat_.is_operational = false;
    return state_ == ReceiverState::valid ? fault(ReceiverFault::heartbeat_state, frame.id)
                                          : event();
}

ReceiverEvent AxisReceiver::on_session_frame(const CanFrame& frame) noexcept {
    Session session;
    const FrameStatus status = decode_session(set_.session_id, frame, session);
    return fault(status != FrameStatus::ok ? fault_of(status)
                                           : session_.on_session(frame, session, samples_),
                 frame.id);
}

/// Counts samples as in the snapshots, so it needs a snapshot first. A frame may arrive before or
/// after the positions of its sample.
ReceiverEvent AxisReceiver::on_look_ahead_frame(const CanFrame& frame) noexcept {
    LookAheadFrameContent content;
    const FrameStatus status = decode_look_ahead_frame(set_, frame, content);
    if (status != FrameStatus::ok) {
        return fault(fault_of(status), frame.id);
    }
    const ReceiverFault wrong = last_frames_[kLookAheadSlot].judge(frame, content.counter);
    if (wrong != ReceiverFault::none || !samples_.last.is_known) {
        return fault(wrong, frame.id);
    }
    const int modulus = set_.wire->index_modulus;
    int off = (content.sync_counter - 1 - samples_.last.index + modulus) % modulus;
    off -= off > modulus / 2 ? modulus : 0;
    if (off < -kLookAheadSamplesLate || off > kLookAheadSamplesEarly) {
        return fault(ReceiverFault::late_sample, frame.id);
    }
    ReceiverEvent event = this->event();
    event.kind = ReceiverEvent::Kind::look_ahead;
    event.look_ahead.sample =
        samples_.last.sample + content.samples + static_cast<std::uint64_t>(off);
    event.look_ahead.position = content.position;
    event.look_ahead.before = content.before;
    ++counters_.look_ahead;
    return event;
}

ReceiverEvent AxisReceiver::on_axis_frame(const CanFrame& frame, std::uint32_t slot) noexcept {
    AxisFrameContent content;
    const FrameStatus status = decode_axis_frame(set_, slot, frame, content);
    if (status != FrameStatus::ok) {
        return fault(fault_of(status), frame.id);
    }
    LastFrame& last = last_frames_[slot];
    if (set_.counter_modulus[slot] != 0) {
        const ReceiverFault wrong = last.judge(frame, content.counter);
        if (wrong != ReceiverFault::none) {
            return fault(wrong, frame.id);
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
    const AxisFrame axis{frame, content, slot, last};
    return conclude(
        with_assembler(assembler_, [&](auto& to) { return to.on_axis(axis, samples_); }), frame.id);
}

ReceiverEvent AxisReceiver::conclude(const Assembly& assembly, std::uint32_t frame_id) noexcept {
    counters_.measured_period_ns = samples_.measured_period_ns;
    counters_.estimated += assembly.is_estimated ? 1 : 0;
    if (assembly.begins_period) {
        flood_.begin(samples_.now_us);
    }
    if (assembly.fault == ReceiverFault::none && assembly.latch) {
        return deliver(*assembly.latch, assembly.steps, frame_id);
    }
    return fault(assembly.fault, frame_id);
}

ReceiverEvent AxisReceiver::deliver(const Latch& latch, std::uint32_t steps,
                                    std::uint32_t frame_id) noexcept {
    AxisSnapshot& snapshot = samples_.set.snapshot;
    LastSample& last = samples_.last;
    const std::int64_t age_us = samples_.now_us - latch.time_us;
    if (age_us > rules_.stale_after_us) {
        return fault(ReceiverFault::too_old, frame_id);
    }
    const SnapshotFault wrong = check_.check(snapshot, samples_.set.raw, steps);
    if (wrong.fault != ReceiverFault::none) {
        return fault(wrong.fault, frame_id, wrong.axis);
    }
    const std::uint32_t lost = last.is_known ? steps - 1 : 0;
    if (lost != 0) {
        losses_.good_in_row = 0;
        count_loss(lost);
    }
    losses_.level -= losses_.level > 0 ? 1 : 0;
    if (losses_.level > kLossLimit) {
        return fault(ReceiverFault::loss_limit, frame_id);
    }
    counters_.late += age_us > set_.sample_us ? 1 : 0;
    if (last.is_known) {
        last.sample += steps;
    } else if (last.has_history) {  // after an acknowledge: by the clock, at least one
        const std::int64_t gap_us = latch.time_us - last.latched_us;
        last.sample +=
            static_cast<std::uint64_t>(std::max<std::int64_t>(1, gap_us / set_.sample_us));
    }
    session_.number(latch.sync_counter, last);
    last.is_known = last.has_history = true;
    last.index = samples_.set.index;
    last.sync_counter = latch.sync_counter;
    last.latched_us = latch.time_us;
    last.base_us = latch.base_us;
    samples_.steps = 0;
    snapshot.latched_us = latch.time_us;
    snapshot.arrived_us = samples_.now_us;
    snapshot.sample = last.sample;
    ++counters_.snapshots;
    losses_.good_in_row = static_cast<std::uint8_t>(std::min(losses_.good_in_row + 1, 255));
    if (state_ == ReceiverState::init && losses_.good_in_row >= rules_.init_snapshots &&
        heartbeat_.is_fresh(samples_.now_us) && is_period_shown()) {
        state_ = ReceiverState::valid;
    }
    ReceiverEvent event = this->event();
    event.kind = ReceiverEvent::Kind::snapshot;
    event.sync_counter = latch.sync_counter;
    event.samples_lost = lost;
    event.snapshot = snapshot;
    return event;
}

void AxisReceiver::count_loss(std::uint32_t lost) noexcept {
    counters_.samples_lost += lost;
    losses_.level += kLossWeight * std::min<std::uint32_t>(lost, kLossLimit);
}

}  // namespace axg
