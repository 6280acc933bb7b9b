// SPDX-License-Identifier: Apache-2.0
// A live guard between a healthy board and an engine, by a counter for time: the board's frames
// come when they would, the engine answers a stated time later, and everything can be made to fail.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "firmware_if/guard/guard_node.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/session_frame.hpp"
#include "tests/support/test_wire.hpp"

namespace axg::test {

class LiveWorld {
  public:
    static constexpr std::int64_t kBeginUs = 1'000'000;  // latch of the board's first sample
    static constexpr std::int64_t kStepUs = 50;

    static constexpr std::int64_t kStandPeriods = 150;  // of rest, and every board stands

    LiveWorld(CanFormat format, LatchCell& latch_cell)
        : LiveWorld(five_axis_machine(format), latch_cell) {}
    LiveWorld(const Machine& made, LatchCell& latch_cell)
        : machine(made), latch(latch_cell), encoder_(machine, {.says_session = false}) {
        wire.now_us = kBeginUs - 5000;
        start();
    }

    // What may be made to fail.
    std::function<void(AxisSnapshot&)> says = [](AxisSnapshot&) {};  // the board, of a sample
    // The frames of a sample on their way, and of what is left each by itself.
    std::function<void(std::vector<CanFrame>&)> alters = [](std::vector<CanFrame>&) {};
    std::function<bool(const CanFrame&)> passes = [](const CanFrame&) { return true; };
    std::function<CycleResult(std::uint64_t)> verdict = [](std::uint64_t) {
        return CycleResult{.has_permit = true, .known_answer_signature = kKnownAnswerSignature};
    };
    LiveOptions options{.supposes_arming = true,
                        .ignores_period = true};  // of the next start; the board moves
    std::function<void()> each_step;              // what another thread would do; empty: nothing
    bool is_armed = false;                        // of the query of that verdict
    bool engine_runs = true;
    std::int64_t response_us = 200;
    bool stands_still = false;
    // Where the machine has ids for them: what the board says when it is asked for its hashes.
    std::function<bool(HashFrame&)> says_hash = [this](HashFrame& hash) {
        hash.hash = options.hashes.of[hash.part];
        return true;
    };
    // Of each session frame on its way; false: it is lost.
    std::function<bool(SessionSays&)> says_session = [](SessionSays&) { return true; };
    bool has_second_board = false;  // the same counters, other positions
    bool is_held = false;           // the process sleeps, the world goes on

    /// A new process with what the old one has stored.
    void start() {
        queues = std::make_unique<LiveQueues>();
        pending_.clear();
        session_due_ = true;
        guard = std::make_unique<GuardNode>(machine, options, wire, *queues, latch, wire.now_us);
    }

    void run_until(std::int64_t until_us) {
        for (; wire.now_us < until_us; wire.now_us += steps_to(until_us) * kStepUs) {
            board();
            if (each_step) {
                each_step();
            }
            if (is_held) {
                continue;
            }
            const bool has_results = engine();
            if (has_results || wire.has_arrivals() || wire.now_us >= guard->next_due_us()) {
                guard->turn(wire.now_us);
            }
        }
    }
    void run_periods(std::int64_t count) { run_until(wire.now_us + count * machine.can.sample_us); }
    void run_to_armed() {
        run_periods(40);
        guard->arm(wire.now_us);
    }

    /// Samples of the board so far: one a period.
    [[nodiscard]] std::uint64_t samples() const { return static_cast<std::uint64_t>(sample_); }

    /// Frames with this id that left since `from_us`.
    std::size_t count_sent(std::uint32_t id, std::int64_t from_us = 0) const {
        std::size_t count = 0;
        for (const CanFrame& frame : wire.sent) {
            count += frame.id == id && frame.time_us >= from_us ? 1U : 0U;
        }
        return count;
    }

    /// Permits that left since `from_us`, or their twins; without the word stop.
    std::size_t count_permits(std::int64_t from_us = 0, bool are_twins = false) const {
        const std::uint8_t stop = are_twins ? 0xA5 : 0x5A;
        std::size_t count = 0;
        for (const CanFrame& frame : wire.sent) {
            const bool is_of_pair = frame.id == machine.can.permit_id + (are_twins ? 1 : 0);
            count += is_of_pair && frame.data[0] != stop && frame.time_us >= from_us ? 1U : 0U;
        }
        return count;
    }

    Machine machine;
    TestWire wire;
    LatchCell& latch;
    std::unique_ptr<LiveQueues> queues;
    std::unique_ptr<GuardNode> guard;

