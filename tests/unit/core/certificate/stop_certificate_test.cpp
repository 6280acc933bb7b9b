// SPDX-License-Identifier: Apache-2.0
// What a certificate queries: boxes from snapshots, both tools while one is changed, containment
// where the last proof does not cover the new position, and the horizon by hand.
#include "core/certificate/stop_certificate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/certificate/pose_error.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

class StopCertificateTest : public testing::Test {
  protected:
    StopCertificateTest()
        : scene({{"table", box({-50, -50, -10}, {50, 50, 0})},
                 {"head", box({-20, -20, 120}, {20, 20, 200})},
                 {"", {}},
                 {"short", box({-2, -2, 100}, {2, 2, 120})},
                 {"long", box({-2, -2, 60}, {2, 2, 120})},
                 known_answer_mesh()}) {
        counting = {this, [](void* self, std::span<const Query> queries,
                             std::span<QueryResult> results) noexcept {
                        auto& test = *static_cast<StopCertificateTest*>(self);
                        test.query_count += queries.size();
                        ++test.batches;
                        test.scene.engine().run(queries, results);
                    }};
    }

    void make() {
        certificate.reset();
        certificate.emplace(certificate_over(scene, m));
        sample = 0;
    }

    void note(double x, double z, std::uint8_t mode = kModeMoving, std::uint16_t tool = 1) {
        AxisSnapshot snapshot;
        snapshot.sample = ++sample;
        snapshot.axis_count = 5;
        snapshot.tool = tool;
        snapshot.mode = mode;
        snapshot.position[0] = x;
        snapshot.position[2] = z;
        certificate->note(snapshot, sample == 1);
    }
    void stand(double x, double z, std::uint32_t snapshots = kSamplesKept) {
        for (std::uint32_t i = 0; i < snapshots; ++i) {
            note(x, z);
        }
    }
    void prove() {
        query_count = batches = 0;
        certificate->prove(counting, scene.containment_test());
    }
    [[nodiscard]] std::uint64_t containment_tests() const {
        EXPECT_EQ(query_count, certificate->work().queries + 2U * certificate->work().calls)
            << "the proof of the box is enough: no engine is asked about the pose";
        return certificate->containment_tests();
    }
    [[nodiscard]] bool all_proven() const {
        bool all = certificate->cycle().status == SnapshotStatus::ok;
        for (const PairProof& proof : certificate->cycle().proofs) {
            all = all && proof.surfaces.proof == JointBoxProof::proven &&
                  proof.containment_result.containment == Containment::none;
        }
        return all;
    }

    Machine m = table_and_head_machine();
    ContainmentScene scene;
    Engine counting;
    std::uint64_t query_count = 0, batches = 0, sample = 0;
    std::optional<StopCertificate> certificate;
};

// 3 periods of 1.01 ms, 20 us of jitter, 2 ms of board.
TEST_F(StopCertificateTest, TheHorizonIsTheSumOfItsParts) {
    EXPECT_NEAR(free_seconds(m, 3), 3 * 1.01e-3 + 20e-6 + 2e-3, 1e-12);
    m.guard.board_reaction_s = 1e-3;
    m.can.sample_us = 500;
    EXPECT_NEAR(free_seconds(m, 4), 4 * 0.505e-3 + 20e-6 + 1e-3, 1e-12);
    m.can.format = CanFormat::signals;  // the instant of a sample is known to two periods
    EXPECT_NEAR(free_seconds(m, 4), 4 * 0.505e-3 + 1005e-6 + 1e-3, 1e-12);
}

// A value a period old is as old as the longest period; two values of any age in the range differ
// by it once more, and the horizon has that no second time.
TEST_F(StopCertificateTest, TheAgeOfAPositionIsInTheHorizonAndItsSpreadInTheJitter) {
    m.can.latched_age = {400, 1000};
    EXPECT_NEAR(free_seconds(m, 3), 3 * 1.01e-3 + 20e-6 + 2e-3 + 1.01e-3, 1e-12);
    EXPECT_NEAR(sample_errors(m, 0, 0).latch_jitter_s, 20e-6 + 0.606e-3, 1e-12);
    m.can.latched_age = {1000, 1000};  // always the value of the SYNC before
    EXPECT_NEAR(free_seconds(m, 3), 3 * 1.01e-3 + 20e-6 + 2e-3 + 1.01e-3, 1e-12);
    EXPECT_NEAR(sample_errors(m, 0, 0).latch_jitter_s, 20e-6, 1e-12);
}

