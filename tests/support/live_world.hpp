// SPDX-License-Identifier: Apache-2.0
// A live guard between a healthy board and an engine, by a counter for time: the board's frames
// come when they would, the engine answers a stated time later, and everything can be made to fail.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "firmware_if/live_guard.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/test_wire.hpp"

namespace axg::test {

class LiveWorld {
  public:
    static constexpr std::int64_t kBeginUs = 1'000'000;  // latch of the board's first sample
    static constexpr std::int64_t kStepUs = 50;

    explicit LiveWorld(CanFormat format, LatchCell& latch_cell)
        : machine(five_axis_machine(format)),
          latch(latch_cell),
          encoder_(machine),
          second_encoder_(machine) {
        wire.now_us = kBeginUs - 5000;
        start();
    }

    // What may be made to fail.
    std::function<bool(const CanFrame&)> passes = [](const CanFrame&) { return true; };
    std::function<CycleResult(std::uint64_t)> verdict = [](std::uint64_t) {
        return CycleResult{.has_permit = true, .canary_signature = kCanarySignature};
    };
    LiveOptions options;                      // of the next start
    std::function<void()> each_step = [] {};  // what another thread would do
    bool engine_answers = true;
    std::int64_t answer_us = 200;
    bool stands_still = false;
    // Where the machine has ids for them: what the board says when it is asked for its hashes.
    std::function<bool(HashFrame&)> says_hash = [this](HashFrame& asked) {
        asked.hash = options.hashes.of[asked.part];
        return true;
    };
    bool has_second_board = false;  // the same counters, other positions
    bool is_held = false;           // the process sleeps, the world goes on

    /// A new process with what the old one has stored.
    void start() {
        queues = std::make_unique<LiveQueues>();
        pending_.clear();
        guard = std::make_unique<LiveGuard>(machine, options, wire, *queues, latch, wire.now_us);
    }

    void run_until(std::int64_t until_us) {
        for (; wire.now_us < until_us; wire.now_us += kStepUs) {
            board();
            each_step();
            if (is_held) {
                continue;
            }
            const bool has_answers = engine();
            if (has_answers || wire.has_arrivals() || wire.now_us >= guard->next_due_us()) {
                guard->turn(wire.now_us);
            }
        }
    }
    void run_periods(std::int64_t count) { run_until(wire.now_us + count * machine.can.sample_us); }
    void run_to_armed() {
        run_periods(40);
        guard->arm(wire.now_us);
    }

    /// Frames with this id that left since `from_us`.
    std::size_t count_sent(std::uint32_t id, std::int64_t from_us = 0) const {
        std::size_t count = 0;
        for (const CanFrame& frame : wire.sent) {
            count += frame.id == id && frame.time_us >= from_us ? 1U : 0U;
        }
        return count;
    }

    Machine machine;
    TestWire wire;
    LatchCell& latch;
    std::unique_ptr<LiveQueues> queues;
    std::unique_ptr<LiveGuard> guard;

  private:
    void board() {
        while (kBeginUs + sample_ * machine.can.sample_us <= wire.now_us) {
            AxisPicture picture = picture_at(machine, sample_);
            if (stands_still) {
                still_ = has_still_ ? still_ : picture.position;
                has_still_ = true;
                picture.position = still_;
                picture.mode = kModeStandstill;
            }
            for (const CanFrame& frame : frames_of(encoder_, picture)) {
                if (passes(frame)) {
                    wire.arrive(frame);
                }
            }
            answer_hashes();
            picture.position[0] += 0.01;
            for (const CanFrame& frame : frames_of(second_encoder_, picture)) {
                if (has_second_board && frame.id == machine.can.axis_ids[0]) {
                    wire.arrive(frame);
                }
            }
            ++sample_;
        }
    }
    /// The board hears each of the guard's hashes once, and says its own of that part.
    void answer_hashes() {
        for (; seen_ < wire.sent.size(); ++seen_) {
            HashFrame asked;
            if (machine.can.hashes_out_id != 0 &&
                wire.sent[seen_].id == machine.can.hashes_out_id &&
                decode_hash(wire.sent[seen_], asked) && says_hash(asked)) {
                wire.arrive(encode_hash(machine.can.hashes_in_id, asked, wire.now_us));
            }
        }
    }
    bool engine() {
        LiveQuestion question;
        while (queues->questions.pop(question)) {
            LiveAnswer made;
            made.kind = question.kind;
            made.is_passed = true;
            made.number = question.number;
            made.epoch = question.epoch;
            made.period = question.period;
            made.taken = question.number;
            if (question.kind == LiveQuestion::Kind::reset ||
                question.kind == LiveQuestion::Kind::ahead) {
                continue;
            }
            const ReceiverEvent& event = question.event;
            if (question.kind == LiveQuestion::Kind::picture) {
                made.result = verdict(event.picture.sample);
                made.result.has_permit &= event.state == ReceiverState::valid;
            }
            made.sync_counter = event.sync_counter;
            made.latched_us = event.picture.latched_us;
            made.arrived_us = event.picture.arrived_us;
            made.done_us = wire.now_us + answer_us;
            pending_.push_back(made);
        }
        bool has_answers = false;
        while (engine_answers && !pending_.empty() && pending_.front().done_us <= wire.now_us) {
            has_answers = queues->answers.push(pending_.front()) || has_answers;
            pending_.pop_front();
        }
        return has_answers;
    }

    AxisEncoder encoder_, second_encoder_;
    std::int64_t sample_ = 0;
    std::array<double, kAxesMax> still_{};
    bool has_still_ = false;
    std::deque<LiveAnswer> pending_;
    std::size_t seen_ = 0;  // of the frames sent
};

}  // namespace axg::test
