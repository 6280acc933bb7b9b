// SPDX-License-Identifier: Apache-2.0
// Random motions on the simulated board, with faults on the wire: the motion keeps the law, and
// whatever happens to the guard, braking begins within n T + t_board of the last certified sample.
// AXG_COUNT: cases of each kind; AXG_SEED: which.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "hil_replay/board/approach_driver.hpp"
#include "hil_replay/board/axis_cap_keeper.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "tests/support/between.hpp"
#include "tests/support/count.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/permit_guard.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

/// Linear axes to 60 m/min, rotary ones to 100 rpm; 1 to 10 m/s2, 20 to 200 m/s3.
Machine random_machine(Random& random) {
    Machine machine = motion_test_machine();
    for (Axis& axis : machine.axes) {
        const double unit = axis.kind == AxisKind::rotary ? 0.01 : 1;  // 1 rad/s as 100 mm/s
        axis.speed_max = between(random, 50, 1000) * unit;
        axis.acceleration_max = between(random, 1000, 10000) * unit;
        axis.jerk_max = between(random, 2e4, 2e5) * unit;
        axis.stopping_min = axis.acceleration_max * between(random, 0.5, 1);
    }
    return machine;
}

double end_of_travel(const Axis& axis, double share) {
    const double low = axis.unlimited ? -20 : axis.min, high = axis.unlimited ? 20 : axis.max;
    return low + (high - low) * share;
}

Approach random_approach(Random& random, const Machine& machine) {
    Approach approach;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        approach.target[i] = end_of_travel(machine.axes[i], between(random, 0.05, 0.95));
        approach.speed_share[i] = random() % 2 == 0 ? 1 : between(random, 0.05, 1);
    }
    return approach;
}

std::array<double, kAxesMax> random_start(Random& random, const Machine& machine) {
    std::array<double, kAxesMax> start{};
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        start[i] = end_of_travel(machine.axes[i], between(random, 0.1, 0.9));
    }
    return start;
}

// What the guard's proof takes for granted holds at every instant: the limits of speed,
// acceleration and jerk, and enough speed left to let the acceleration go to zero.
TEST(ApproachDriver, KeepsTheLimitsAndArrives) {
    Random random(printed_seed(20261121));
    const std::uint64_t count = count_from_environment(300);
    double fastest = 0, hardest = 0;
    for (std::uint64_t n = count; n > 0; --n) {
        const Machine machine = random_machine(random);
        const Approach approach = random_approach(random, machine);
        const CommandedMotion motion = make_approach(machine, approach);
        const auto start = random_start(random, machine);
        std::vector<AxisMotion> axes(machine.axes.size());
        for (std::size_t i = 0; i < axes.size(); ++i) {
            axes[i].position = start[i];
        }
        for (int k = 0; k < 6000; ++k) {
            (void)motion(axes);
            for (std::size_t i = 0; i < axes.size(); ++i) {
                const Axis& axis = machine.axes[i];
                const double j = axis.jerk_max;
                ASSERT_LE(std::abs(axes[i].jerk), j * (1 + 1e-12));
                for (int part = 1; part <= 4; ++part) {
                    const AxisMotion at = moved_on(axes[i], 0.25e-3 * part);
                    ASSERT_LE(std::abs(at.acceleration), axis.acceleration_max * (1 + 1e-9));
                    const double swing = 0.5 * at.acceleration * std::abs(at.acceleration) / j;
                    ASSERT_LE(std::abs(at.speed + swing), axis.speed_max * (1 + 1e-9));
                    fastest = std::max(fastest, std::abs(at.speed) / axis.speed_max);
                    hardest = std::max(hardest, std::abs(at.acceleration) / axis.acceleration_max);
                    if (!axis.unlimited) {
                        ASSERT_GE(at.position, axis.min);
                        ASSERT_LE(at.position, axis.max);
                    }
                }
                axes[i] = moved_on(axes[i], 1e-3);
            }
        }
    }
    if (count >= 300) {
        EXPECT_GT(fastest, 0.99) << "too tame to tell anything";
        EXPECT_GT(hardest, 0.99) << "too tame to tell anything";
    }
}

