// SPDX-License-Identifier: Apache-2.0
// The certificate of a board that stops along its look-ahead path: nothing without the path, how
// close it lets a stop come, what a board that leaves its path comes to.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/certificate/stop_certificate.hpp"
#include "core/guard/monitor.hpp"
#include "hil_replay/lab/ablations/ablations.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

constexpr std::uint32_t kTableAxis = 0, kHeadAxis = 2;
constexpr std::uint64_t kLookAhead = 200;
constexpr double kSamplePeriodS = 1e-3, kMarginMm = 0.5, kSpeedMmS = 100;

/// A table on X, a head on Z 60 mm above it.
Machine path_keeping_machine() {
    Machine m = motion_test_machine();
    m.tools.clear();
    m.first_tool = 0;
    m.bodies.assign(2, Body{});
    m.bodies[0].joint = {kTableAxis, {1, 0, 0}, {}};
    m.bodies[1].joint = {kHeadAxis, {0, 0, 1}, {}};
    m.pairs = {{1, 0, kMarginMm}};
    m.can.format = CanFormat::fd;
    m.can.look_ahead_samples = kLookAhead;
    m.guard.promise = StopPromise::path_keeping;
    m.guard.free_jerk_limited = true;
    return m;
}

class StopCertificatePath : public testing::Test {
  protected:
    void SetUp() override { make(); }
    void make() {
        certificate.reset();
        certificate.emplace(certificate_over(scene, m));
    }
    /// Commanded Z at a sample: from rest at sample 250 on it goes down, soon at 100 mm/s; at
    /// `turns_at` it turns round in an instant, as no axis can.
    [[nodiscard]] double z_at(double sample) const {
        if (sample > turns_at) {
            return z_at(turns_at) + 0.1 * (sample - turns_at);
        }
        // 50 ms of 20,000 mm/s3, of 1000 mm/s2, and of -20,000 mm/s3.
        const auto ramp = [&](double since) {
            const double s = std::max(0.0, (sample - since) * kSamplePeriodS);
            return 20'000 * s * s * s / 6;
        };
        return -(ramp(250) - ramp(300) - ramp(350) + ramp(400));
    }
    void note_path(std::uint64_t sample) {
        PathPoints points;
        points.sample = sample + kLookAhead;
        points.position[kHeadAxis] = z_at(static_cast<double>(points.sample));
        points.before[kHeadAxis] = z_at(static_cast<double>(points.sample - 1));
        points.position[kTableAxis] = x_share * points.position[kHeadAxis];
        points.before[kTableAxis] = x_share * points.before[kHeadAxis];
        certificate->note_path(points);
    }
    void note(std::uint64_t sample, double off = 0) {
        AxisSnapshot snapshot;
        snapshot.sample = sample;
        snapshot.axis_count = 5;
        snapshot.mode = kModeMoving;
        snapshot.position[kHeadAxis] = z_at(static_cast<double>(sample)) + off;
        snapshot.position[kTableAxis] = x_share * snapshot.position[kHeadAxis];
        certificate->note(snapshot, false);
    }
    CycleResult decide() {
        query_count = 0;
        certificate->prove(counting, scene.containment_test());
        certificate->keep();
        const CycleResult result = judge(certificate->cycle(), true, was_permitted);
        was_permitted = was_permitted || result.has_permit;
        if (result.is_stop && !is_stopped) {
            is_stopped = true;
            reason = result.reason;
        }
        return result;
    }
    /// In the last cycle, of the one pair.
    [[nodiscard]] std::uint64_t containment_tests() const {
        EXPECT_EQ(query_count, certificate->work().queries + 2U * certificate->work().calls);
        return certificate->containment_tests();
    }
    /// Up to this sample, inclusive; the last result.
    CycleResult run(std::uint64_t from, std::uint64_t to) {
        CycleResult result;
        for (std::uint64_t k = from; k <= to; ++k) {
            note(k);
            result = decide();
            note_path(k);
        }
        return result;
    }