TEST_F(StopCertificateTest, ErrorsOfAPositionAddUp) {
    m.axes[0].following_error = 0.03;
    const SampleErrors errors = sample_errors(m, 0, 0.0005);
    EXPECT_NEAR(errors.position, 0.001 + 0.03 + 0.0005, 1e-12);
    EXPECT_EQ(errors.period_s, 1e-3);
    EXPECT_TRUE(errors.is_jerk_limited);
}

// What simplified surfaces lose counts in every query of a pair, of a tool by its slot.
TEST_F(StopCertificateTest, TheDeviationsOfBothSurfacesCount) {
    m.bodies[kTable].mesh.deviation_mm = 0.25;
    m.bodies[kHead].mesh.deviation_mm = 0.5;
    m.tools[0].mesh.deviation_mm = 1;
    m.tools[1].mesh.deviation_mm = 2;
    const std::vector<BodyExtent> extents(scene.meshes().size());
    EXPECT_DOUBLE_EQ(pair_task(m, 0, 1, extents).pose_error_mm, kPlacementErrorMm + 2 + 0.25);
    EXPECT_DOUBLE_EQ(pair_task(m, 1, kNoIndex, extents).pose_error_mm,
                     kPlacementErrorMm + 0.5 + 0.25);
}

// Stated errors count in every query of a pair; where nobody computed them, nothing is far.
TEST_F(StopCertificateTest, StatedErrorsCountOrNothingIsProven) {
    const std::vector<BodyExtent> extents(scene.meshes().size());
    m.pose_errors = {.are_stated = true, .mm = {0.5, 0.25}, .within = {}};
    ASSERT_EQ(m.pairs.size(), 2U);
    EXPECT_DOUBLE_EQ(pair_task(m, 0, 1, extents).pose_error_mm, kPlacementErrorMm + 0.5);
    EXPECT_DOUBLE_EQ(pair_task(m, 1, kNoIndex, extents).pose_error_mm, kPlacementErrorMm + 0.25);
    m.pose_errors.mm.pop_back();
    EXPECT_EQ(pair_task(m, 0, 1, extents).pose_error_mm, std::numeric_limits<double>::infinity());
}

// A gantry may place what it carries elsewhere than its middle: in no pair that it does not move.
TEST_F(StopCertificateTest, TheSkewOfAGantryCountsWhereItMoves) {
    const auto error = [this] {
        return pose_error_mm(m, m.pairs[0], 1, BodyExtent{}, BodyExtent{}, error_range(m));
    };
    const auto axis_of = [this](std::uint32_t body) { return m.bodies[body].joint.axis; };
    for (Axis& axis : m.axes) {
        axis.following_error = axis.position_error = 0;
    }
    EXPECT_EQ(error(), 0);
    m.axes[axis_of(kTable)].skew_mm = 0.125;
    EXPECT_NEAR(error(), 0.125, 1e-12);
    m.axes[axis_of(kHead)].skew_mm = 0.0625;
    EXPECT_NEAR(error(), 0.1875, 1e-12);
    m.bodies[kTable].parent = kNoIndex;
    m.bodies[kTable].joint.axis = kNoIndex;
    EXPECT_NEAR(error(), 0.0625, 1e-12);
    m.axes[axis_of(kHead)].following_error = 0.02;  // of each joint
    m.axes[axis_of(kHead)].position_error = 0.001;
    EXPECT_NEAR(error(), 0.0625 + 0.042, 1e-12);
}