  private:
    [[nodiscard]] std::size_t next_sync() const {
        std::size_t at = heard_;
        while (at < wire.sent.size() && wire.sent[at].id != machine.can.sync_id) {
            ++at;
        }
        return at;
    }
    /// Where the guard sends SYNC, drives latch as the next one ends.
    [[nodiscard]] std::int64_t latch_us() const {
        if (machine.can.guard_sends_sync) {
            const std::size_t at = next_sync();
            return at == wire.sent.size() ? INT64_MAX : wire.sent[at].time_us + wire.echo_us;
        }
        return kBeginUs + sample_ * machine.can.sample_us;
    }
    /// Until something can happen: the steps between change nothing.
    [[nodiscard]] std::int64_t steps_to(std::int64_t until_us) const {
        std::int64_t next_us = std::min(until_us, latch_us());
        if (each_step || (!is_held && guard->has_submitted())) {
            return 1;
        }
        if (!is_held) {
            next_us = std::min({next_us, wire.next_us(), guard->next_due_us()});
            if (engine_runs && !pending_.empty()) {
                next_us = std::min(next_us, pending_.front().done_us);
            }
        }
        return std::max<std::int64_t>(1, (next_us - wire.now_us + kStepUs - 1) / kStepUs);
    }
    void board() {
        while (latch_us() <= wire.now_us) {
            AxisSnapshot snapshot = snapshot_at(machine, sample_);
            if (machine.can.guard_sends_sync) {
                snapshot.latched_us = latch_us();
                heard_ = next_sync() + 1;
            }
            if (stands_still) {
                still_ = has_still_ ? still_ : snapshot.position;
                has_still_ = true;
                snapshot.position = still_;
                snapshot.mode = kModeStandstill;
            }
            says(snapshot);
            std::optional<AxisEncoder> twin;  // as the board's own was before this sample
            if (has_second_board) {
                twin = encoder_;
            }
            std::vector<CanFrame> frames = frames_of(encoder_, snapshot);
            if (machine.can.guard_sends_sync) {
                frames.erase(frames.begin());  // SYNC was the guard's
            }
            count_laps(machine.can.guard_sends_sync ? wire.sent[heard_ - 1].data[0]
                                                    : sync_counter_of(snapshot.sample));
            alters(frames);
            for (const CanFrame& frame : frames) {
                if (passes(frame)) {
                    wire.arrive(frame);
                }
            }
            if (!frames.empty()) {  // a silent board says no session either
                say_session(frames.back().time_us);
            }
            answer_hashes();
            if (twin) {
                second_board(*twin, snapshot);
            }
            ++sample_;
        }
    }
    void second_board(AxisEncoder& encoder, AxisSnapshot snapshot) {
        snapshot.position[0] += 0.01;
        for (const CanFrame& frame : frames_of(encoder, snapshot)) {
            if (frame.id == machine.can.axis_ids[0]) {
                wire.arrive(frame);
            }
        }
    }
    void count_laps(std::uint8_t sync) {
        const std::uint64_t lap = session_.number / kSyncCounterMax;
        const bool is_lap = has_session_ && sync < sync_counter_of(session_.number);
        session_.number = (lap + (is_lap ? 1 : 0)) * kSyncCounterMax + sync - 1U;
        session_due_ = session_due_ || !has_session_ || is_lap || ++session_age_ >= 100;
        has_session_ = true;
    }
    void say_session(std::int64_t time_us) {
        if (!has_sample_counter(machine.can) || !session_due_) {
            return;
        }
        session_due_ = false;
        session_age_ = 0;
        ++session_.counter;
        SessionSays said = session_;
        if (!says_session(said)) {
            return;
        }
        const CanFrame frame = session_frame(said, time_us);
        if (passes(frame)) {
            wire.arrive(frame);
        }
    }
    /// The board hears each of the guard's hashes once, and says its own of that part.
    void answer_hashes() {
        for (; seen_ < wire.sent.size(); ++seen_) {
            HashFrame hash;
            if (machine.can.hashes_out_id != 0 &&
                wire.sent[seen_].id == machine.can.hashes_out_id &&
                decode_hash(wire.sent[seen_], hash) && says_hash(hash)) {
                wire.arrive(encode_hash(machine.can.hashes_in_id, hash, wire.now_us));
            }
        }
    }
    bool engine() {
        LiveQuery query;
        while (queues->queries.pop(query)) {
            LiveResult made;
            made.kind = query.kind;
            made.is_passed = true;
            made.number = query.number;
            made.epoch = query.epoch;
            made.period = query.period;
            made.taken = query.number;
            if (query.kind == LiveQuery::Kind::look_ahead) {
                continue;
            }
            const ReceiverEvent& event = query.event;
            if (query.kind == LiveQuery::Kind::snapshot) {
                is_armed = query.is_armed;
                made.result = verdict(event.snapshot.sample);
                if (made.result.samples == 0) {  // a script that says no n means the usual one
                    made.result.samples = machine.can.permit_samples.least;
                }
                made.result.has_permit &= event.state == ReceiverState::valid;
            }
            made.sync_counter = event.sync_counter;
            made.latched_us = event.snapshot.latched_us;
            made.arrived_us = event.snapshot.arrived_us;
            made.done_us = wire.now_us + response_us;
            pending_.push_back(made);
        }
        bool has_results = false;
        while (engine_runs && !pending_.empty() && pending_.front().done_us <= wire.now_us) {
            has_results = queues->results.push(pending_.front()) || has_results;
            pending_.pop_front();
        }
        return has_results;
    }

    AxisEncoder encoder_;
    std::int64_t sample_ = 0;
    std::array<double, kAxesMax> still_{};
    bool has_still_ = false;
    std::deque<LiveResult> pending_;
    SessionSays session_;
    std::uint32_t session_age_ = 0;  // samples
    bool has_session_ = false, session_due_ = false;
    std::size_t seen_ = 0;   // of the frames sent
    std::size_t heard_ = 0;  // of those, for SYNC
};

}  // namespace axg::test
