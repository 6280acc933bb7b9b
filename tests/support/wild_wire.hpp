// SPDX-License-Identifier: Apache-2.0
// Board and guard on one wire as ClosedLoop has them, and behind the wire, once the axes move, a
// way to the board on which frames are lost, wait for longer than permits are valid, overtake each
// other and come twice. Frames may be changed on the way, for ablations.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "hil_replay/board/closed_loop.hpp"
#include "tests/support/dice.hpp"

namespace axg::test {

/// When the board hears nothing of the guard any more.
enum class Silence : std::uint8_t {
    never,
    at_instant,      // WildFaults::silent_from_us
    at_stop,         // the first frame that says stop is lost, and all after it
    at_shorter,      // so is the first permit that is shorter than the one before
    at_lower,        // or that has a lower cap
    from_beginning,  // of motion
};

/// Shares are of frames or of pairs, each drawn by itself.
struct WildFaults {
    double lost = 0;         // of all frames, either way
    double permit_lost = 0;  // of permits, beside that
    double late = 0;         // of permits
    std::int64_t late_us_max = 0;
    double twice = 0;  // of permits: once more, later
    Silence silence = Silence::never;
    // Since the axes began to move.
    std::int64_t silent_from_us = INT64_MAX;
    std::int64_t held_from_us = INT64_MAX, held_until_us = 0;  // all in a row afterwards
};

/// In motion. Permits are those that leave for the board, by their n.
struct WildCounts {
    std::array<std::uint64_t, 16> permits{};
    std::uint64_t late = 0, twice = 0, lost = 0;
};

class WildLoop {
  public:
    using Change = std::function<void(CanFrame&)>;

    WildLoop(MotionBoard& board, const BusOptions& bus, LoopGuard guard, const WildFaults& faults)
        : board_(board),
          bus_(bus),
          guard_(std::move(guard)),
          faults_(faults),
          dice_(bus.seed + 77),
          permit_id_(bus.permit_id) {}

    Change of_board, of_guard;  // may be empty; every frame as the other one hears it
    std::function<void(const std::function<void()>& latch)> latches;  // around it; may be empty
    std::uint32_t stop_id = 1;
    WildCounts counts;

    /// One sample of the board, and every frame up to the next. False: the board can not send.
    [[nodiscard]] bool cycle() {
        std::span<const CanFrame> latched;
        const auto latch = [&] { latched = board_.latch(); };
        if (latches) {
            latches(latch);
        } else {
            latch();
        }
        for (CanFrame frame : latched) {
            change(of_board, frame);
            bus_.post(BusNode::board, frame);
        }
        const std::int64_t end_us = board_.next_latch_us();
        while (next_event(end_us)) {
        }
        guard_.on_time(end_us, sent_);
        post();
        return !latched.empty();
    }

  private:
    struct Waiting {
        std::int64_t due_us = 0;
        CanFrame frame;
    };

    static void change(const Change& by, CanFrame& frame) {
        if (by) {
            by(frame);
        }
    }
    void post() {
        for (const CanFrame& frame : sent_) {
            bus_.post(BusNode::guard, frame);
        }
        sent_.clear();
    }
    [[nodiscard]] bool is_moving() const {
        return board_.state() == BoardState::moving || board_.state() == BoardState::braking;
    }

    [[nodiscard]] std::int64_t since_us(const CanFrame& frame) const {
        return frame.time_us - board_.moving_since_us();
    }

