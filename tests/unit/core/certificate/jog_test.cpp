// SPDX-License-Identifier: Apache-2.0
// A jog: what the board says of it, whether the axes keep to it, and what the certificate requires
// of one: that axis, that way, and the clearance there is in place of the margin.
#include "core/reach/jog.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/certificate/stop_certificate.hpp"
#include "core/guard/distance_need.hpp"
#include "core/guard/monitor.hpp"
#include "core/machine/cycle_plan.hpp"
#include "core/reach/stop_reach.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

enum : std::uint32_t { kX, kY, kZ, kA, kC };
constexpr JogMove kUp{kZ, false}, kDown{kZ, true};

/// 5 mm/s and 100 mm/s2; 2 degrees/s and 40 degrees/s2.
Machine jog_machine() {
    Machine m = table_and_head_machine();
    m.guard.jog = {true, 5, 100, 2 * kTestRadPerDegree, 40 * kTestRadPerDegree};
    m.tools.resize(1);
    return m;
}

TEST(Jog, IsSaidInModeAndFlags) {
    AxisSnapshot snapshot;
    EXPECT_EQ(jog_of(snapshot), JogMove{});
    for (std::uint32_t axis = 0; axis < kAxesMax; ++axis) {
        for (const bool is_negative : {false, true}) {
            snapshot.flags = kFlagNotHomed;
            put_jog({axis, is_negative}, snapshot);
            EXPECT_EQ(snapshot.mode, 3);
            EXPECT_EQ(snapshot.flags, 1 + (is_negative ? 2 : 0) + 16 * axis);
            EXPECT_EQ(jog_of(snapshot), (JogMove{axis, is_negative}));
        }
    }
    snapshot.mode = kModeMoving;
    EXPECT_EQ(jog_of(snapshot), JogMove{}) << "flags alone say nothing";
}

TEST(Jog, ItsLimitsAreTheSlowerOnes) {
    const Machine m = jog_machine();
    const AxisLimits z = jog_limits(m.guard.jog, m.axes[kZ]);
    EXPECT_EQ(z.speed_max, 5);
    EXPECT_EQ(z.acceleration_max, 100);
    EXPECT_EQ(z.stopping_min, m.axes[kZ].stopping_min);
    EXPECT_EQ(jog_limits(m.guard.jog, m.axes[kA]).speed_max, 2 * kTestRadPerDegree);
    Axis slow = m.axes[kZ];
    slow.speed_max = 1;
    slow.acceleration_max = 10;
    EXPECT_EQ(jog_limits(m.guard.jog, slow).speed_max, 1);
    EXPECT_EQ(jog_limits(m.guard.jog, slow).acceleration_max, 10);
}

// By hand, in steps: at the largest speed until the stop, still accelerating, and never again.
TEST(Jog, ReachCoversTheWorstStop) {
    const Machine m = jog_machine();
    for (const double acceleration : {10.0, 100.0, 1500.0}) {
        AxisLimits limits = jog_limits(m.guard.jog, m.axes[kZ]);
        limits.acceleration_max = acceleration;
        constexpr double kFreeS = 5e-3, kStepS = 1e-7;
        double speed = limits.speed_max, a = acceleration, way = speed * kFreeS;
        while (speed > 0) {
            a = std::max(a - limits.jerk_max * kStepS, -limits.stopping_min);
            speed += a * kStepS;
            way += speed * kStepS;
        }
        EXPECT_GE(jog_reach(limits, kFreeS), way - 1e-5) << acceleration;
        EXPECT_LE(jog_reach(limits, kFreeS), 2 * way + 1e-3) << acceleration;
    }
}

// It slows down as hard as it may and almost stands; a stop that keeps the jerk turns it round.
TEST(Jog, TurnReachCoversTheWorstStop) {
    const Machine m = jog_machine();
    for (const double acceleration : {10.0, 100.0, 1500.0}) {
        AxisLimits limits = jog_limits(m.guard.jog, m.axes[kZ]);
        limits.acceleration_max = acceleration;
        constexpr double kStepS = 1e-7;
        double a = acceleration, speed = a * kStepS, way = 0;
        while (speed > 0) {
            a = std::max(a - limits.jerk_max * kStepS, -limits.stopping_min);
            speed += a * kStepS;
            way += speed * kStepS;
        }
        EXPECT_NEAR(jog_turn_reach(limits), way, 1e-3 * way + 1e-6) << acceleration;
    }
}