    Machine m = path_keeping_machine();
    ContainmentScene scene{{{"table", box({-50, -50, -10}, {50, 50, 0})},
                            {"head", box({-20, -20, 60}, {20, 20, 100})},
                            known_answer_mesh()}};
    std::uint64_t query_count = 0;
    Engine counting{this, [](void* self, std::span<const Query> queries,
                             std::span<QueryResult> results) noexcept {
                        auto& test = *static_cast<StopCertificatePath*>(self);
                        test.query_count += queries.size();
                        test.scene.engine().run(queries, results);
                    }};
    std::optional<StopCertificate> certificate;
    // As a guard that a person arms when it is ready.
    bool was_permitted = false, is_stopped = false;
    StopReason reason = StopReason::none;
    double turns_at = HUGE_VAL;
    double x_share = 0;  // of the way down, the table goes sideways
};

TEST_F(StopCertificatePath, WithoutThePathThereIsNoPermitAndNoStop) {
    for (std::uint64_t k = 1; k <= 60; ++k) {
        note(k);
        const CycleResult result = decide();
        EXPECT_FALSE(result.has_permit || result.is_stop);
        EXPECT_EQ(result.reason, StopReason::predicted);
        EXPECT_EQ(certificate->work().queries, 0U);
        EXPECT_EQ(result.known_answer_signature, kKnownAnswerSignature)
            << "the known-answer test runs all the same";
    }
}

TEST_F(StopCertificatePath, APermitNeedsThePathFromTheNewestSnapshotOn) {
    EXPECT_FALSE(run(1, kLookAhead - 1).has_permit);
    EXPECT_FALSE(was_permitted);
    const CycleResult result = run(kLookAhead, kLookAhead + 1);
    EXPECT_TRUE(result.has_permit);
    EXPECT_FALSE(is_stopped);
}

// The stop that is still proven ends before the margin by less than two periods of motion.
TEST_F(StopCertificatePath, TheLastPermitIsTheLastThatAStopCanBearOut) {
    std::uint64_t last = 0;
    for (std::uint64_t k = 1; k < 1200 && !is_stopped; ++k) {
        last = run(k, k).has_permit ? k : last;
    }
    ASSERT_TRUE(is_stopped);
    EXPECT_EQ(reason, StopReason::predicted);
    const double stop_s = free_seconds(m, 3) + path_braking_s(100.0 / 1500, 100.0 / 50000);
    const double gap_mm = 60 + z_at(static_cast<double>(last)) - kMarginMm - 100 * stop_s;
    EXPECT_GE(gap_mm, 0);
    EXPECT_LE(gap_mm, 0.2);
}

// In one box around a slanting way the head would be low before it is there.
TEST_F(StopCertificatePath, QueriesPiecesWhereTheWholeIsNotProven) {
    x_share = 0.5;
    std::uint32_t most = 0;
    std::uint64_t last = 0;
    for (std::uint64_t k = 1; k < 1200 && !is_stopped; ++k) {
        const bool has_permit = run(k, k).has_permit;
        most = has_permit ? std::max(most, certificate->work().queries) : most;
        last = has_permit ? k : last;
    }
    EXPECT_GE(most, 7U) << "proven in pieces, and not in one";
    const double stop_s = free_seconds(m, 3) + path_braking_s(100.0 / 1500, 100.0 / 50000);
    const double gap_mm = 60 + z_at(static_cast<double>(last)) - kMarginMm - 100 * stop_s;
    EXPECT_GE(gap_mm, 0);
    EXPECT_LE(gap_mm, 0.25) << "the leaves are 64 times as small as the stretch";
}

// The stretches of two samples meet where the second begins within the first. The horizon of a
// machine at rest is five periods.
TEST_F(StopCertificatePath, ContainmentIsTestedAnewWhereTheStretchesDoNotMeet) {
    for (const std::uint64_t lost : {0U, 4U, 20U}) {
        make();
        was_permitted = is_stopped = false;
        ASSERT_TRUE(run(1, 205).has_permit);
        EXPECT_EQ(containment_tests(), 0U);
        for (std::uint64_t k = 206; k < 206 + lost; ++k) {
            note_path(k);
        }
        note(206 + lost);
        EXPECT_TRUE(decide().has_permit);
        EXPECT_EQ(containment_tests(), lost < 5 ? 0U : 1U) << lost;
    }
}

TEST_F(StopCertificatePath, AMachineThatIsNotWhereItSaidStops) {
    ASSERT_TRUE(run(1, 400).has_permit);
    note_path(401);
    note(401, 0.05);
    const CycleResult result = decide();
    EXPECT_TRUE(result.is_stop);
    EXPECT_EQ(result.reason, StopReason::left_path);
    EXPECT_STREQ(to_text(result.reason), "left_path");
}

