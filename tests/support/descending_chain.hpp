// SPDX-License-Identifier: Apache-2.0
// The paper's machine on the engine's side of the live guard while its Z goes down at a constant
// speed, a millimetre in ten samples, until a pair is not proven; with the desk that tells why.
#pragma once

#include <cmath>
#include <memory>
#include <optional>

#include "firmware_if/guard/live_engine.hpp"
#include "firmware_if/guard/why_desk.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {

class DescendingChain {
  public:
    explicit DescendingChain(bool is_stoppable)
        : chain(machine(), paper.engine->engine(), *paper.containment_test,
                {is_stoppable ? &*certificate : nullptr}) {
        snapshot_.axis_count = static_cast<std::uint32_t>(machine().axes.size());
        snapshot_.position = default_start(machine());
        snapshot_.tool = machine().first_tool;
        snapshot_.mode = kModeMoving;
    }
    [[nodiscard]] const Machine& machine() const { return paper.loaded.machine; }

    /// One more sample, its result noted at the desk.
    const LiveResult& step(bool is_armed) {
        snapshot_.position[kZ] -= step_mm;
        ++snapshot_.sample;
        LiveQuery query;
        query.kind = LiveQuery::Kind::snapshot;
        query.number = ++result.number;
        query.epoch = epoch;
        query.is_armed = is_armed;
        query.event.kind = ReceiverEvent::Kind::snapshot;
        query.event.state = ReceiverState::valid;
        query.event.snapshot = snapshot_;
        EXPECT_TRUE(queues_->queries.push(query));
        run_queries(LiveEngine{machine(), chain}, *queues_, [&](const LiveResult& live_result) {
            result = live_result;
            desk.note(live_result, chain);
            refused = chain.refused(live_result.result);
        });
        return result;
    }
    /// To the first that is armed and not proven, once one was.
    const LiveResult& descend() {
        bool was_proven = false;
        for (int i = 0; i < 10'000; ++i) {
            step(was_proven);
            if (was_proven && !result.result.has_permit) {
                return result;
            }
            was_proven = was_proven || result.result.has_permit;
        }
        ADD_FAILURE() << "nothing is in the way";
        return result;
    }
    /// To another speed, slowly enough for the axis' limits.
    void change_step(double to_mm, bool is_armed) {
        constexpr double kChangeMm = 0.001;  // 1000 mm/s2
        const double from_mm = step_mm;
        const int count = static_cast<int>(std::abs(to_mm - from_mm) / kChangeMm);
        for (int i = 1; i <= count; ++i) {
            step_mm = from_mm + (to_mm - from_mm) * i / count;
            step(is_armed);
        }
    }
    /// Reports standstill, until no permit is in force.
    void rest() {
        step_mm = 0;
        snapshot_.mode = kModeStandstill;
        for (int i = 0; i < 20; ++i) {
            step(false);
        }
        snapshot_.mode = kModeMoving;
    }
    [[nodiscard]] WithheldPermit withheld() const {
        return {.why = result.result.has_permit ? WithheldPermit::Why::nothing
                                                : WithheldPermit::Why::not_proven,
                .reason = result.result.reason,
                .pair = result.result.pair,
                .query = result.number};
    }

    PaperMachine paper;
    LiveResult result;
    RefusedCycle refused;  // of the last step, as a replay takes it
    std::uint32_t epoch = 1;
    double step_mm = 0.1;

    std::optional<CpuEngine> desk_engine =
        CpuEngine::over_trees(paper.engine->trees(), machine().capacities);
    std::optional<StopCertificate> certificate = make_stop_certificate(paper.loaded);
    GuardChain chain;
    WhyDesk desk{machine(), desk_engine->engine()};

  private:
    static constexpr std::size_t kZ = 2;

    std::unique_ptr<LiveQueues> queues_ = std::make_unique<LiveQueues>();
    AxisSnapshot snapshot_;
};

}  // namespace axg::test