/// Snapshots of a jog, sample by sample.
class JogWatchTest : public testing::Test {
  protected:
    JogWatchTest() {
        for (std::uint32_t i = 0; i < m.axes.size(); ++i) {
            errors[i] = sample_errors(m, i, 0);
        }
        snapshot.axis_count = 5;
        snapshot.tool = 1;
        put_jog(kUp, snapshot);
    }
    bool next(double z_mm, std::uint64_t samples = 1) {
        snapshot.sample += samples;
        snapshot.position[kZ] = z_mm;
        return watch.note(m, snapshot, errors, snapshot.sample == 1);
    }

    Machine m = jog_machine();
    std::array<SampleErrors, kAxesMax> errors;
    AxisSnapshot snapshot;
    JogWatch watch;
};

TEST_F(JogWatchTest, AJogThatKeepsToItIsOn) {
    EXPECT_TRUE(next(0));
    EXPECT_EQ(watch.move(), kUp);
    for (int i = 1; i <= 1000; ++i) {
        EXPECT_TRUE(next(5e-3 * i)) << i;
    }
    EXPECT_TRUE(next(5e-3 * 1003, 3)) << "lost samples take their time";
    snapshot.mode = kModeStandstill;
    EXPECT_TRUE(next(5));
    EXPECT_FALSE(watch.is_on());
}

TEST_F(JogWatchTest, AnotherAxisMayNotMove) {
    for (const std::uint32_t axis : {kX, kA, kC}) {
        for (const double sign : {-1.0, 1.0}) {
            snapshot.sample = 0;
            snapshot.position = {};
            EXPECT_TRUE(next(0));
            const double most = 2 * errors[axis].position;
            snapshot.position[axis] = sign * 0.99 * most;
            EXPECT_TRUE(next(0)) << axis;
            snapshot.position[axis] = sign * 1.01 * most;
            EXPECT_FALSE(next(0)) << axis;
            snapshot.position[axis] = 0;
            EXPECT_FALSE(next(0)) << "not before the jog has ended";
        }
    }
    snapshot.mode = kModeStandstill;
    EXPECT_TRUE(next(0));
    put_jog(kUp, snapshot);
    EXPECT_TRUE(next(0));
}

TEST_F(JogWatchTest, ItsAxisMayNotGoBack) {
    EXPECT_TRUE(next(0));
    EXPECT_TRUE(next(0.005));
    EXPECT_TRUE(next(0.0031));
    EXPECT_FALSE(next(0.0029)) << "further than two errors of 1 um";
}

TEST_F(JogWatchTest, NegativeIsTheOtherWay) {
    put_jog(kDown, snapshot);
    EXPECT_TRUE(next(0));
    EXPECT_TRUE(next(-0.005));
    EXPECT_FALSE(next(0.001));
}

// 5 mm/s in 1.01 ms and 20 us of jitter, and two errors of 1 um.
TEST_F(JogWatchTest, ItsAxisMayNotBeTooFast) {
    const double most = 5 * (1.01e-3 + 20e-6) + 2e-3;
    EXPECT_TRUE(next(0));
    EXPECT_TRUE(next(0.999 * most));
    EXPECT_FALSE(next(2.001 * most));
}

TEST_F(JogWatchTest, AnEndlessAxisGoesOnPastATurn) {
    put_jog({kC, true}, snapshot);
    const double step = 1.9e-3 * kTestRadPerDegree;
    double at = 0.01;
    snapshot.position[kC] = at;
    EXPECT_TRUE(next(0));
    for (int i = 0; i < 2000; ++i) {
        at -= step;
        snapshot.position[kC] = at - 2 * kPi * std::floor(at / (2 * kPi));
        ASSERT_TRUE(next(0)) << i;
    }
    snapshot.position[kC] += 2 * step;
    EXPECT_FALSE(next(0));
}