TEST_F(StopCertificatePath, ABoardThatTakesBackItsWordStops) {
    ASSERT_TRUE(run(1, 400).has_permit);
    PathPoints points;
    points.sample = 401 + kLookAhead;
    points.position[kTableAxis] = points.before[kTableAxis] = 0.001;
    points.position[kHeadAxis] = points.before[kHeadAxis] = z_at(400 + kLookAhead);
    certificate->note_path(points);
    note(401);
    EXPECT_EQ(decide().reason, StopReason::left_path);
}

// Before the first permit nothing has been relied on: the board may begin anew.
TEST_F(StopCertificatePath, LeavingThePathBeforeTheFirstPermitIsNoStop) {
    (void)run(1, 50);
    PathPoints points;
    points.sample = 51 + kLookAhead;
    points.before[kTableAxis] = 3;
    certificate->note_path(points);
    note(51);
    const CycleResult result = decide();
    EXPECT_EQ(result.reason, StopReason::left_path);
    EXPECT_FALSE(result.is_stop || result.has_permit);
}

TEST_F(StopCertificatePath, WhoeverBeginsAnewNeedsThePathAnew) {
    ASSERT_TRUE(run(1, 400).has_permit);
    AxisSnapshot snapshot;
    snapshot.sample = 401;
    snapshot.axis_count = 5;
    snapshot.position[kHeadAxis] = z_at(401);
    certificate->note(snapshot, true);
    EXPECT_EQ(decide().reason, StopReason::predicted);
}

// A board's look-ahead path has Z come to 0.2 mm above the margin and turn round there in an
// instant. Z cannot: it goes on as far as its hardest braking takes it, whatever anybody says. So
// who believes that path permits all the way to the turn, and the head meets the table. Who checks
// it stops before Z has begun to move there.
struct Turned {
    std::uint64_t last_permit = 0, turn = 0;
    double least_gap_mm = HUGE_VAL;
};

class ImpossiblePath : public StopCertificatePath {
  protected:
    void SetUp() override { m.axes[kHeadAxis].following_error = 0.02; }
    Turned drive_to_the_turn(bool forgets) {
        if (forgets) {
            lab::believe_any_turn(m, kHeadAxis, kSpeedMmS);
        }
        make();
        was_permitted = is_stopped = false;
        turns_at = HUGE_VAL;
        double turn = 0;
        for (turn = 400; 60 + z_at(turn) > kMarginMm + 0.2; turn += 1) {
        }
        turns_at = turn - 1;
        Turned out{.turn = static_cast<std::uint64_t>(turns_at)};
        double speed = 0, z = 0;  // of the axis, at 2000 mm/s2 from where its command leaves it
        bool has_begun = false;
        for (std::uint64_t k = 1; k < 1200 && speed >= 0; ++k) {
            const auto at = static_cast<double>(k);
            z = z_at(at);
            if (k > out.turn) {
                speed = 100 - 2000 * (at - turns_at) * kSamplePeriodS;
                const double s = std::min(0.05, (at - turns_at) * kSamplePeriodS);
                z = z_at(turns_at) - 100 * s + 0.5 * 2000 * s * s;
            }
            note(k, z - z_at(at));
            const bool has_permit = decide().has_permit;
            out.last_permit = has_permit ? k : out.last_permit;
            has_begun = has_begun || has_permit;
            out.least_gap_mm = std::min(out.least_gap_mm, 60 + z);
            if (has_begun && is_stopped && k <= out.turn) {
                break;  // what a stop from here comes to is the certificate's to say
            }
            note_path(k);
        }
        return out;
    }
};

TEST_F(ImpossiblePath, IsStoppedWhenItIsSentAndNotWhenItIsLeft) {
    const Turned checked = drive_to_the_turn(false);
    EXPECT_EQ(reason, StopReason::left_path);
    EXPECT_LE(checked.last_permit + kLookAhead, checked.turn + 1) << "as soon as it was announced";
    EXPECT_GT(checked.least_gap_mm, 10);
    const Turned believed = drive_to_the_turn(true);
    EXPECT_GE(believed.last_permit, believed.turn) << "too weak to tell anything";
    EXPECT_LT(believed.least_gap_mm, 0) << "too weak to tell anything: nothing was missed";
}