// The box is what the reach of each axis says, around the newest position; an axis at rest moves
// little, one whose jerk may jump gets far.
TEST_F(StopCertificateTest, TheBoxHoldsTheReachOfEveryAxis) {
    make();
    stand(10, 0);
    const JointBox box = certificate->reach(3);
    const Axis& x = m.axes[0];
    MotionHistory history;
    for (std::uint64_t k = 1; k <= kSamplesKept; ++k) {
        AxisSnapshot snapshot;
        snapshot.sample = k;
        snapshot.position[0] = 10;
        note_snapshot(history, snapshot, 1);
    }
    const ReachRange reach = stop_reach(
        stop_limits(m, 0), range_of(history, 0, x, sample_errors(m, 0, 0)), free_seconds(m, 3));
    EXPECT_LE(box.centre[0] - box.half[0], reach.low);
    EXPECT_GE(box.centre[0] + box.half[0], reach.high);
    EXPECT_NEAR(box.half[0], reach.high - 10, 1e-6);
    EXPECT_LT(box.half[0], 1);
    m.guard.free_jerk_limited = false;
    make();
    stand(10, 0);
    const double half = certificate->reach(3).half[0];
    EXPECT_GT(half, 2);
    lab::forget_jerk_ramp(m);
    make();
    stand(10, 0);
    EXPECT_LT(certificate->reach(3).half[0], 0.8 * half) << "the ablation is smaller, or is none";
}

// An enforced cap: an axis at rest gets less far, one at hold nowhere, and a bound beyond rapid
// bounds nothing.
TEST_F(StopCertificateTest, ABoundOfTheSpeedsEndsTheBox) {
    m.guard.free_jerk_limited = false;
    make();
    stand(10, 0);
    const JointBox free = certificate->reach(3);
    std::vector<double> speeds;
    for (const Axis& axis : m.axes) {
        speeds.push_back(2 * axis.speed_max);
    }
    certificate->bound_speeds(speeds);
    EXPECT_EQ(certificate->reach(3).half, free.half);
    speeds[0] = m.axes[0].speed_max / 250;
    certificate->bound_speeds(speeds);
    const JointBox crawl = certificate->reach(3);
    EXPECT_LT(crawl.half[0], 0.1 * free.half[0]);
    EXPECT_EQ(crawl.half[2], free.half[2]);
    speeds[0] = 0;
    certificate->bound_speeds(speeds);
    const double errors = sample_errors(m, 0, 0).position;
    EXPECT_NEAR(certificate->reach(3).half[0], errors, 1e-9);
    EXPECT_GE(certificate->reach(3).half[0], errors);
}

TEST_F(StopCertificateTest, AnAxisSwingsAboutItsCappedCommands) {
    Axis axis = m.axes[0];
    axis.speed_max = 500;
    axis.acceleration_max = 4000;
    axis.following_error = 0;
    EXPECT_NEAR(capped_speed(axis, 0.1), 50, 1e-6);
    axis.following_error = 0.01;
    EXPECT_NEAR(capped_speed(axis, 0.1), 50 + 17.889, 1e-3);
    EXPECT_EQ(capped_speed(axis, 0.99), 500);
}

// Only where the board never leaves the travel may the box end there.
TEST_F(StopCertificateTest, TheTravelEndsTheBoxOnlyIfTheBoardEnforcesIt) {
    make();
    stand(m.axes[0].max, 0);
    EXPECT_GT(certificate->reach(3).centre[0] + certificate->reach(3).half[0], m.axes[0].max + 0.1);
    m.guard.travel_enforced = true;
    const JointBox box = certificate->reach(3);
    EXPECT_NEAR(box.centre[0] + box.half[0], m.axes[0].max + 0.001, 1e-6);
    EXPECT_GT(box.half[4], 0) << "an endless axis has no travel to end at";
}