TEST_F(JogWatchTest, EverythingStandsWhereItBegins) {
    snapshot.mode = kModeMoving;
    EXPECT_TRUE(next(0));
    snapshot.position[kX] = 0.01;
    put_jog(kUp, snapshot);
    EXPECT_FALSE(next(0));
    put_jog(kDown, snapshot);
    EXPECT_TRUE(next(0)) << "another jog, and now all stand";
    put_jog(kUp, snapshot);
    EXPECT_FALSE(next(0.004)) << "its own axis, too";
}

TEST_F(JogWatchTest, AnEndlessAxisMayStandOnBothSidesOfItsZero) {
    const double off = 0.9 * errors[kC].position;
    snapshot.mode = kModeStandstill;
    snapshot.position[kC] = 2 * kPi - off;
    EXPECT_TRUE(next(0));
    put_jog(kUp, snapshot);
    snapshot.position[kC] = off;
    EXPECT_TRUE(next(0)) << "it begins";
    snapshot.position[kC] = 2 * kPi - off / 2;
    EXPECT_TRUE(next(0)) << "and goes on";
}

TEST_F(JogWatchTest, AnAxisThatTheMachineDoesNotHaveIsNone) {
    put_jog({5, false}, snapshot);
    EXPECT_FALSE(next(0));
    EXPECT_FALSE(next(0));
    snapshot.position = {};
    put_jog({4, false}, snapshot);
    EXPECT_TRUE(next(0));
}

TEST_F(JogWatchTest, AnotherToolIsNoJog) {
    EXPECT_TRUE(next(0));
    snapshot.tool = 2;
    EXPECT_FALSE(next(0));
}

TEST_F(JogWatchTest, WithoutThePromiseThereIsNoJog) {
    m.guard.jog.is_promised = false;
    EXPECT_TRUE(next(0));
    EXPECT_FALSE(watch.is_on());
    EXPECT_TRUE(next(-1)) << "any motion: the certificate is for any, too";
}

/// A mill over a plate: its tip is 60 mm up at Z 0; margins 0.5 and 2 mm.
class JogCertificateTest : public testing::Test {
  protected:
    JogCertificateTest() : scene(table_and_head_scene()) {
        certificate.emplace(certificate_over(scene, m));
        snapshot.axis_count = 5;
        snapshot.tool = 1;
    }

    /// One cycle with the tip so far above the plate; where a jog begins, the one before it too.
    CycleResult cycle(double gap_mm, JogMove jog = {}, bool ready = true) {
        const bool begins = jog.axis != kNoIndex && (snapshot.sample == 0 || !(jog == move));
        if (begins) {
            const CycleResult first = one_cycle(gap_mm, jog, ready);
            EXPECT_FALSE(first.has_permit);
            if (first.is_stop) {
                return first;
            }
        }
        return one_cycle(gap_mm, jog, ready);
    }
    CycleResult one_cycle(double gap_mm, JogMove jog, bool ready = true) {
        move = jog;
        ++snapshot.sample;
        snapshot.mode = kModeStandstill;
        snapshot.flags = 0;
        if (jog.axis != kNoIndex) {
            put_jog(jog, snapshot);
        }
        snapshot.position[kZ] = gap_mm - 60;
        certificate->note(snapshot, snapshot.sample == 1);
        certificate->prove(engine, scene.containment_test());
        certificate->keep();
        const CycleResult result = judge(certificate->cycle(), ready, was_permitted);
        was_permitted = was_permitted || result.has_permit;
        reason = result.is_stop ? result.reason : reason;
        return result;
    }

    Machine m = jog_machine();
    ContainmentScene scene;
    Engine engine = scene.engine().engine();
    std::optional<StopCertificate> certificate;
    AxisSnapshot snapshot;
    JogMove move{};
    bool was_permitted = false;  // and so armed
    StopReason reason = StopReason::none;
};

/// Tests no rung: says so, or says nothing and leaves the results as they are.
struct EngineWithoutLadder {
    CpuEngine* engine;
    bool is_silent;

    static void run(void* self, std::span<const Query> queries,
                    std::span<QueryResult> results) noexcept {
        const auto& fake = *static_cast<EngineWithoutLadder*>(self);
        if (queries.back().mesh_a == queries.back().mesh_b) {  // boxes, and the known-answer test
            fake.engine->run(queries, results);
        } else if (!fake.is_silent) {
            std::fill(results.begin(), results.end(),
                      QueryResult{.status = QueryStatus::too_many_node_pairs});
        }
    }
};

