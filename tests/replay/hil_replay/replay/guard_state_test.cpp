// SPDX-License-Identifier: Apache-2.0
// The chain that a live program will run, by a trace: frames, receiver, queries, engine, the
// monitor's verdict, the guard's states. A SYNC ends a period; a person arms when the guard is
// ready.
#include "core/guard/guard_state.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "firmware_if/guard/guard_chain.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/simulate/trace_simulation.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

struct Seen {
    std::size_t permits = 0;          // sent
    std::size_t proven = 0;           // snapshots that the monitor would permit, while armed
    std::size_t permits_after = 0;    // sent after the stop: none
    std::size_t stops_sent = 0;       // one at once, then one a period
    std::size_t periods_stopped = 0;  // ended since the stop
    std::optional<std::size_t> ready_period, stop_period;
    std::size_t periods = 0;
};

/// What the live program does with what the chain says.
class Live {
  public:
    Live(const LoadedMachine& loaded, GuardChain& chain) : loaded_(loaded), chain_(chain) {
        on({.kind = GuardEventKind::restart});
        on({.kind = GuardEventKind::loaded});
        on({.kind = GuardEventKind::tested});
    }

    void on_frame(const CanFrame& frame) {
        if (frame.id == loaded_.machine.can.sync_id) {
            ++seen.periods;
            seen.periods_stopped += seen.stop_period ? 1U : 0U;
            on({.kind = GuardEventKind::deadline});
            on({.kind = GuardEventKind::tx_ok});  // the heartbeat of this period
        }
        const ReceiverEvent event = chain_.receive(frame);
        if (event.kind == ReceiverEvent::Kind::snapshot) {
            chain_.evaluate();
            const CycleResult cycle = chain_.decide(event.state == ReceiverState::valid);
            seen.proven += guard.phase == GuardPhase::armed && cycle.has_permit ? 1U : 0U;
            on(guard_event_of(cycle, guard.period, frame.time_us - event.snapshot.latched_us));
        } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::stop) {
            on({.kind = GuardEventKind::fault, .fault = GuardFault::input});
        } else if (event.kind == ReceiverEvent::Kind::fault && event.severity == Severity::drop) {
            on({.kind = GuardEventKind::fault, .fault = GuardFault::input_noise});
        }
        if (guard.phase == GuardPhase::ready) {
            seen.ready_period = seen.ready_period.value_or(seen.periods);
            on({.kind = GuardEventKind::arm});
        }
    }

    Guard guard = start_guard(false);
    Seen seen;

  private:
    void on(const GuardEvent& event) {
        const GuardOutput out = on_event(guard, event, GuardLimits{});
        if (guard.phase == GuardPhase::stopped && !seen.stop_period) {
            seen.stop_period = seen.periods;
        }
        seen.permits += out.sends_permit ? 1U : 0U;
        seen.permits_after += out.sends_permit && seen.stop_period ? 1U : 0U;
        seen.stops_sent += out.sends_stop ? 1U : 0U;
    }

    const LoadedMachine& loaded_;
    GuardChain& chain_;
};

class GuardStates : public testing::TestWithParam<bool> {
  protected:
    void SetUp() override { ASSERT_TRUE(paper.engine.has_value()); }

    std::vector<CanFrame> simulated(const std::string& text) {
        const Machine& machine = paper.loaded.machine;
        GcodeOptions options;
        options.start = default_start(machine);
        const GcodeResult reading = read_gcode(text, machine, options);
        EXPECT_TRUE(reading.faults.empty());
        const std::string path = shop.file("trace.log");
        EXPECT_EQ(simulate_trace(machine, reading.program, {}, path).error, "");
        return test::read_trace(path);
    }

    Live run(const std::vector<CanFrame>& frames) {
        certificate.reset();
        if (GetParam()) {
            auto made = make_stop_certificate(paper.loaded);
            EXPECT_TRUE(made.has_value());
            certificate.emplace(std::move(*made));
        }
        chain = std::make_unique<GuardChain>(paper.loaded.machine, paper.engine->engine(),
                                             *paper.containment_test,
                                             certificate ? &*certificate : nullptr);
        Live live(paper.loaded, *chain);
        for (const CanFrame& frame : frames) {
            live.on_frame(frame);
            if (live.seen.periods_stopped == 20) {
                break;
            }
        }
        return live;
    }

    static constexpr const char* kBrief = "T1 M6\nG0 X20 Y5 Z40\nG1 A-10 C30 F3000\nG0 X-20\nM2\n";

    test::PaperMachine paper;
    test::Workshop shop;
    std::optional<StopCertificate> certificate;
    std::unique_ptr<GuardChain> chain;
};

TEST_P(GuardStates, PermitEveryProvenSnapshotOfAHealthyTrace) {
    const Live live = run(simulated(kBrief));
    EXPECT_EQ(live.guard.phase, GuardPhase::armed) << to_text(live.guard.cause);
    ASSERT_TRUE(live.seen.ready_period.has_value());
    EXPECT_GE(*live.seen.ready_period, GuardLimits{}.snapshots_min);
    EXPECT_LE(*live.seen.ready_period, 3 * GuardLimits{}.snapshots_min);
    EXPECT_EQ(live.seen.permits, live.seen.proven);
    EXPECT_GT(live.seen.permits + 3 * GuardLimits{}.snapshots_min, live.seen.periods);
}

TEST_P(GuardStates, StopForGoodWhereTheMonitorStops) {
    const Live live = run(simulated(test::content_of(test::kDemoProgram)));
    ASSERT_TRUE(live.seen.stop_period.has_value());
    EXPECT_EQ(live.guard.cause, GuardFault::verdict);
    EXPECT_TRUE(chain->state().is_stopped);
    EXPECT_GT(live.seen.permits, 1000U);
    EXPECT_EQ(live.seen.permits, live.seen.proven);
    EXPECT_EQ(live.seen.permits_after, 0U);
    EXPECT_EQ(live.seen.stops_sent, 1U + live.seen.periods_stopped) << "the board says nothing";
    EXPECT_EQ(live.seen.periods_stopped, 20U);
}

TEST_P(GuardStates, StopWhenTheAxesFallSilent) {
    std::vector<CanFrame> frames = simulated(kBrief);
    const Machine& machine = paper.loaded.machine;
    std::size_t periods = 0;
    std::erase_if(frames, [&](const CanFrame& frame) {  // SYNC and heartbeat go on
        periods += frame.id == machine.can.sync_id ? 1U : 0U;
        return periods > 100 && frame.id == machine.can.axis_ids[0];
    });
    const Live live = run(frames);
    ASSERT_TRUE(live.seen.stop_period.has_value());
    EXPECT_GE(*live.seen.stop_period, 101U);
    EXPECT_LE(*live.seen.stop_period, 104U);
    EXPECT_EQ(live.seen.permits_after, 0U);
}

INSTANTIATE_TEST_SUITE_P(Modes, GuardStates, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "stoppable" : "contact"; });

}  // namespace
}  // namespace axg
