// SPDX-License-Identifier: Apache-2.0
// Faults of every class at random moments, and a guard that may never let one pass: what leaves on
// the wire is judged period by period. Each fault states the longest time until no permit may leave
// any more; healthy periods between must have their permits, so that silence is no way to pass.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <random>

#include "tests/support/count.hpp"
#include "tests/support/live_world.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

enum class Fault : std::uint8_t {
    verdict,
    engine_silent,
    engine_late,
    board_silent,
    one_frame_missing,
    deaf,
    busy,
    down_out,
    down_in,
    gone,
    second_guard,
    held,
    spoofed,
    flood,
    bus_off,
    killed,
    count,
};
constexpr auto kFaults = static_cast<std::size_t>(Fault::count);
constexpr std::array<const char*, kFaults> kNames{"verdict",
                                                  "engine silent",
                                                  "engine late",
                                                  "board silent",
                                                  "one frame of each sample missing",
                                                  "own frames never on the wire",
                                                  "queue full",
                                                  "interface down (send)",
                                                  "interface down (receive)",
                                                  "interface removed",
                                                  "second guard",
                                                  "process held",
                                                  "spoofed axis",
                                                  "flood of our ids",
                                                  "bus-off",
                                                  "killed"};

struct Row {
    std::uint64_t injected = 0, applied = 0, late = 0, missed = 0;
    std::int64_t worst_us = 0;  // from the fault to the last permit
};

class Campaign {
  public:
    explicit Campaign(std::uint64_t seed) : random_(seed) {}

    /// One guard from its start to a fault while armed, and on for some periods.
    void run(Fault fault) {
        LatchCell latch{kLatchClear, ~kLatchClear};
        test::LiveWorld world(draw(2) == 0 ? CanFormat::classical : CanFormat::fd, latch);
        world.run_to_armed();
        const std::int64_t armed_us = world.wire.now_us;
        world.run_periods(10 + draw(40));
        world.run_until(world.wire.now_us + draw(20) * test::LiveWorld::kStepUs);
        periods += (world.wire.now_us - armed_us) / world.machine.can.sample_us;
        const std::size_t wanted = (world.wire.now_us - armed_us) / world.machine.can.sample_us;
        const std::size_t permits = world.count_sent(world.machine.can.permit_id, armed_us);
        false_stops += permits + 2 < wanted ? 1U : 0U;
        Row& row = rows[static_cast<std::size_t>(fault)];
        ++row.injected;
        const std::int64_t fault_us = world.wire.now_us;
        const std::size_t before = world.wire.sent.size();
        inject(world, fault);
        world.run_periods(30);
        judge(world, fault, fault_us, before, row);
    }

    std::array<Row, kFaults> rows{};
    std::uint64_t periods = 0, false_stops = 0;

  private:
    std::uint32_t draw(std::uint32_t below) {
        return std::uniform_int_distribution<std::uint32_t>(0, below - 1)(random_);
    }

    CanFrame foreign(const test::LiveWorld& world, std::uint32_t id) {
        CanFrame frame;
        frame.id = id;
        frame.length_bytes = 8;
        frame.fd = false;
        frame.time_us = world.wire.now_us;
        for (std::uint8_t& byte : frame.data) {
            byte = static_cast<std::uint8_t>(draw(256));
        }
        return frame;
    }

    void inject(test::LiveWorld& world, Fault fault) {
        const CanLayout& can = world.machine.can;
        switch (fault) {
            case Fault::verdict:
                world.verdict = [](std::uint64_t) {
                    return CycleResult{.stops_now = true, .reason = StopReason::contact};
                };
                break;
            case Fault::engine_silent:
                world.engine_answers = false;
                break;
            case Fault::engine_late:
                world.answer_us = world.machine.deadline_us + 50 + draw(3000);
                break;
            case Fault::board_silent:
                world.passes = [](const CanFrame&) { return false; };
                break;
            case Fault::one_frame_missing:
                world.passes = [id = can.axis_ids[0]](const CanFrame& f) { return f.id != id; };
                break;
            case Fault::deaf:
                world.wire.is_deaf = true;
                break;
            case Fault::busy:
                world.wire.answer = SendStatus::busy;
                break;
            case Fault::down_out:
                world.wire.answer = SendStatus::down;
                break;
            case Fault::down_in:
                world.wire.tell(ReadStatus::down);
                break;
            case Fault::gone:
                world.wire.tell(ReadStatus::gone);
                break;
            case Fault::second_guard:
                world.wire.arrive(foreign(world, can.permit_id + draw(2)));
                break;
            case Fault::held:
                world.is_held = true;
                world.run_periods(4 + draw(50));
                world.is_held = false;
                break;
            case Fault::spoofed:
                world.has_second_board = true;
                break;
            case Fault::flood:
                for (int i = 0; i < 20; ++i) {
                    CanFrame frame = foreign(world, can.axis_ids[0]);
                    frame.fd = can.format == CanFormat::fd;
                    frame.length_bytes = 7;  // no payload passes the checksum by chance
                    world.wire.arrive(frame);
                }
                break;
            case Fault::bus_off: {
                CanFrame frame = foreign(world, 0x040);
                frame.error = true;
                world.wire.arrive(frame);
                break;
            }
            case Fault::killed:
                world.start();
                break;
            case Fault::count:
                break;
        }
    }