TEST_F(JogCertificateTest, WithinTheMarginAwayIsPermittedAndNothingElse) {
    for (int i = 0; i < 5; ++i) {
        const CycleResult up = cycle(0.3, kUp);
        EXPECT_TRUE(up.has_permit && up.is_jog) << i;
    }
    const CycleResult free = cycle(0.3);
    EXPECT_TRUE(free.is_stop);
    EXPECT_EQ(free.reason, StopReason::predicted);
    EXPECT_FALSE(free.is_jog);
    EXPECT_TRUE(cycle(0.3, kUp).has_permit);
}

// Towards the plate, and not proven: a person may choose another jog before anything moves.
TEST_F(JogCertificateTest, TheWrongWayIsWithheldWithoutAStop) {
    for (int i = 0; i < 40; ++i) {
        const CycleResult down = cycle(0.3, kDown);
        EXPECT_FALSE(down.has_permit || down.is_stop) << i;
        EXPECT_EQ(down.reason, StopReason::predicted);
    }
    EXPECT_TRUE(cycle(0.3, kUp).has_permit);
    EXPECT_TRUE(cycle(0.3, kDown).is_stop) << "in the middle of it, it is one";
}

// What a report says of it: the pair has to keep what it has, not its margin of 0.5 mm.
TEST_F(JogCertificateTest, WhyItIsWithheldCountsFromTheClearanceToKeep) {
    ASSERT_FALSE(cycle(0.3, kDown).has_permit);
    const UnprovenPair pair = unproven_pair(m, *certificate, 0);
    ASSERT_TRUE(pair.is_known);
    EXPECT_TRUE(pair.is_jog && pair.is_whole);
    const DistanceNeed need = distance_need(m, pair);
    EXPECT_NEAR(need.margin_mm, 0.3 - kJogGiveMm, 0.01 + 0.5 / kJogRungs);
    EXPECT_NEAR(available_mm(m, engine, pair, 50), 0.3, 1e-3);
    EXPECT_GT(need.sum_mm(), 0.3);
    EXPECT_LT(need.sum_mm(), 0.5);
    EXPECT_EQ(need.braking_mm + need.position_error_mm + need.speed_uncertainty_mm, 0);
    EXPECT_FALSE(find_remedies(m, engine, pair, {}).margin_mm) << "nobody can lower it";
}

TEST_F(JogCertificateTest, NearerThanItBeganItStops) {
    const double reach = jog_reach(jog_limits(m.guard.jog, m.axes[kZ]), free_seconds(m, 3));
    EXPECT_LT(reach, 0.1);
    // Down from afar: the margin is what is kept.
    double gap = 1;
    while (gap > 0.5 && cycle(gap, kDown).has_permit) {
        gap -= 0.004;
    }
    EXPECT_EQ(reason, StopReason::predicted);
    EXPECT_GT(gap, 0.5 + reach - 0.005);
    EXPECT_LT(gap, 0.5 + reach + 0.02);
}

TEST_F(JogCertificateTest, WhatItBeganWithIsKeptUntilAnotherJogBegins) {
    EXPECT_TRUE(cycle(0.3, kUp).has_permit);
    // As if it fell back, slower than anybody can tell: the clearance at the beginning counts.
    double gap = 0.3;
    while (cycle(gap, kUp).has_permit) {
        gap -= 0.0001;
    }
    EXPECT_NEAR(gap, 0.298, 1e-3) << "the watch finds it first";
    EXPECT_EQ(reason, StopReason::left_jog);
    EXPECT_STREQ(to_text(reason), "left_jog");
}

