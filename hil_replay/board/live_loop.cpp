// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/board/live_loop.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "core/machine/can_id.hpp"

namespace axg {

namespace {

constexpr std::uint32_t kDrainFramesMax = 100'000;  // more than a socket's queue holds

}  // namespace

LiveLoop::LiveLoop(const Machine& machine, MotionBoard& board, CanTransport& wire, LiveClock clock)
    : can_(machine.can),
      set_(make_frame_set(machine)),
      board_(board),
      wire_(wire),
      clock_(std::move(clock)) {
    CanArrival old;
    for (std::uint32_t i = 0; i < kDrainFramesMax && wire_.read(old) == ReadStatus::frame; ++i) {
    }
    latched_us_ = board_.next_latch_us() - kListenUs;
    later_us_ = clock_.now_us() - latched_us_;
}

bool LiveLoop::listen() {
    hear_until_latch();
    return report_.other_board_id == 0;
}

bool LiveLoop::cycle() {
    hear_until_latch();
    // A board that waits has no motion to stop. Its guard may have been stopped before, and can
    // only be reset while a board reports standstill.
    if (board_.state() == BoardState::waiting && board_.permits().stopped_us() != kNever) {
        board_.acknowledge_stop();
    }
    latched_us_ = board_.next_latch_us();
    const std::span<const CanFrame> latched = board_.latch();
    for (const CanFrame& frame : latched) {
        send(frame);
    }
    const std::int64_t late_us = board_now_us() - latched_us_;
    report_.late_us_max = std::max(report_.late_us_max, late_us);
    report_.late_periods += 2 * late_us > std::int64_t{can_.sample_us} ? 1U : 0U;
    hear_until_latch();
    return !latched.empty();
}

void LiveLoop::hear_until_latch() {
    const std::int64_t until_us = board_.next_latch_us() + later_us_;
    while (clock_.now_us() < until_us) {
        clock_.wait(until_us);
        drain();
    }
    drain();
}

void LiveLoop::drain() {
    CanArrival arrival;
    for (std::uint32_t i = 0; i < kDrainFramesMax; ++i) {
        const ReadStatus status = wire_.read(arrival);
        if (status == ReadStatus::frame) {
            on_arrival(arrival);
            continue;
        }
        report_.is_lost =
            report_.is_lost || status == ReadStatus::down || status == ReadStatus::gone;
        return;
    }
}

bool LiveLoop::is_of_a_board(const CanFrame& frame) const noexcept {
    const auto end = set_.ids.begin() + set_.frame_count;
    const bool is_axis = std::any_of(set_.ids.begin(), end, [&](std::uint32_t id) {
        return is_id_of(id, frame.id, frame.extended);
    });
    if (is_axis || frame.extended) {
        return is_axis;
    }
    return (has_sync(*set_.wire) && (frame.id == set_.sync_id || frame.id == set_.heartbeat_id)) ||
           (set_.look_ahead_samples != 0 && frame.id == set_.look_ahead_id) ||
           (set_.session_id != 0 && frame.id == set_.session_id) ||
           (can_.hashes_out_id != 0 && frame.id == can_.hashes_in_id);
}

void LiveLoop::on_arrival(const CanArrival& arrival) {
    CanFrame frame = arrival.frame;
    if (arrival.is_own || frame.error) {
        return;
    }
    if (is_of_a_board(frame)) {
        report_.other_board_id = frame.id;
        return;
    }
    if (frame.extended) {
        return;
    }
    Emergency emergency;
    if (decode_emergency(can_, frame, emergency) == GuardFrameStatus::ok &&
        emergency.code != EmergencyCode::reset) {
        report_.emergency = emergency;
    }
    // The axes have already moved to the last sample: no frame may have an earlier time.
    frame.time_us = std::max(frame.time_us - later_us_, latched_us_);
    board_.on_frame(frame);
    CanFrame answer;
    if (board_.take_answer(frame.time_us, answer)) {
        send(answer);
    }
}

void LiveLoop::send(const CanFrame& frame) {
    const SendStatus status = wire_.send(frame);
    report_.frames_refused += status == SendStatus::ok ? 0U : 1U;
    report_.is_lost = report_.is_lost || status == SendStatus::down || status == SendStatus::gone;
}

}  // namespace axg
