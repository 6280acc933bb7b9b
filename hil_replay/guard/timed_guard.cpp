// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/guard/timed_guard.hpp"

#include <algorithm>

#include "firmware_if/protocol/handshake.hpp"

namespace axg {

TimedGuard::TimedGuard(const LiveEngine& live, const TimedGuardOptions& options,
                       std::int64_t now_us)
    : live_(live), options_(options), now_us_(now_us) {
    options_.guard.supposes_arming = true;
    options_.guard.ignores_period = true;
    set_latch(latch_, false);
    start();
}

void TimedGuard::start() {
    guard_.emplace(live_.machine, options_.guard, wire_, queues_, latch_, now_us_);
    has_query_ = true;  // the self-test
    turn(now_us_);
}

void TimedGuard::restart(std::int64_t now_us) {
    now_us_ = std::max(now_us_, now_us);
    LiveQuery query;
    while (queues_.queries.pop(query)) {
    }
    LiveResult result;
    while (queues_.results.pop(result)) {
    }
    has_result_ = was_armed_ = false;
    set_latch(latch_, false);
    start();
}

/// The guard shifts its period towards the board's, which may set its due time in the past: it is
/// then due now.
std::int64_t TimedGuard::next_due_us() const noexcept {
    return std::max(now_us_,
                    std::min(guard_->next_due_us(), has_result_ ? result_.done_us : INT64_MAX));
}

void TimedGuard::run_before(std::int64_t until_us) {
    while (next_due_us() < until_us) {
        turn(next_due_us());
    }
}

void TimedGuard::hear_result() {
    if (has_result_) {
        run_before(result_.done_us + 1);
    }
}

void TimedGuard::arrive(const CanArrival& arrival) {
    run_before(arrival.frame.time_us);
    // The guard reads each arrival at once, so the queue has space.
    [[maybe_unused]] const bool is_taken = wire_.arrive(arrival);
    turn(arrival.frame.time_us);
}

void TimedGuard::turn(std::int64_t now_us) {
    now_us_ = std::max(now_us_, now_us);
    for (bool again = true; again;) {
        const bool has_cycle = has_result_ && result_.done_us <= now_us_;
        if (has_cycle) {
            has_result_ = false;
            // The guard removes all results in the turn below.
            [[maybe_unused]] const bool is_pushed = queues_.results.push(result_);
        }
        const std::uint64_t permits = guard_->counters().permits;
        guard_->turn(now_us_);
        has_query_ = has_query_ || guard_->has_submitted();
        if (has_cycle && options_.each) {
            options_.each({.result = result_,
                           .spent_ns = spent_ns_,
                           .sent_permit = guard_->counters().permits != permits});
        }
        arm();
        again = take_frames();
        if (has_query_ && !has_result_) {
            evaluate();
            again = true;
        }
        again = again || (has_result_ && result_.done_us <= now_us_);
    }
}

/// A self-test needs no time; the engine evaluates only the newest of the waiting snapshots.
void TimedGuard::evaluate() {
    has_query_ = false;
    const std::int64_t start_ns = live_.clock.now();
    run_queries(live_, queues_, [this, start_ns](const LiveResult& made) {
        if (made.kind == LiveQuery::Kind::self_test) {
            LiveResult dated = made;
            dated.done_us = now_us_;
            [[maybe_unused]] const bool is_pushed = queues_.results.push(dated);
            return;
        }
        spent_ns_ = live_.clock.now() - start_ns;
        result_ = made;
        result_.done_us = now_us_ + (options_.response_us ? options_.response_us(spent_ns_) : 0);
        has_result_ = true;
        if (options_.evaluated) {
            options_.evaluated(spent_ns_);
        }
    });
}

/// True: one of them was echoed, or a reply arrived.
bool TimedGuard::take_frames() {
    LiveNote note;
    while (queues_.notes.pop(note)) {
        if (options_.noted) {
            options_.noted(note);
        }
    }
    bool has_arrival = false;
    CanFrame frame;
    while (wire_.take(frame)) {
        frame.time_us = now_us_;
        if (options_.sent) {
            options_.sent(frame);
        }
        has_arrival = agree(frame) || has_arrival;
        has_arrival =
            (options_.echoes && wire_.arrive({.frame = frame, .is_own = true})) || has_arrival;
    }
    return has_arrival;
}

/// Replies for a board without hashes in a trace: returns the guard's own hash.
bool TimedGuard::agree(const CanFrame& frame) {
    const CanLayout& can = live_.machine.can;
    HashFrame hash;
    return options_.answers_hashes && can.hashes_out_id != 0 && frame.id == can.hashes_out_id &&
           decode_hash(frame, hash) &&
           wire_.arrive({.frame = encode_hash(can.hashes_in_id, hash, now_us_)});
}

void TimedGuard::arm() {
    if (guard_->may_arm(now_us_) && now_us_ >= options_.arm_from_us) {
        guard_->arm(now_us_);
        was_armed_ = true;
    }
}

}  // namespace axg