// What a pair keeps is what it has where this jog begins. The jog before began nearer: with its
// floor the way back into the margin would be permitted.
TEST_F(JogCertificateTest, AnotherJogKeepsWhatThereIsWhereItBegins) {
    double gap = 0.3;
    ASSERT_TRUE(cycle(gap, kUp).has_permit);
    const double floor_mm = certificate->tasks()[0].margin_mm;
    EXPECT_NEAR(floor_mm, 0.3 - kJogGiveMm, 0.01 + 0.5 / kJogRungs);
    while (gap < 0.45) {
        gap += 0.004;
        ASSERT_TRUE(cycle(gap, kUp).has_permit) << gap;
    }
    gap += 0.0015;  // it slows down to rest within its acceleration
    ASSERT_TRUE(cycle(gap, kUp).has_permit);
    EXPECT_EQ(certificate->tasks()[0].margin_mm, floor_mm) << "the same jog";
    EXPECT_FALSE(cycle(gap, kDown).has_permit);
    EXPECT_NEAR(certificate->tasks()[0].margin_mm, gap - kJogGiveMm, 0.01 + 0.5 / kJogRungs);
}

TEST(JogLadder, IsFineNextToTheFloorInForceAndReachesAllOfTheMargin) {
    for (const double margin : {0.0, 0.3, 0.8, 2.0, 25.0}) {
        for (const double before : {kNoJogFloor, 0.0, 0.2 * margin, margin}) {
            const auto rungs = jog_ladder(margin, before);
            const double low = std::max(0.0, before);
            EXPECT_EQ(rungs[0], margin);
            for (std::uint32_t i = 1; i <= kJogRungs; ++i) {
                const double below = i < kJogRungs ? rungs[i] : low;
                const bool is_fine = before == kNoJogFloor ? i <= kJogRungs / 2 : i > kJogRungs / 2;
                const double gap = rungs[i - 1] - below;
                EXPECT_GE(gap, -1e-12) << margin << ' ' << before << ' ' << i;
                EXPECT_LE(gap, is_fine ? kJogRungMm + 1e-12
                                       : std::max(kJogRungMm, (margin - low) / 8) + 1e-12)
                    << margin << ' ' << before << ' ' << i;
            }
        }
    }
}

// The floor of a ladder against the one of the exact clearance, the same errors in both.
TEST_F(JogCertificateTest, FloorsAreARungBelowWhatAClearanceGivesAtMost) {
    double most_lost_mm = 0;
    for (double gap = 0.01; gap < 3; gap += 0.0137) {
        certificate.emplace(certificate_over(scene, m));
        snapshot.sample = 0;
        cycle(gap, kUp);
        const PairProof& proof = certificate->cycle().proofs[0];
        ASSERT_EQ(proof.pair, 0U);
        // Of Z alone, and of the axes that do not move the mill against the plate nothing.
        const double errors_mm = certificate->held_error(kZ);
        const double exact_mm = jog_floor_mm(m.pairs[0].margin_mm, gap, errors_mm);
        const double floor_mm = certificate->tasks()[0].margin_mm;
        EXPECT_LE(floor_mm, exact_mm + 1e-3) << gap;
        EXPECT_GE(floor_mm, exact_mm - 1e-2 - m.pairs[0].margin_mm / kJogRungs) << gap;
        most_lost_mm = std::max(most_lost_mm, exact_mm - floor_mm);
    }
    EXPECT_GT(most_lost_mm, 0.5 * m.pairs[0].margin_mm / kJogRungs) << "a ladder has rungs";
}

// Down as far as it goes, up, and down again: with a floor of its own each jog would lose what
// errors may feign, and a rung.
TEST_F(JogCertificateTest, JogsBackAndForthLoseNothing) {
    m.guard.jog.speed_mm_s = 1;  // slow, so that a lower floor would be made use of
    m.guard.jog.acceleration_mm_s2 = 100;
    double gap = 0.3, floor_mm = 0;
    for (int i = 0; i < 40; ++i) {
        ASSERT_TRUE(cycle(gap, kUp).has_permit) << i << ' ' << gap;
        EXPECT_GE(certificate->tasks()[0].margin_mm, floor_mm) << i;
        floor_mm = i == 0 ? certificate->tasks()[0].margin_mm : floor_mm;
        while (cycle(gap, kDown).has_permit) {
            EXPECT_GE(certificate->tasks()[0].margin_mm, floor_mm) << i;
            gap -= 0.0005;
        }
    }
    EXPECT_GT(floor_mm, 0.2);
    EXPECT_GT(gap, floor_mm);
    EXPECT_LT(gap, 0.3) << "nothing was lost because nothing moved";
}