// An enforced travel ends the box, but no sooner than the errors of a position, and never where the
// axis is: a box without the present place proves nothing about it.
TEST_F(StopCertificateTest, AnEnforcedTravelNeverEndsBeforeThePresentPlace) {
    m.guard.travel_enforced = true;
    for (const double beyond : {0.0, 0.01}) {
        make();
        stand(m.axes[0].max + beyond, m.axes[2].min - beyond);
        const JointBox box = certificate->reach(3);
        const double high = box.centre[0] + box.half[0], low = box.centre[2] - box.half[2];
        EXPECT_NEAR(high, m.axes[0].max + beyond + 0.001, 1e-6);
        EXPECT_NEAR(low, m.axes[2].min - beyond - 0.001, 1e-6);
        EXPECT_GE(high, certificate->now(0).high);
        EXPECT_LE(low, certificate->now(2).low);
    }
}

TEST_F(StopCertificateTest, ALostSampleWidensTheBox) {
    make();
    for (int i = 0; i < 30; ++i) {
        note(0.1 * i, 0);
    }
    const double before = certificate->reach(3).half[0];
    sample += 2;
    note(3.2, 0);
    EXPECT_GT(certificate->reach(3).half[0], before);
}

TEST_F(StopCertificateTest, OneSnapshotQueriesTheKnownAnswerTestAlone) {
    make();
    note(0, 0);
    prove();
    EXPECT_EQ(query_count, 2U);
    EXPECT_EQ(certificate->cycle().known_answer_signature, kKnownAnswerSignature);
    ASSERT_EQ(certificate->cycle().proofs.size(), 2U);
    EXPECT_EQ(certificate->cycle().proofs[0].surfaces.proof, JointBoxProof::budget_spent);
    EXPECT_FALSE(certificate->cycle().is_settled);
    stand(0, 0, kSamplesKept - 1);
    EXPECT_TRUE(certificate->cycle().is_settled);
}

TEST_F(StopCertificateTest, ContainmentIsTestedAtTheStartAndWhenThePositionLeavesTheProvenBox) {
    m.axes[0].speed_max = 1e6;  // so that the box is wide after samples were lost
    m.plan = plan_of(1, stop_tasks(m), 0, {512, 512, 2048, 4096, 0});  // and is not cut
    make();
    stand(0, 0);
    prove();
    EXPECT_TRUE(all_proven());
    EXPECT_EQ(containment_tests(), 2U) << "at the start";
    prove();
    EXPECT_EQ(containment_tests(), 2U) << "nothing was kept: the same again";
    certificate->keep();
    note(0.001, 0);
    prove();
    EXPECT_EQ(containment_tests(), 0U);
    certificate->keep();
    sample += 5000;
    note(20, 0);
    prove();
    EXPECT_FALSE(all_proven());
    EXPECT_EQ(containment_tests(), 0U) << "not proven: nothing to look into";
    certificate->keep();
    stand(20, 0);
    prove();
    EXPECT_EQ(containment_tests(), 2U) << "what was not proven has no box";
}

// Only in the box proven last is the result of its containment test known: a hair outside of it the
// pair is tested again, on either side and along each of its joints.
TEST_F(StopCertificateTest, ContainmentIsTestedAnywhereOutsideTheProvenBox) {
    for (const std::uint32_t axis : {0U, 2U}) {
        for (const double sign : {-1.0, 1.0}) {
            for (const double share : {0.99, 1.01, 1.9}) {
                make();
                stand(0, 0);
                prove();
                certificate->keep();
                const JointBox proven = certificate->tasks()[0].box;
                const double at = proven.centre[axis] + sign * share * proven.half[axis];
                sample += 100;  // lost: no speed contradicts the way to there
                note(axis == 0 ? at : 0, axis == 2 ? at : 0);
                prove();
                EXPECT_TRUE(all_proven()) << axis << ' ' << at;
                EXPECT_EQ(containment_tests(), share < 1 ? 0U : 2U) << axis << ' ' << at;
            }
        }
    }
}

