// SPDX-License-Identifier: Apache-2.0
// Boards that obey the speed cap, positions alone: programs that never come near anything take no
// longer and are not stopped; one that would be stopped for its speed is not; and where one is
// stopped, no speed would have been slow enough, for the axes may not even stand there.
// AXG_COUNT: seconds of each program at most, and ten places of it to look at for each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/drive/drive_run.hpp"
#include "hil_replay/motion/program_motion.hpp"
#include "tests/support/count.hpp"
#include "tests/support/example_programs.hpp"
#include "tests/support/program_places.hpp"

namespace axg::test {
namespace {

constexpr std::uint64_t kUsualSeconds = 70;  // more than any of them takes
constexpr double kLostShare = 0.05;
constexpr double kCrawlMm = 1;   // of which a good part is the turning plate, 100 mm off its axis
constexpr std::uint32_t kZ = 2;  // of each of the machines

/// How far apart two positions are; a radian counts as much as it moves a point 100 mm off.
double apart_mm(const Machine& machine, const AxisPositions& a, const AxisPositions& b) {
    double square = 0;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const double mm = machine.axes[i].kind == AxisKind::linear ? 1 : 100;
        square += mm * mm * (a[i] - b[i]) * (a[i] - b[i]);
    }
    return std::sqrt(square);
}

struct CappedRun {
    DriveResult result;
    double capped_s = 0, free_s = 0;
};

/// A program in closed loop; with or without the cap obeyed.
CappedRun drive_capped(LoadedMachine& loaded, const Program& program, bool obeys) {
    const Machine& machine = loaded.machine;
    std::optional<CpuEngine> engine = make_engine(loaded);
    const std::optional<ContainmentTest> containment_test = make_containment_test(loaded, *engine);
    std::optional<StopCertificate> certificate = make_stop_certificate(loaded);
    std::optional<SpeedAdvisory> advisory = SpeedAdvisory::create(machine);
    GuardChain chain(machine, engine->engine(), *containment_test, {&*certificate, &*advisory});
    const MotionLimits limits = make_motion_limits(machine);
    const MotionOptions motion;
    double share = 1.0 / kSpeedCapRapid;
    DriveOptions options;
    options.board = promised_board(machine, 1);
    options.board.tick_us = kMotionStepUs;
    options.time_us_max =
        static_cast<std::int64_t>(count_from_environment(kUsualSeconds)) * 1'000'000;
    options.speed_share = obeys ? &share : nullptr;
    CappedRun run;
    run.result = drive(machine, chain, {program.start.data(), machine.axes.size()},
                       make_program_motion(program, limits, motion, options.speed_share), options);
    run.capped_s = 1e-6 * static_cast<double>(run.result.ended_us - run.result.moving_since_us);
    run.free_s = motion_seconds(program, limits, motion);
    return run;
}

/// How far along the path from there, mm, the first place is at which standing is not proven.
double first_without_standing(LoadedMachine& loaded, const std::vector<MotionSample>& path,
                              const AxisPositions& from) {
    const auto apart = [&](const MotionSample& sample) {
        return apart_mm(loaded.machine, sample.position, from);
    };
    double least = HUGE_VAL;
    for (const MotionSample& sample : path) {
        least = std::min(least, apart(sample));
    }
    // The first time: the program may come back the same way.
    const auto nearest = std::find_if(path.begin(), path.end(), [&](const MotionSample& sample) {
        return apart(sample) <= least + 0.01;
    });
    Places places(loaded);
    for (auto at = static_cast<std::size_t>(nearest - path.begin());
         at < path.size() && apart(path[at]) < 5; at += 5) {
        if (!places.is_stoppable(path, at, 0)) {
            return apart(path[at]);
        }
    }
    return HUGE_VAL;
}

void print(const char* name, const CappedRun& run) {
    std::printf("%s: board %s after %.2f s, without the cap it takes %.2f s; guard: %s\n", name,
                to_text(run.result.state), run.capped_s, run.free_s,
                to_text(run.result.guard_stop.reason));
}

bool is_near(const Example& example) {
    return std::string(example.program).ends_with("near");
}

class CappedProgram : public testing::TestWithParam<Example> {};

TEST_P(CappedProgram, IsStoppedOnlyWhereNoSpeedIsSlowEnough) {
    LoadedMachine loaded;
    ASSERT_TRUE(load_example(GetParam().machine, loaded));
    const Program program = read_example(GetParam().program, loaded.machine);
    const CappedRun run = drive_capped(loaded, program, true);
    print(GetParam().program, run);
    if (is_near(GetParam())) {
        if (run.result.guard_stop.reason == StopReason::none) {
            EXPECT_LT(count_from_environment(kUsualSeconds), 25U)
                << "it went where nobody may stand";
            return;
        }
        ASSERT_EQ(run.result.guard_stop.reason, StopReason::predicted);
        const double ahead_mm = first_without_standing(loaded, path_of(program, loaded.machine),
                                                       run.result.guard_stop.snapshot.position);
        std::printf("  %.3f mm before a place at which the axes may not stand\n", ahead_mm);
        EXPECT_LE(ahead_mm, kCrawlMm);
        return;
    }
    EXPECT_EQ(run.result.guard_stop.reason, StopReason::none);
    EXPECT_EQ(run.result.board_stop.why, BoardStop::none);
    if (run.result.state == BoardState::finished) {
        EXPECT_LE(run.capped_s, (1 + kLostShare) * run.free_s);
    }
}

// How much of the time any cap costs that looks no further than the certificate: the machine goes
// through each place as fast as is proven there, and changes its speed at no cost.
TEST_P(CappedProgram, WhatNoCapCanAvoid) {
    LoadedMachine loaded;
    ASSERT_TRUE(load_example(GetParam().machine, loaded));
    Places places(loaded);
    const std::vector<MotionSample> path =
        path_of(read_example(GetParam().program, loaded.machine), loaded.machine);
    const std::uint64_t looks = 10 * count_from_environment(kUsualSeconds);
    std::uint64_t too_fast = 0, no_place_to_stand = 0;
    double lost = 0;
    for (std::uint64_t i = 0; i < looks; ++i) {
        const std::size_t at = i * path.size() / looks;
        if (places.is_stoppable(path, at, 1)) {
            continue;
        }
        ++too_fast;
        if (!places.is_stoppable(path, at, 0)) {
            ++no_place_to_stand;
            continue;
        }
        double low = 1.0 / kSpeedCapRapid, high = 1;
        for (int step = 0; step < 8; ++step) {
            const double middle = 0.5 * (low + high);
            (places.is_stoppable(path, at, middle) ? low : high) = middle;
        }
        lost += path[at].is_moving ? 1 / low - 1 : 0;
    }
    const double all = static_cast<double>(looks);
    std::printf("%s: of %llu places %llu not at speed, %llu not standing; the rest costs %.2f %%\n",
                GetParam().program, static_cast<unsigned long long>(looks),
                static_cast<unsigned long long>(too_fast),
                static_cast<unsigned long long>(no_place_to_stand), 100 * lost / all);
    EXPECT_TRUE(is_near(GetParam()) || too_fast == 0);
    EXPECT_TRUE(!is_near(GetParam()) || looks < 500 || no_place_to_stand > 0);
}

// Higher by as much as standing takes: too fast for what lies ahead, and slowed down in time.
TEST(CappedPrograms, RunWhereTheirOwnSpeedWouldBeStopped) {
    LoadedMachine loaded;
    ASSERT_TRUE(load_example("paper-trunnion", loaded));
    Program program = read_example("paper-trunnion-near", loaded.machine);
    for (Move& move : program.moves) {
        move.target[kZ] += 0.75;
    }
    program.start[kZ] += 0.75;
    const CappedRun free = drive_capped(loaded, program, false);
    print("not obeyed", free);
    const CappedRun capped = drive_capped(loaded, program, true);
    print("obeyed", capped);
    if (count_from_environment(kUsualSeconds) >= 25) {
        EXPECT_EQ(free.result.guard_stop.reason, StopReason::predicted);
        EXPECT_EQ(capped.result.state, BoardState::finished);
    }
    EXPECT_EQ(capped.result.guard_stop.reason, StopReason::none);
    EXPECT_LE(capped.capped_s, 1.25 * capped.free_s);
}

INSTANTIATE_TEST_SUITE_P(Examples, CappedProgram, testing::ValuesIn(kExamples),
                         [](const auto& example) { return name_of(example.param); });

}  // namespace
}  // namespace axg::test