// Moved without a permit, nearer to the plate: no certificate led there, so a person did.
TEST_F(JogCertificateTest, AMachineThatAPersonFreedBeginsAnew) {
    ASSERT_TRUE(cycle(0.3, kUp).has_permit);
    const double floor_mm = certificate->tasks()[0].margin_mm;
    for (double gap = 0.3; gap > 0.15; gap -= 0.001) {
        EXPECT_FALSE(cycle(gap).has_permit) << "moved by hand";
    }
    EXPECT_TRUE(cycle(0.15, kUp).has_permit);
    EXPECT_LT(certificate->tasks()[0].margin_mm, floor_mm);
}

// A ladder that was not tested is no floor of 0, nor the one found last: there is none to keep.
TEST_F(JogCertificateTest, WithoutALadderNoJogIsPermitted) {
    for (const bool is_silent : {false, true}) {
        snapshot.sample = 0;
        was_permitted = false;
        engine = scene.engine().engine();
        ASSERT_TRUE(cycle(1, kUp).has_permit);
        ASSERT_TRUE(cycle(1, kDown).has_permit) << "afar another jog is no stop";
        EngineWithoutLadder without{&scene.engine(), is_silent};
        engine = {&without, EngineWithoutLadder::run};
        EXPECT_FALSE(cycle(1, kUp).has_permit) << is_silent;
    }
}

// A pair is a group of the ladder: with no place in any list it has no floor.
TEST_F(JogCertificateTest, WithoutRoomForItsLadderNoJogIsPermitted) {
    m.plan = default_plan(m, stop_tasks(m));
    m.plan->lists = {};
    certificate.emplace(certificate_over(scene, m));
    EXPECT_FALSE(cycle(0.3, kUp).has_permit);
    m.plan = default_plan(m, stop_tasks(m));
    certificate.emplace(certificate_over(scene, m));
    snapshot.sample = 0;
    EXPECT_TRUE(cycle(0.3, kUp).has_permit);
}

/// Counts the calls that are ladders, and their queries.
struct LadderCount {
    CpuEngine* engine;
    std::uint32_t calls = 0, queries = 0, groups = 0;
    WorkLists share{};  // of the first group

    static void run(void* self, std::span<const Query> queries,
                    std::span<QueryResult> results) noexcept {
        static_cast<LadderCount*>(self)->engine->run(queries, results);
    }
    static void run_groups(void* self, std::span<const Query> queries,
                           std::span<QueryResult> results, std::span<GroupWork> groups) noexcept {
        auto& count = *static_cast<LadderCount*>(self);
        if (queries.back().mesh_a != queries.back().mesh_b) {
            ++count.calls;
            count.queries += static_cast<std::uint32_t>(queries.size());
            count.groups = static_cast<std::uint32_t>(groups.size());
            count.share = groups[0].share;
        }
        count.engine->run(queries, results, groups);
    }
};

TEST_F(JogCertificateTest, ALadderIsAskedOfPairsWithinTheirMarginAlone) {
    LadderCount count{&scene.engine()};
    engine = {.self = &count, .run = LadderCount::run, .run_groups = LadderCount::run_groups};
    ASSERT_TRUE(cycle(3, kUp).has_permit);
    EXPECT_EQ(count.queries, 2U) << "the margins of two pairs";
    EXPECT_EQ(count.groups, 2U);
    ASSERT_TRUE(cycle(3, kUp).has_permit);
    EXPECT_EQ(count.calls, 1U) << "floors are found where the jog begins";
    count = {&scene.engine()};
    snapshot.sample = 0;
    ASSERT_TRUE(cycle(0.3, kUp).has_permit);
    EXPECT_EQ(count.calls, 2U);
    EXPECT_EQ(count.queries, 2 + kJogRungs - 1) << "and the rungs of one";
    EXPECT_EQ(count.groups, 1U) << "which is a group";
}