// A board keeps a lower cap from the moment that its axes are below it, also the other way round.
TEST(ApproachDriver, SlowedDownItStaysSlowWhicheverWayItGoes) {
    Random random(printed_seed(20261129));
    std::uint64_t kept = 0, turned = 0;
    for (std::uint64_t n = count_from_environment(2000); n > 0; --n) {
        const Machine machine = random_machine(random);
        const Axis& axis = machine.axes[0];
        const double share = between(random, 0.004, 0.2), target = between(random, -20, 20);
        AxisMotion now;
        const int free_ticks = static_cast<int>(between(random, 1, 150));
        const double first = between(random, -100, 100);
        bool is_kept = false;
        double before = 0;
        for (int k = 0; k < free_ticks + 600; ++k) {
            const bool is_free = k < free_ticks;
            now.jerk = is_free ? approach_jerk(axis, now, first, 1, 1e-3)
                               : approach_jerk(axis, now, target, share, 1e-3, share);
            now = moved_on(now, 1e-3);
            const double of = share_in_stop(axis, now);
            ASSERT_TRUE(!is_kept || of <= share * (1 + 1e-9)) << of << " for " << share;
            is_kept = is_kept || (!is_free && of <= share);
            turned += !is_free && before * now.speed < 0 ? 1 : 0;
            before = now.speed;
        }
        kept += is_kept ? 1 : 0;
    }
    EXPECT_GT(kept, 0U);
    EXPECT_GT(turned, 0U);
}

enum class Fault { silence, late, killed, stuck };
constexpr const char* kFaultNames[] = {"silence", "late by one cycle", "killed", "stuck engine"};

struct Case {
    Machine machine;
    Approach approach;
    std::array<double, kAxesMax> start{};
    BoardOptions board;
    BusOptions bus;
    std::int64_t fault_us = kNever;
};

Case random_case(Random& random) {
    Case c;
    c.machine = random_machine(random);
    const auto samples = static_cast<std::uint8_t>(3 + random() % 2);
    c.machine.can.permit_samples = {samples, samples};
    c.approach = random_approach(random, c.machine);
    c.start = random_start(random, c.machine);
    c.board.seed = random();
    // Two samples are then off by what the machine file promises, at any speed.
    c.board.latch_jitter_us_max = static_cast<std::int64_t>(c.machine.guard.latch_jitter_s * 0.5e6);
    c.board.reaction_us_max = static_cast<std::int64_t>(between(random, 0, 5000));
    c.bus.seed = random();
    c.fault_us = kBoardStartUs + static_cast<std::int64_t>(between(random, 20e3, 150e3));
    return c;
}

struct Outcome {
    BoardState state = BoardState::waiting;
    BoardStopRecord stop;
    std::int64_t certified_sent_us = INT64_MIN;  // instant of the newest sample with a permit sent
    double slowest_stop = 0;                     // of what the promise allows
    AxisMotions rest{};
};

/// How long an axis may take to stand, by the promise: the ramp, and then the speed it may have.
double stop_time_max(const Axis& axis) {
    const double a = axis.acceleration_max, d = axis.stopping_min, j = axis.jerk_max;
    return (a + d) / j + axis.speed_max / d;
}

Outcome run_case(const Case& c, int cycles) {
    Outcome outcome;
    MotionBoard board(c.machine, {c.start.data(), c.machine.axes.size()},
                      make_approach(c.machine, c.approach), c.board);
    LoopGuard guard = make_permit_guard(c.machine, 600);
    const auto on_frame = guard.on_frame;
    std::int64_t snapshot_us = INT64_MIN;  // as the guard sees it: the end of SYNC
    guard.on_frame = [&](const CanFrame& frame, std::vector<CanFrame>& sent) {
        snapshot_us = frame.id == c.machine.can.sync_id ? frame.time_us : snapshot_us;
        on_frame(frame, sent);
        if (!sent.empty()) {
            outcome.certified_sent_us = snapshot_us;
        }
    };
    ClosedLoop loop(board, c.bus, guard);
    for (int k = 0; k < cycles && !board.is_at_rest(); ++k) {
        EXPECT_TRUE(loop.cycle());
    }
    outcome.state = board.state();
    outcome.stop = board.stop();
    std::copy(board.axes().begin(), board.axes().end(), outcome.rest.begin());
    return outcome;
}

