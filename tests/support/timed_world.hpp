// SPDX-License-Identifier: Apache-2.0
// A guard on a clock that is passed in, between a healthy board and a real engine that knows the
// known-answer mesh alone: the machine has no pairs, so every snapshot is permitted while the
// engine answers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "core/collision/containment.hpp"
#include "core/collision/known_answer.hpp"
#include "hil_replay/guard/timed_guard.hpp"
#include "tests/support/can_board.hpp"
#include "tests/support/engine_fixture.hpp"

namespace axg::test {

/// The engine's side of a guard of a machine without pairs.
class KnownAnswerEngine {
  public:
    KnownAnswerEngine() = default;
    KnownAnswerEngine(const KnownAnswerEngine&) = delete;
    KnownAnswerEngine& operator=(const KnownAnswerEngine&) = delete;

    [[nodiscard]] Engine engine() { return {.self = this, .run = &run}; }
    [[nodiscard]] const ContainmentTest& containment_test() const { return *containment_test_; }

    bool is_well = true;  // false: every result is missing

  private:
    static void run(void* self, std::span<const Query> queries,
                    std::span<QueryResult> results) noexcept {
        auto& own = *static_cast<KnownAnswerEngine*>(self);
        std::fill(results.begin(), results.end(), QueryResult{});
        if (own.is_well) {
            own.engine_->run(queries, results);
        }
    }

    std::vector<Mesh> meshes_{known_answer_mesh()};
    const Mesh* mesh_ = meshes_.data();
    std::optional<CpuEngine> engine_ = engine_over(meshes_);
    std::optional<ContainmentTest> containment_test_ =
        ContainmentTest::create({&mesh_, 1}, engine_->trees(), {});
};

class TimedWorld {
  public:
    static constexpr std::int64_t kBeginUs = 1'000'000;  // latch of the board's first sample
    static constexpr std::int64_t kStartUs = kBeginUs - 5000;

    explicit TimedWorld(CanFormat format = CanFormat::classical)
        : machine(five_axis_machine(format)) {
        options.sent = [this](const CanFrame& frame) {
            sent.push_back(frame);
            if (!options.echoes && echoes) {
                echoes_.push_back({.frame = frame, .is_own = true});
                echoes_.back().frame.time_us += echo_us;
            }
        };
        options.each = [this](const TimedCycle& cycle) {
            ++cycles;
            permitted += cycle.sent_permit ? 1U : 0U;
        };
        options.response_us = [this](std::int64_t) { return response_us; };
    }
    TimedWorld(const TimedWorld&) = delete;
    TimedWorld& operator=(const TimedWorld&) = delete;

    Machine machine;  // may be changed before start()
    KnownAnswerEngine answers;
    TimedGuardOptions options;     // of start()
    std::int64_t response_us = 0;  // of the engine
    bool echoes = true;            // where options.echoes is not set: the wire gives frames back
    std::int64_t echo_us = 100;
    bool stands_still = false;
    std::vector<CanFrame> sent;
    std::uint64_t cycles = 0, permitted = 0;
    std::optional<TimedGuard> guard;

    void start(std::int64_t now_us = kStartUs) {
        chain_.emplace(machine, answers.engine(), answers.containment_test(), ChainParts{});
        encoder_.emplace(machine);
        guard.emplace(LiveEngine{.machine = machine, .chain = *chain_}, options, now_us);
    }

    /// The frames of the board's next sample, in order of time.
    [[nodiscard]] std::vector<CanFrame> next_sample() {
        AxisSnapshot snapshot = snapshot_at(machine, sample_++);
        snapshot.tool = 0;
        if (stands_still) {
            still_ = has_still_ ? still_ : snapshot.position;
            has_still_ = true;
            snapshot.position = still_;
            snapshot.mode = kModeStandstill;
        }
        newest_us_ = snapshot.latched_us;
        return frames_of(*encoder_, snapshot);
    }
    void run_samples(std::uint64_t count) {
        for (std::uint64_t i = 0; i < count; ++i) {
            for (const CanFrame& frame : next_sample()) {
                run_before(frame.time_us);
                guard->arrive({.frame = frame});
            }
        }
    }
    /// The board is silent: timers, results and echoes alone.
    void run_before(std::int64_t until_us) {
        for (;;) {
            const std::int64_t due_us = guard->next_due_us();
            const std::int64_t echo_due_us =
                echoes_.empty() ? INT64_MAX : echoes_.front().frame.time_us;
            if (std::min(due_us, echo_due_us) >= until_us) {
                return;
            }
            if (due_us < echo_due_us) {
                guard->run_before(due_us + 1);
                continue;
            }
            const CanArrival echo = echoes_.front();
            echoes_.pop_front();
            guard->arrive(echo);
        }
    }

    [[nodiscard]] GuardPhase phase() const { return guard->guard().guard().phase; }
    [[nodiscard]] GuardFault cause() const { return guard->guard().guard().cause; }
    [[nodiscard]] std::int64_t newest_us() const { return newest_us_; }  // latch of the last sample
    /// Frames with this id that left at `from_us` or later.
    [[nodiscard]] std::vector<CanFrame> with_id(std::uint32_t id, std::int64_t from_us = 0) const {
        std::vector<CanFrame> out;
        std::copy_if(sent.begin(), sent.end(), std::back_inserter(out), [&](const CanFrame& frame) {
            return frame.id == id && frame.time_us >= from_us;
        });
        return out;
    }

  private:
    std::optional<GuardChain> chain_;
    std::optional<AxisEncoder> encoder_;
    std::deque<CanArrival> echoes_;
    std::uint64_t sample_ = 0;
    std::int64_t newest_us_ = 0;
    std::array<double, kAxesMax> still_{};
    bool has_still_ = false;
};

}  // namespace axg::test