// A ladder takes the place of a proof, whose bound it must not exceed: its groups share the lists
// that the plan has for it.
TEST_F(JogCertificateTest, ALadderHasTheSharesOfItsLists) {
    m.plan = default_plan(m, stop_tasks(m));
    certificate.emplace(certificate_over(scene, m));
    LadderCount count{&scene.engine()};
    engine = {.self = &count, .run = LadderCount::run, .run_groups = LadderCount::run_groups};
    ASSERT_TRUE(cycle(3, kUp).has_permit);
    ASSERT_EQ(count.groups, 2U);
    EXPECT_EQ(count.share, share_of(jog_lists(*m.plan).margins, 2));
    snapshot.sample = 0;
    ASSERT_TRUE(cycle(0.3, kUp).has_permit);
    ASSERT_EQ(count.groups, 1U);
    EXPECT_EQ(count.share, share_of(jog_lists(*m.plan).rungs, 1));
}

// What finds the floors takes as long as a proof: it is the whole of that cycle, which is neither a
// permit nor a stop.
TEST_F(JogCertificateTest, WhereAJogBeginsNothingIsProven) {
    LadderCount count{&scene.engine()};
    engine = {.self = &count, .run = LadderCount::run, .run_groups = LadderCount::run_groups};
    ASSERT_TRUE(cycle(3).is_stop || !was_permitted);
    for (const JogMove& jog : {kUp, kDown, kUp}) {
        count = {&scene.engine()};
        const CycleResult first = one_cycle(3, jog);
        EXPECT_FALSE(first.has_permit || first.is_stop);
        EXPECT_EQ(first.reason, StopReason::none);
        EXPECT_TRUE(certificate->cycle().begins_jog);
        EXPECT_FALSE(certificate->cycle().is_settled) << "no permit is missed";
        EXPECT_TRUE(certificate->cycle().proofs.empty());
        EXPECT_EQ(certificate->work().queries, 0U) << "the known-answer test alone";
        EXPECT_EQ(certificate->containment_tests(), 0U);
        EXPECT_EQ(count.calls, 1U);
        certificate->prove(engine, scene.containment_test());
        EXPECT_TRUE(certificate->cycle().begins_jog) << "the same for the same snapshot";
        EXPECT_EQ(count.calls, 2U);
        const CycleResult second = one_cycle(3, jog);
        EXPECT_TRUE(second.has_permit && second.is_jog);
        EXPECT_EQ(count.calls, 2U) << "the floors are known";
        EXPECT_FALSE(certificate->cycle().begins_jog);
    }
}

// Where the floors are not found, it counts as any motion that is not proven.
TEST_F(JogCertificateTest, WhereNoFloorIsFoundItIsNotProven) {
    EngineWithoutLadder without{&scene.engine(), false};
    engine = {&without, EngineWithoutLadder::run};
    const CycleResult first = one_cycle(1, kUp);
    EXPECT_FALSE(certificate->cycle().begins_jog);
    EXPECT_EQ(first.reason, StopReason::predicted);
}

TEST_F(JogCertificateTest, OutOfAContactNothingIsPermitted) {
    for (const double gap_mm : {0.0, -0.5}) {
        snapshot.sample = 0;
        for (int i = 0; i < 3; ++i) {
            EXPECT_FALSE(cycle(gap_mm, kUp).has_permit) << gap_mm;
        }
    }
    snapshot.sample = 0;
    EXPECT_TRUE(cycle(0.005, kUp).has_permit) << "5 um are enough to get away";
}

// The other axes are held: the box has the errors of theirs, and no motion.
TEST_F(JogCertificateTest, OneAxisMovesOneWay) {
    m.axes[kX].following_error = 0.01;
    cycle(0.3, kUp);
    const JointBox& box = certificate->tasks()[0].box;
    EXPECT_NEAR(box.half[kX], 0.001 + 2 * 0.01, 1e-9) << "off one way now, the other way later";
    EXPECT_NEAR(box.centre[kX], 0, 1e-12);
    const double reach = jog_reach(jog_limits(m.guard.jog, m.axes[kZ]), free_seconds(m, 3));
    EXPECT_NEAR(box.centre[kZ] - box.half[kZ], -59.7 - 0.001, 1e-9);
    EXPECT_NEAR(box.centre[kZ] + box.half[kZ], -59.7 + 0.001 + reach, 1e-9);
    EXPECT_NEAR(certificate->tasks()[0].margin_mm, 0.3 - 3 * (0.021 + 0.001) - kJogGiveMm,
                5e-3 + 0.5 / kJogRungs);
}

}  // namespace
}  // namespace axg::test