TEST_F(StopCertificateTest, ThePositionIsLookedForInTheBoxOfThePairsOwnJoints) {
    make();
    stand(0, 0);
    prove();
    certificate->keep();
    for (std::uint32_t i = 0; i < 40; ++i) {
        note(0, 0);
    }
    AxisSnapshot snapshot;
    snapshot.sample = sample += 100;  // lost: no speed contradicts the way to there
    snapshot.axis_count = 5;
    snapshot.tool = 1;
    snapshot.position[1] = 0.5;  // Y moves no body of this machine
    certificate->note(snapshot, false);
    prove();
    EXPECT_EQ(certificate->cycle().status, SnapshotStatus::ok);
    EXPECT_EQ(containment_tests(), 0U);
}

// The tool that comes next is not announced: while it is changed any may be in the spindle.
TEST_F(StopCertificateTest, EveryToolIsQueriedWhileOneIsChanged) {
    make();
    stand(0, 0);
    prove();
    ASSERT_EQ(certificate->cycle().proofs.size(), 2U);
    EXPECT_EQ(certificate->cycle().proofs[0].tool, 0U);
    EXPECT_EQ(certificate->cycle().proofs[1].tool, kNoIndex);
    note(0, 0, kModeToolChange);
    prove();
    ASSERT_EQ(certificate->cycle().proofs.size(), 3U);
    EXPECT_EQ(certificate->cycle().proofs[1].tool, 1U);
    EXPECT_TRUE(all_proven());
    // 59.5 mm lower the long tool is in the table's margin, the short one far above it.
    sample += 2000;  // lost: the way to there
    for (int i = 0; i < 30; ++i) {
        note(0, -59.7, i == 29 ? kModeToolChange : kModeMoving);
    }
    m.axes[2].speed_max = 1e6;
    prove();
    EXPECT_EQ(certificate->cycle().proofs[0].surfaces.proof, JointBoxProof::proven);
    EXPECT_NE(certificate->cycle().proofs[1].surfaces.proof, JointBoxProof::proven);
    note(0, -59.7, kModeMoving, 9);
    prove();
    EXPECT_EQ(certificate->cycle().status, SnapshotStatus::unknown_tool);
    EXPECT_TRUE(certificate->cycle().proofs.empty());
}

// The number may change without a word, or before the tools do: for as long as a certificate from
// before is in force the last tool counts as well as the next.
TEST_F(StopCertificateTest, BothToolsCountAroundAChangeOfTheNumber) {
    make();
    stand(0, 0);
    const auto tools_queried = [&] {
        prove();
        std::string tools;
        for (const PairProof& proof : certificate->cycle().proofs) {
            tools += proof.tool == kNoIndex ? "" : std::to_string(proof.tool);
        }
        return tools;
    };
    const auto samples = static_cast<int>(std::ceil(free_seconds(m, 3) * 1e6 / m.can.sample_us));
    ASSERT_GE(samples, 3);
    EXPECT_EQ(tools_queried(), "0");
    for (int i = 0; i <= samples; ++i) {
        note(0, 0, kModeMoving, m.tools[1].number);
        EXPECT_EQ(tools_queried(), "01") << i;
    }
    note(0, 0, kModeMoving, m.tools[1].number);
    EXPECT_EQ(tools_queried(), "1");
    note(0, 0, kModeMoving, m.tools[0].number);
    EXPECT_EQ(tools_queried(), "01");
    sample += 100;  // samples were lost, or no permit has been asked for in a while
    note(0, 0, kModeMoving, m.tools[0].number);
    EXPECT_EQ(tools_queried(), "0");
}