    /// Whether it stopped for what was injected, and not by some other way.
    static bool is_applied(const test::LiveWorld& world, Fault fault) {
        const GuardFault cause = world.guard->guard().cause;
        const ReceiverCounters& input = world.guard->receiver().counters();
        const bool is_silence = cause == GuardFault::silence || cause == GuardFault::engine;
        const bool is_input = cause == GuardFault::input;
        switch (fault) {
            case Fault::verdict:
                return cause == GuardFault::verdict;
            case Fault::engine_silent:
            case Fault::engine_late:
                return is_silence;
            case Fault::board_silent:
            case Fault::one_frame_missing:
                return is_silence || (is_input && input.of(ReceiverFault::stale) == 1);
            case Fault::deaf:
            case Fault::busy:
            case Fault::down_out:
                return cause == GuardFault::output && world.wire.applied != 0;
            case Fault::down_in:
                return is_input && world.wire.applied == 1;
            case Fault::gone:
                return is_input && world.guard->is_wire_gone();
            case Fault::second_guard:
                return cause == GuardFault::second_guard;
            case Fault::held:
                return cause == GuardFault::gap;
            case Fault::spoofed:
                return is_input && input.of(ReceiverFault::spoofed) == 1;
            case Fault::flood:
                return is_input && input.of(ReceiverFault::flood) == 1;
            case Fault::bus_off:
                return is_input && input.of(ReceiverFault::bus_off) == 1;
            case Fault::killed:
                return world.guard->guard().phase != GuardPhase::armed;
            case Fault::count:
                break;
        }
        return false;
    }

    void judge(const test::LiveWorld& world, Fault fault, std::int64_t fault_us, std::size_t before,
               Row& row) {
        const CanLayout& can = world.machine.can;
        const std::int64_t period_us = can.sample_us;
        std::int64_t last_us = fault_us;
        bool has_stop = false, is_bad = false;
        for (std::size_t i = before; i < world.wire.sent.size(); ++i) {
            const CanFrame& frame = world.wire.sent[i];
            const bool is_permit = frame.id == can.permit_id || frame.id == can.permit_id + 1;
            has_stop = has_stop || frame.id == can.stop_id;
            is_bad = is_bad || (has_stop && is_permit);  // a permit after the stop
            last_us = is_permit ? frame.time_us : last_us;
        }
        const Guard& guard = world.guard->guard();
        const bool is_stopped = fault == Fault::killed
                                    ? guard.phase != GuardPhase::armed
                                    : guard.phase == GuardPhase::stopped && is_latched(world.latch);
        // One evaluation may have been under way; silence of whoever is found by the permit's
        // validity, own frames that fail by two periods.
        const std::int64_t limit_us = (can.permit_samples + 1) * period_us;
        row.applied += is_applied(world, fault) ? 1U : 0U;
        row.missed += !is_stopped || is_bad ? 1U : 0U;
        row.late += last_us - fault_us > limit_us ? 1U : 0U;
        row.worst_us = std::max(row.worst_us, last_us - fault_us);
    }

    std::mt19937_64 random_;
};

TEST(LiveGuardProperty, NoFaultIsFollowedByAPermit) {
    Campaign campaign(test::printed_seed(20261121));
    const std::uint64_t count = test::count_from_environment(16 * 1000);
    for (std::uint64_t i = 0; i < count; ++i) {
        campaign.run(static_cast<Fault>(i % kFaults));
    }
    std::printf("%-34s %9s %8s %7s %5s %9s\n", "fault", "injected", "applied", "missed", "late",
                "worst us");
    for (std::size_t i = 0; i < kFaults; ++i) {
        const Row& row = campaign.rows[i];
        std::printf("%-34s %9llu %8llu %7llu %5llu %9lld\n", kNames[i],
                    static_cast<unsigned long long>(row.injected),
                    static_cast<unsigned long long>(row.applied),
                    static_cast<unsigned long long>(row.missed),
                    static_cast<unsigned long long>(row.late),
                    static_cast<long long>(row.worst_us));
        EXPECT_EQ(row.applied, row.injected) << kNames[i];
        EXPECT_EQ(row.missed, 0U) << kNames[i];
        EXPECT_EQ(row.late, 0U) << kNames[i];
    }
    std::printf("%llu armed periods before the faults\n",
                static_cast<unsigned long long>(campaign.periods));
    EXPECT_EQ(campaign.false_stops, 0U);
}

// Two samples lost in a row are older than the usual three periods before the next one is complete,
// and stop; a permit of four periods bears them (docs/live.md).
TEST(LiveGuardProperty, OneFrameLostInAThousandStopsNothingWithPermitsOfFourPeriods) {
    std::mt19937_64 random(test::printed_seed(20261122));
    const std::uint64_t periods = test::count_from_environment(200'000);
    for (const CanFormat format : {CanFormat::classical, CanFormat::fd}) {
        LatchCell latch{kLatchClear, ~kLatchClear};
        test::LiveWorld world(format, latch);
        world.machine.can.permit_samples = 4;
        world.machine.can.stale_after_us = 4 * world.machine.can.sample_us;
        world.start();
        std::uint64_t lost = 0;
        world.passes = [&](const CanFrame&) {
            const bool is_lost = random() % 1000 == 0;
            lost += is_lost ? 1U : 0U;
            return !is_lost;
        };
        world.run_to_armed();
        const std::uint64_t before = world.guard->counters().permits;
        for (std::uint64_t done = 0; done < periods; done += 1000) {
            world.run_periods(1000);
            world.wire.sent.clear();  // nobody reads them
        }
        const std::uint64_t permits = world.guard->counters().permits - before;
        EXPECT_EQ(world.guard->guard().phase, GuardPhase::armed)
            << to_text(world.guard->guard().cause);
        EXPECT_GE(permits + 2 * lost + 2, periods);
        EXPECT_TRUE(periods < 20'000 || lost > 20) << "nothing was lost: this shows nothing";
        std::printf("%llu periods, %llu frames lost, %llu permits\n",
                    static_cast<unsigned long long>(periods), static_cast<unsigned long long>(lost),
                    static_cast<unsigned long long>(permits));
    }
}

}  // namespace
}  // namespace axg