BusFaults faults_of(Fault fault, std::int64_t at_us) {
    BusFaults faults;
    switch (fault) {
        case Fault::silence:
            faults.silent_from_us = at_us;
            break;
        case Fault::late:  // and then nothing: what came late must not have prolonged anything
            faults.late_from_us = at_us;
            faults.killed_from_us = at_us + 20'000;
            break;
        case Fault::killed:
            faults.killed_from_us = at_us;
            break;
        case Fault::stuck:
            faults.stuck_from_us = at_us;
            break;
    }
    return faults;
}

class BoardFault : public testing::TestWithParam<Fault> {};

TEST_P(BoardFault, BrakingBeginsWithinNPeriodsAndTheReaction) {
    Random random(printed_seed(20261122 + static_cast<std::uint64_t>(GetParam())));
    const std::uint64_t count = count_from_environment(1000);
    std::int64_t latest_us = INT64_MIN;  // after the bound; never above zero
    for (std::uint64_t n = 0; n < count; ++n) {
        Case c = random_case(random);
        c.bus.faults = faults_of(GetParam(), c.fault_us);
        const Outcome outcome = run_case(c, 3000);
        const std::int64_t bound_us =
            outcome.stop.certified_us +
            std::int64_t{c.machine.can.permit_samples.most} * c.machine.can.sample_us +
            c.board.reaction_us_max;
        ASSERT_EQ(outcome.state, BoardState::stopped) << "case " << n;
        ASSERT_EQ(outcome.stop.why, BoardStop::permit_ran_out) << "case " << n;
        ASSERT_GT(outcome.stop.brake_us, c.fault_us) << "it stopped for another reason";
        ASSERT_LE(outcome.stop.brake_us, bound_us) << "case " << n;
        // The sample it stood on is no newer than the last one that the guard could certify.
        ASSERT_LE(outcome.stop.certified_us,
                  outcome.certified_sent_us + c.board.latch_jitter_us_max)
            << "case " << n;
        double longest_s = 0;
        for (const Axis& axis : c.machine.axes) {
            longest_s = std::max(longest_s, stop_time_max(axis));
        }
        ASSERT_LE(outcome.stop.rest_us, outcome.stop.brake_us +
                                            std::int64_t{c.machine.can.sample_us} +
                                            static_cast<std::int64_t>(longest_s * 1e6));
        latest_us = std::max(latest_us, outcome.stop.brake_us - bound_us);
    }
    std::printf("%s: %llu of %llu; the latest began %lld us before its bound\n",
                kFaultNames[static_cast<int>(GetParam())], static_cast<unsigned long long>(count),
                static_cast<unsigned long long>(count), static_cast<long long>(-latest_us));
    if (count >= 1000) {
        EXPECT_EQ(latest_us, 0) << "no stop at the bound: too tame to tell anything";
    }
}

INSTANTIATE_TEST_SUITE_P(Each, BoardFault,
                         testing::Values(Fault::silence, Fault::late, Fault::killed, Fault::stuck));

// Without a fault the same cases go on: it was the fault that stopped them.
TEST(MotionBoard, AHealthyGuardNeverStopsIt) {
    Random random(printed_seed(20261127));
    for (std::uint64_t n = std::min<std::uint64_t>(count_from_environment(100), 10000); n > 0;
         --n) {
        const Case c = random_case(random);
        ASSERT_EQ(run_case(c, 400).state, BoardState::moving);
    }
}