TEST_F(StopCertificateTest, EveryToolCountsWhoseNumberWasJustSaid) {
    m.tools.push_back(m.tools[1]);
    m.tools[2].number = 7;
    ContainmentScene three({scene.meshes()[0], scene.meshes()[1], scene.meshes()[2],
                            scene.meshes()[3], scene.meshes()[4], scene.meshes()[4],
                            scene.meshes()[5]});
    certificate.emplace(certificate_over(three, m));
    sample = 0;
    stand(0, 0);
    const auto samples = static_cast<int>(std::ceil(free_seconds(m, 3) * 1e6 / m.can.sample_us));
    note(0, 0, kModeMoving, m.tools[1].number);
    note(0, 0, kModeMoving, m.tools[2].number);
    certificate->prove(three.engine().engine(), three.containment_test());
    EXPECT_EQ(certificate->cycle().proofs.size(), 4U);  // three tools, and the pair without one
    for (int i = 1; i < samples; ++i) {
        note(0, 0, kModeMoving, m.tools[2].number);
    }
    certificate->prove(three.engine().engine(), three.containment_test());
    EXPECT_EQ(certificate->cycle().proofs.size(), 4U);
    note(0, 0, kModeMoving, m.tools[2].number);
    certificate->prove(three.engine().engine(), three.containment_test());
    EXPECT_EQ(certificate->cycle().proofs.size(), 3U);  // the first one's time is over
    note(0, 0, kModeMoving, m.tools[2].number);
    certificate->prove(three.engine().engine(), three.containment_test());
    EXPECT_EQ(certificate->cycle().proofs.size(), 2U);
}

// A receiver that begins anew has no certificate from before.
TEST_F(StopCertificateTest, TheFirstSnapshotHasOneTool) {
    make();
    stand(0, 0);
    AxisSnapshot snapshot = certificate->snapshot();
    snapshot.tool = m.tools[1].number;
    ++snapshot.sample;
    certificate->note(snapshot, true);
    prove();
    ASSERT_EQ(certificate->cycle().proofs.size(), 2U);
    EXPECT_EQ(certificate->cycle().proofs[0].tool, 1U);
}

// The margin is kept everywhere in the box, not at its middle alone.
TEST_F(StopCertificateTest, AStopThatMayEndInTheMarginIsNotProven) {
    make();
    stand(0, 0);
    const double down = certificate->reach(3).half[2];
    for (const double gap : {1.5 * down + 0.1, 0.9 * down}) {
        make();
        stand(0, -100 + 0.5 + gap);
        prove();
        EXPECT_EQ(certificate->cycle().proofs[0].surfaces.proof == JointBoxProof::proven,
                  gap > down)
            << gap;
    }
}

TEST_F(StopCertificateTest, SamplesAreTriedFromALadderThatEndsAtTheMost) {
    const auto up_from = [](PermitSamples range, std::uint8_t samples) {
        std::string steps;
        while (samples != range.most) {
            samples = samples_above(range, samples);
            steps += std::to_string(samples) + ' ';
        }
        return steps;
    };
    EXPECT_EQ(up_from({3, 12}, 3), "4 5 6 8 10 12 ");
    EXPECT_EQ(up_from({3, 15}, 10), "12 15 ");
    EXPECT_EQ(up_from({5, 9}, 5), "6 8 9 ");
    EXPECT_EQ(samples_above({3, 12}, 12), 12);
    EXPECT_EQ(samples_below({3, 12}, 12), 10);
    EXPECT_EQ(samples_below({3, 9}, 9), 8);
    EXPECT_EQ(samples_below({3, 12}, 4), 4) << "the least of all is asked anyway";
    EXPECT_EQ(samples_below({9, 12}, 12), 10);
    EXPECT_EQ(samples_below({9, 12}, 10), 10);
    EXPECT_EQ(samples_below({13, 14}, 14), 14);
}