    bool next_event(std::int64_t end_us) {
        const std::int64_t timer_us = guard_.next_due_us();
        const std::int64_t gate_us = waiting_.empty() ? INT64_MAX : waiting_.front().due_us;
        const std::int64_t due_us = std::min(timer_us, gate_us);
        CanBus::Delivery delivery;
        if (bus_.next(std::min(due_us, end_us), delivery)) {
            deliver(delivery);
            return true;
        }
        if (due_us >= end_us) {
            return false;
        }
        if (gate_us <= timer_us) {
            CanFrame frame = waiting_.front().frame;
            waiting_.erase(waiting_.begin());
            frame.time_us = gate_us;
            hand_over(frame);
        } else {
            guard_.on_time(timer_us, sent_);
            post();
        }
        return true;
    }
    void deliver(const CanBus::Delivery& delivery) {
        if (delivery.sender == BusNode::board) {
            if (!is_moving() || !dice_.chance(faults_.lost)) {
                guard_.on_frame(delivery.frame, sent_);
            }
        } else {
            CanFrame frame = delivery.frame;
            change(of_guard, frame);
            to_board(frame);
            guard_.on_echo(delivery.sent, sent_);
        }
        post();
    }
    void hand_over(const CanFrame& frame) {
        board_.on_frame(frame);
        CanFrame answer;
        if (board_.take_answer(frame.time_us, answer)) {
            bus_.post(BusNode::board, answer);
        }
    }

    void to_board(const CanFrame& frame) {
        const bool is_plain = frame.id == permit_id_, is_twin = frame.id == permit_id_ + 1;
        if (!is_moving()) {
            hand_over(frame);
            return;
        }
        note(frame);
        if (is_plain) {  // its twin follows
            is_pair_lost_ = dice_.chance(faults_.permit_lost);
            const bool is_late = dice_.chance(faults_.late);
            late_us_ = is_late ? whole(faults_.late_us_max) : 0;
            again_us_ = dice_.chance(faults_.twice) ? 1 + whole(faults_.late_us_max) : 0;
            counts.late += is_late ? 1 : 0;
            counts.twice += again_us_ > 0 ? 1 : 0;
        }
        const bool is_pair = is_plain || is_twin;
        if (is_silent_ || dice_.chance(faults_.lost) || (is_pair && is_pair_lost_)) {
            ++counts.lost;
            return;
        }
        std::int64_t due_us = frame.time_us + (is_pair ? late_us_ : 0);
        if (since_us(frame) >= faults_.held_from_us) {
            due_us = std::max(due_us, board_.moving_since_us() + faults_.held_until_us);
        }
        if (due_us == frame.time_us && waiting_.empty()) {
            hand_over(frame);
        } else {
            wait(due_us, frame);
        }
        if (is_pair && again_us_ > 0) {
            wait(due_us + again_us_, frame);
        }
    }
    /// From when on the board hears nothing.
    void note(const CanFrame& frame) {
        const bool is_plain = frame.id == permit_id_;
        const std::uint8_t n = is_plain ? frame.data[7] >> 4U : 0;
        const std::uint8_t cap = is_plain && frame.data[6] != 0 ? frame.data[5] : 250;
        const bool is_stop = frame.id == stop_id || (is_plain && n == 0);
        const Silence when = faults_.silence;
        is_silent_ = is_silent_ || when == Silence::from_beginning ||
                     (when == Silence::at_instant && since_us(frame) >= faults_.silent_from_us) ||
                     (when == Silence::at_stop && is_stop) ||
                     (when == Silence::at_shorter && (is_stop || (is_plain && n < last_n_))) ||
                     (when == Silence::at_lower && (is_stop || (is_plain && cap < last_cap_)));
        if (is_plain) {
            last_n_ = n;
            last_cap_ = cap;
            counts.permits[n] += is_silent_ ? 0 : 1;
        }
    }
    [[nodiscard]] std::int64_t whole(std::int64_t most) {
        return static_cast<std::int64_t>(dice_.in(0, static_cast<double>(most)));
    }
    void wait(std::int64_t due_us, const CanFrame& frame) {
        const auto place = std::upper_bound(
            waiting_.begin(), waiting_.end(), due_us,
            [](std::int64_t at_us, const Waiting& one) { return at_us < one.due_us; });
        waiting_.insert(place, {due_us, frame});
    }

    MotionBoard& board_;
    CanBus bus_;
    LoopGuard guard_;
    WildFaults faults_;
    Dice dice_;
    std::uint32_t permit_id_;
    std::vector<CanFrame> sent_;
    std::vector<Waiting> waiting_;
    bool is_silent_ = false, is_pair_lost_ = false;
    std::int64_t late_us_ = 0, again_us_ = 0;
    std::uint8_t last_n_ = 0, last_cap_ = 250;
};

}  // namespace axg::test