// The permit for a sample ends 1.34 ms after it: one a period late meets the end of the one before
// with n = 3, and is in time with n = 4. The same holds for one sample lost.
TEST(MotionBoard, OneCycleLateIsBorneFromFourPeriodsOn) {
    Random random(printed_seed(20261128));
    for (std::uint64_t n = std::min<std::uint64_t>(count_from_environment(100), 10000); n > 0;
         --n) {
        Case c = random_case(random);
        c.bus.faults.late_from_us = c.fault_us;
        const bool is_borne = c.machine.can.permit_samples.most > 3;
        ASSERT_EQ(run_case(c, 3000).stop.why,
                  is_borne ? BoardStop::none : BoardStop::permit_ran_out);
    }
}

// The ablation: without the permit's end nothing brakes when the guard is dead, or deaf and dumb.
TEST(MotionBoard, WithoutTheDeadManItMovesOn) {
    Random random(printed_seed(20261129));
    for (std::uint64_t n = std::min<std::uint64_t>(count_from_environment(100), 10000); n > 0;
         --n) {
        Case c = random_case(random);
        c.bus.faults = faults_of(n % 2 == 0 ? Fault::killed : Fault::stuck, c.fault_us);
        lab::forget_dead_man(c.board);
        ASSERT_EQ(run_case(c, 400).state, BoardState::moving);
    }
}

// Lost frames either way: some runs stop, none later than the bound; few losses stop few.
TEST(MotionBoard, LossesStopItInTimeOrNotAtAll) {
    Random random(printed_seed(20261130));
    const std::uint64_t count = std::min<std::uint64_t>(count_from_environment(300), 100000);
    std::uint64_t stopped = 0, stopped_at_little = 0;
    for (std::uint64_t n = 0; n < count; ++n) {
        Case c = random_case(random);
        const bool is_little = n % 2 == 0;
        c.machine.can.permit_samples = is_little ? PermitSamples{6, 6} : PermitSamples{3, 3};
        c.machine.can.stale_after_us = 1000U * c.machine.can.permit_samples.most;
        c.bus.faults.lost = is_little ? 0.001 : between(random, 0.01, 0.05);
        c.bus.faults.corrupted = is_little ? 0 : 0.01;
        const Outcome outcome = run_case(c, 400);
        if (outcome.stop.why == BoardStop::none) {
            continue;
        }
        ++stopped;
        stopped_at_little += is_little ? 1 : 0;
        ASSERT_LE(outcome.stop.brake_us,
                  outcome.stop.certified_us +
                      std::int64_t{c.machine.can.permit_samples.most} * c.machine.can.sample_us +
                      c.board.reaction_us_max);
    }
    std::printf("%llu of %llu stopped, %llu of those with n = 6 and one frame in a thousand lost\n",
                static_cast<unsigned long long>(stopped), static_cast<unsigned long long>(count),
                static_cast<unsigned long long>(stopped_at_little));
    EXPECT_LE(10 * stopped_at_little, count) << "one frame in a thousand stops too much";
}

TEST(MotionBoard, DamagedPermitsNeverSetItInMotion) {
    Random random(printed_seed(20261131));
    Case c = random_case(random);
    c.bus.faults = {.corrupted = 1};
    EXPECT_EQ(run_case(c, 2000).state, BoardState::waiting);
    c.bus.faults = {.permit_lost = 1};
    EXPECT_EQ(run_case(c, 200).state, BoardState::waiting);
    c.bus.faults = {};
    EXPECT_EQ(run_case(c, 200).state, BoardState::moving);
}

TEST(MotionBoard, TheSameSeedGivesTheSameRest) {
    Random random(printed_seed(20261132));
    Case c = random_case(random);
    c.bus.faults.lost = 0.02;
    c.bus.faults.killed_from_us = c.fault_us;
    const Outcome first = run_case(c, 3000), again = run_case(c, 3000);
    ++c.board.seed;
    const Outcome other = run_case(c, 3000);
    bool differs = false;
    for (std::size_t i = 0; i < c.machine.axes.size(); ++i) {
        EXPECT_EQ(first.rest[i].position, again.rest[i].position);
        differs = differs || first.rest[i].position != other.rest[i].position;
    }
    EXPECT_TRUE(differs) << "the seed changes nothing";
}

}  // namespace
}  // namespace axg::test