// The same frames where the board brakes each axis by itself: what it commands until then is known.
class StopCertificateLookAhead : public StopCertificatePath {
  protected:
    void SetUp() override {
        m.guard.promise = StopPromise::independent;
        make();
    }
    /// Runs to the stop; the last sample with a permit.
    std::uint64_t run_to_stop(bool has_look_ahead) {
        std::uint64_t last = 0;
        for (std::uint64_t k = 1; k < 1200 && !is_stopped; ++k) {
            note(k);
            last = decide().has_permit ? k : last;
            if (has_look_ahead) {
                note_path(k);
            }
        }
        EXPECT_EQ(reason, StopReason::predicted);
        return last;
    }
    /// What is left above the margin when the latest and weakest stop from that sample is over.
    [[nodiscard]] double left_mm(std::uint64_t last) const {
        const double stop_s = free_seconds(m, 3) + path_braking_s(100.0 / 1500, 100.0 / 50000);
        return 60 + z_at(static_cast<double>(last)) - kMarginMm - 100 * stop_s;
    }
};

TEST_F(StopCertificateLookAhead, StopsFarLaterThanFromPositionsAlone) {
    const double ahead_mm = left_mm(run_to_stop(true));
    make();
    was_permitted = is_stopped = false;
    const double alone_mm = left_mm(run_to_stop(false));
    EXPECT_GE(ahead_mm, 0);
    EXPECT_LE(ahead_mm, 1);
    EXPECT_GT(alone_mm, 2) << "else the commands ahead are good for nothing";
}

// Nobody has to wait for the path: until it is known the box from positions is queried.
TEST_F(StopCertificateLookAhead, WithoutThePathTheBoxHolds) {
    for (std::uint64_t k = 1; k <= kSamplesKept; ++k) {
        note(k);
        (void)decide();
    }
    EXPECT_TRUE(was_permitted);
    EXPECT_FALSE(is_stopped);
    const double box = certificate->reach(3).half[kHeadAxis];
    EXPECT_TRUE(certificate->cycle().is_settled);
    EXPECT_GT(box, 0.01);
}

// The box around a path was proven in pieces, and not as one: a position in it proves nothing.
TEST_F(StopCertificateLookAhead, ContainmentIsTestedAnewWhereThePathEnds) {
    ASSERT_TRUE(run(1, 210).has_permit);
    std::uint64_t tests = 0;
    for (std::uint64_t k = 211; k <= 450; ++k) {  // the board sends no path any more
        note(k);
        ASSERT_TRUE(decide().has_permit) << k;
        tests += containment_tests();
    }
    EXPECT_EQ(tests, 1U);
}

// Where the path is known for the least n and not for a longer one, the longer one would be proven
// in a box of positions, and that box be taken for one around the path.
TEST_F(StopCertificateLookAhead, ALongerPermitIsProvenByTheSameKindOfBoxAsTheLeast) {
    m.can.permit_samples = {.least = 3, .most = 15};
    make();
    ASSERT_EQ(run(1, 210).samples, 15);
    int shorter = 0;
    for (std::uint64_t k = 211; k <= 450; ++k) {  // the path ends at 410
        note(k);
        const CycleResult result = decide();
        ASSERT_TRUE(result.has_permit) << k;
        const auto known = [&](std::uint32_t samples) {
            const double end = free_seconds(m, samples) / (kSamplePeriodS * (1 - kPeriodShare));
            return static_cast<double>(k) + std::ceil(end) <= 210.0 + kLookAhead;
        };
        EXPECT_EQ(result.samples, known(3) && !known(15) ? 3 : 15) << k;
        shorter += result.samples == 3 ? 1 : 0;
    }
    EXPECT_GT(shorter, 0);
}

TEST_F(StopCertificateLookAhead, APathThatNoAxisCanFollowStops) {
    turns_at = 620;
    const CycleResult before = run(1, 420);
    EXPECT_TRUE(before.has_permit);
    EXPECT_EQ(run(421, 422).reason, StopReason::left_path);
}

TEST_F(StopCertificateLookAhead, AMachineThatIsNotWhereItSaidStops) {
    ASSERT_TRUE(run(1, 400).has_permit);
    note_path(401);
    note(401, 0.05);
    EXPECT_EQ(decide().reason, StopReason::left_path);
}

}  // namespace
}  // namespace axg::test