// n is what was proven of every pair: of one that has not the room for the longest, the least in
// the cycle that finds out, and then the longest of the ladder that it has room for.
TEST_F(StopCertificateTest, ThePermitIsAsLongAsTheShortestThatAPairIsProvenWith) {
    m.can.permit_samples = {3, 12};
    make();
    stand(0, 0);
    prove();
    EXPECT_TRUE(all_proven());
    EXPECT_EQ(certificate->cycle().samples, 12) << "the first is tried with the most";
    EXPECT_EQ(query_count, 4U) << "each pair once, and the known-answer test";
    for (const std::uint8_t room : std::to_array<std::uint8_t>({4, 5, 6, 8, 10})) {
        const auto needed_mm = [this](std::uint8_t n) {  // X and Z move the pair together
            const JointBox box = certificate->reach(n);
            return std::hypot(box.half[0], box.half[2]);
        };
        const double least = needed_mm(room), next = needed_mm(samples_above({3, 12}, room));
        ASSERT_LT(least, next);
        make();
        stand(0, -100 + 0.5 + 0.5 * (least + next));
        std::uint8_t best = 0;
        for (int cycle = 0; cycle < 20; ++cycle) {
            prove();
            certificate->keep();
            ASSERT_TRUE(all_proven());
            const std::uint8_t samples = certificate->cycle().samples;
            ASSERT_TRUE(samples == 3 || needed_mm(samples) < next) << +samples;
            best = std::max(best, samples);
        }
        EXPECT_EQ(best, room);
        int short_ones = 0;
        for (int cycle = 0; cycle < 4 * kCyclesBarred; ++cycle) {
            prove();
            certificate->keep();
            const std::uint8_t samples = certificate->cycle().samples;
            ASSERT_TRUE(samples == 3 || samples == room) << +samples;
            short_ones += samples == 3 ? 1 : 0;
        }
        EXPECT_LE(short_ones, 4) << "a longer one is tried now and then, not every second time";
        EXPECT_GE(short_ones, 3) << "and it is tried";
    }
    m.can.permit_samples = {5, 5};
    make();
    stand(0, 0);
    prove();
    EXPECT_EQ(certificate->cycle().samples, 5) << "one number is always that";
}

// Proving again without `keep` proves the same: what is tried next is a matter of the next cycle.
TEST_F(StopCertificateTest, TheSameSnapshotIsProvenWithTheSameSamples) {
    m.can.permit_samples = {3, 12};
    make();
    stand(0, 0);
    const double room = certificate->reach(8).half[2];
    make();
    stand(0, -100 + 0.5 + 1.01 * room);
    for (int cycle = 0; cycle < 4; ++cycle) {
        prove();
        const std::uint8_t samples = certificate->cycle().samples;
        prove();
        EXPECT_EQ(certificate->cycle().samples, samples);
        certificate->keep();
    }
}

// The longest permit may still be in force when the next is a short one.
TEST_F(StopCertificateTest, TheLastToolCountsUntilTheLongestPermitHasEnded) {
    m.can.permit_samples = {3, 12};
    make();
    stand(0, 0);
    const auto samples = static_cast<int>(std::ceil(free_seconds(m, 12) * 1e6 / m.can.sample_us));
    ASSERT_GE(samples, 12);
    for (int i = 0; i <= samples; ++i) {
        note(0, 0, kModeMoving, m.tools[1].number);
        prove();
        EXPECT_EQ(certificate->cycle().proofs.size(), 3U) << i;
    }
    note(0, 0, kModeMoving, m.tools[1].number);
    prove();
    EXPECT_EQ(certificate->cycle().proofs.size(), 2U);
}

TEST_F(StopCertificateTest, ABodyInsideAnotherIsSeenAtTheStart) {
    m.pairs = {{kHead, kTable, 0}};
    m.bodies[kTable].at.t[2] = 0;
    ContainmentScene nested({{"table", box({-500, -500, -500}, {500, 500, 500})},
                             {"head", box({-20, -20, 120}, {20, 20, 200})},
                             {"", {}},
                             {"short", box({-2, -2, 100}, {2, 2, 120})},
                             {"long", box({-2, -2, 60}, {2, 2, 120})},
                             known_answer_mesh()});
    certificate.emplace(certificate_over(nested, m));
    stand(0, 0);
    certificate->prove(nested.engine().engine(), nested.containment_test());
    ASSERT_EQ(certificate->cycle().proofs.size(), 1U);
    EXPECT_EQ(certificate->cycle().proofs[0].surfaces.proof, JointBoxProof::proven);
    EXPECT_EQ(certificate->cycle().proofs[0].containment_result.containment, Containment::a_in_b);
    certificate->keep();
    note(0, 0);
    certificate->prove(nested.engine().engine(), nested.containment_test());
    EXPECT_EQ(certificate->cycle().proofs[0].containment_result.containment, Containment::a_in_b)
        << "and as long as it is inside";
}

}  // namespace
}  // namespace axg::test
