// SPDX-License-Identifier: Apache-2.0
// The speed cap of a cycle: in random motion within 5 % of a bisection that has all the time there
// is; never more queries than the certificate leaves; low towards a wall, none along it or away
// from it; and what a cap says: an axis that goes on as it does and keeps to it stays in the box.
#include "core/guard/speed_advisory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "tests/support/containment_fixture.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

constexpr std::uint32_t kRise = 6;     // cycles from no cap to rapid: 8, 24, 56, 120, 248, 250
constexpr std::uint32_t kSearch = 40;  // calls until the search stands still, and more
constexpr std::uint32_t kFiner = 7;

/// One tool, so that no other can be in the spindle.
Machine machine() {
    Machine m = table_and_head_machine();
    m.tools.resize(1);
    return m;
}

class SpeedAdvisoryTest : public testing::Test {
  protected:
    SpeedAdvisoryTest() : scene(table_and_head_scene()) {
        counting = {this, [](void* self, std::span<const Query> queries,
                             std::span<QueryResult> query_results) noexcept {
                        auto& test = *static_cast<SpeedAdvisoryTest*>(self);
                        test.query_count += queries.size();
                        test.scene.engine().run(queries, query_results);
                    }};
        make();
    }

    void make() {
        certificate.reset();
        certificate.emplace(certificate_over(scene, m));
        advisory.reset();
        advisory.emplace(*SpeedAdvisory::create(m));
        sample = 0;
    }

    /// One cycle. Returns the queries of the advisory.
    std::uint64_t cycle(double x, double z) {
        AxisSnapshot snapshot;
        snapshot.sample = ++sample;
        snapshot.axis_count = 5;
        snapshot.tool = 1;
        snapshot.mode = kModeMoving;
        snapshot.position[0] = x;
        snapshot.position[2] = z;
        certificate->note(snapshot, sample == 1);
        certificate->prove(scene.engine().engine(), scene.containment_test());
        certificate->keep();
        query_count = 0;
        advisory->update(counting, *certificate, queries_left);
        return query_count;
    }
    /// Comes to x, z at these speeds, mm and mm/s.
    struct Course {
        double x = 0, z = 0, x_mm_s = 0, z_mm_s = 0;
    };
    void come(const Course& to, std::uint32_t cycles = kSamplesKept + kRise) {
        for (std::uint32_t i = cycles; i-- > 0;) {
            const double before_s = i * 1e-3;
            cycle(to.x - before_s * to.x_mm_s, to.z - before_s * to.z_mm_s);
        }
    }
    /// The search goes on where the axes are.
    void search() {
        for (std::uint32_t i = 0; i < kSearch; ++i) {
            advisory->update(counting, *certificate, queries_left);
        }
    }

    /// The same query put to the engine again and again, finer than any grid.
    /// @param rounds  how often boxes may be halved, and one
    [[nodiscard]] bool is_stoppable(double share, std::uint32_t rounds) {
        auto prover = JointBoxProver::create(m, 4, {.rounds = rounds, .queries = 1U << 10});
        std::vector<JointBoxTask> tasks(certificate->tasks().begin(), certificate->tasks().end());
        for (JointBoxTask& task : tasks) {
            task.box = capped_reach(m, *certificate, share);
        }
        std::vector<JointBoxResult> results(tasks.size());
        prover->prove(scene.engine().engine(), tasks, results);
        return std::all_of(results.begin(), results.end(), [](const JointBoxResult& result) {
            return result.proof == JointBoxProof::proven;
        });
    }
    [[nodiscard]] double bisected(std::uint32_t rounds) {
        if (is_stoppable(1, rounds)) {
            return 1;
        }
        double low = 0, high = 1;
        for (int step = 0; step < 20; ++step) {
            const double middle = 0.5 * (low + high);
            (is_stoppable(middle, rounds) ? low : high) = middle;
        }
        return low;
    }

    Machine m = machine();
    ContainmentScene scene;
    Engine counting;
    std::uint64_t query_count = 0, sample = 0;
    std::uint32_t queries_left = 500;
    std::optional<StopCertificate> certificate;
    std::optional<SpeedAdvisory> advisory;
};

TEST_F(SpeedAdvisoryTest, NothingIsKnownBeforeTheSnapshotsAreEnough) {
    for (std::uint32_t i = 1; i < kSamplesKept; ++i) {
        EXPECT_EQ(cycle(250, 90), 0U);
        EXPECT_EQ(advisory->cap(), 0);
    }
    for (const int cap : {8, 24, 56, 120, 248, 250, 250}) {
        EXPECT_EQ(cycle(250, 90), 2U) << "where there is room, one question a pair";
        EXPECT_EQ(advisory->cap(), cap) << "far from everything it rises step by step";
    }
    cycle(0, -58.5);
    EXPECT_LT(advisory->cap(), 8) << "and falls at once";
}

// Towards the table and beside it, fast and slow: caps of all sizes.
TEST_F(SpeedAdvisoryTest, IsWithinFivePercentOfAnUnboundedBisection) {
    std::mt19937_64 random(printed_seed(20261181));
    const auto in = [&random](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const std::uint64_t count = count_from_environment(400);
    std::uint64_t between = 0, least = 250, most = 0, elsewhere = 0;
    std::vector<double> ratios;
    for (std::uint64_t i = 0; i < count; ++i) {
        make();
        const double fall_mm_s = in(10, m.axes[2].speed_max);
        const double lead_mm = fall_mm_s * cap_lead_seconds(m);
        come({.x = in(-100, 100),
              .z = -59.5 + lead_mm + in(0, 0.05 * fall_mm_s + fall_mm_s * fall_mm_s / 2000),
              .x_mm_s = in(-10, 10),
              .z_mm_s = -fall_mm_s});
        search();
        const double exact = bisected(SpeedAdvisory::kAdvisoryRounds) * kSpeedCapRapid;
        const std::uint8_t cap = advisory->cap();
        // Where a box is proven and a smaller one is not, for it is cut elsewhere, either may end
        // at another place than the other: both at feeds that are proven, and a little more is not.
        const double faster = std::max(1.05 * cap, cap + 1.0) / kSpeedCapRapid;
        EXPECT_TRUE(cap == 0 || is_stoppable(cap / 250.0, SpeedAdvisory::kAdvisoryRounds))
            << int{cap};
        EXPECT_TRUE(faster > 1 || !is_stoppable(faster, SpeedAdvisory::kAdvisoryRounds))
            << int{cap};
        elsewhere += cap > exact + 1e-3 || cap < std::min(0.95 * exact, exact - 1 - 1e-3) ? 1 : 0;
        between += exact >= 250.0 / 12 && cap < kSpeedCapRapid ? 1U : 0U;
        least = std::min<std::uint64_t>(least, cap);
        most = std::max<std::uint64_t>(most, cap);
        if (i % 4 == 0 && exact >= 250.0 / 12 && cap < kSpeedCapRapid) {
            ratios.push_back(cap / (bisected(kFiner) * kSpeedCapRapid));
        }
    }
    std::sort(ratios.begin(), ratios.end());
    std::printf("against boxes halved in up to %u rounds: median %.3f, least %.3f of the feed\n",
                kFiner, ratios.empty() ? 0 : ratios[ratios.size() / 2],
                ratios.empty() ? 0 : ratios[0]);
    std::printf("caps from %llu to %llu, %llu of %llu between a twelfth and rapid\n",
                static_cast<unsigned long long>(least), static_cast<unsigned long long>(most),
                static_cast<unsigned long long>(between), static_cast<unsigned long long>(count));
    EXPECT_LE(elsewhere, 1 + count / 100);
    if (count >= 400) {
        EXPECT_GT(between, count / 10) << "too few positions at which the search has to search";
        EXPECT_EQ(most, kSpeedCapRapid);
    }
}

// Twelve millimetres above the table, at most of rapid: along it and away from it there is no cap,
// towards it a low one, and none again where the speed is low.
TEST_F(SpeedAdvisoryTest, AlongAWallThereIsNoCap) {
    for (const Course& free : {Course{.z = -48, .x_mm_s = 150}, Course{.z = -48, .z_mm_s = 150},
                               Course{.z = -48, .z_mm_s = -30}, Course{.z = -48}}) {
        make();
        come(free);
        EXPECT_EQ(advisory->cap(), kSpeedCapRapid) << free.x_mm_s << " " << free.z_mm_s;
    }
    make();
    come({.z = -48, .z_mm_s = -150});
    search();
    EXPECT_GT(advisory->cap(), 0);
    EXPECT_LT(advisory->cap() * m.axes[2].speed_max / kSpeedCapRapid, 100);
}

// One query a pair, more where they are left, none where the certificate has left fewer.
TEST_F(SpeedAdvisoryTest, ACycleRunsNoMoreThanTheCertificateLeaves) {
    come({.z = -48, .z_mm_s = -150});
    search();
    const std::uint8_t cap = advisory->cap();
    ASSERT_GT(cap, 0);
    ASSERT_LT(cap, kSpeedCapRapid);
    for (const std::uint32_t left : {100U, 20U, 5U, 3U, 2U, 1U, 0U}) {
        queries_left = left;
        query_count = 0;
        search();
        const std::uint64_t advisories = query_count;
        query_count = 0;
        advisory->update(counting, *certificate, queries_left);
        EXPECT_EQ(query_count, advisory->queries());
        EXPECT_LE(query_count, left);
        EXPECT_EQ(advisories > 0, left >= 2) << left << " are left for two pairs";
        EXPECT_LE(advisory->cap(), cap);
        EXPECT_TRUE(left < 100 || advisory->cap() == cap);
    }
    EXPECT_EQ(advisory->cap(), 0);
}

// A pair without a result is not proven: an engine that gives up is no reason to go fast.
TEST_F(SpeedAdvisoryTest, WithoutAResultNoFeedIsProven) {
    come({.x = 200});
    ASSERT_GT(advisory->cap(), 0);
    const Engine silent{this,
                        [](void*, std::span<const Query>, std::span<QueryResult>) noexcept {}};
    advisory->update(silent, *certificate, queries_left);
    EXPECT_EQ(advisory->cap(), 0);
}

TEST_F(SpeedAdvisoryTest, ABoardThatTakesLongerGetsALowerCap) {
    std::uint8_t last = 255;
    for (const double lead_s : {0.0, 0.02, 0.04, 0.06}) {
        m.guard.cap_lead_s = lead_s;
        make();
        come({.z = -46.5, .z_mm_s = -100});
        search();
        EXPECT_LT(advisory->cap(), last) << lead_s;
        last = advisory->cap();
    }
    EXPECT_GT(last, 0);
}

/// The position at which an axis rests that goes on at `speed` and `acceleration`, no faster than
/// `most`, for as long as a cap takes to arrive; then speeds up as hard as it may while the permit
/// lasts, and brakes at the least.
double rest_of(const Machine& m, const Axis& axis, double speed, double acceleration, double most) {
    constexpr double kStepS = 1e-5;
    const double j = axis.jerk_max, a_max = axis.acceleration_max;
    double x = 0, v = std::min(speed, most), a = acceleration;
    for (double t = 0; t < cap_lead_seconds(m); t += kStepS) {
        a = v < most - 0.5 * a * a / j ? a : std::max(0.0, a - j * kStepS);
        v = std::min(most, v + a * kStepS);
        x += v * kStepS;
    }
    a = m.guard.free_jerk_limited ? a : a_max;
    for (double t = 0; t < free_seconds(m, 3); t += kStepS) {
        a = std::min(a_max, a + j * kStepS);
        v = std::min(axis.speed_max, v + a * kStepS);
        x += v * kStepS;
    }
    // No axis may be speeding up so hard that its jerk takes it past its largest speed.
    a = std::min(a, std::sqrt(2 * j * (axis.speed_max - v)));
    for (; v > 0; v += a * kStepS) {
        a = std::max(-axis.stopping_min, a - j * kStepS);
        x += v * kStepS;
    }
    return x;
}

TEST_F(SpeedAdvisoryTest, TheBoxHoldsAnAxisThatGoesOnAndKeepsToTheShare) {
    const Axis& axis = m.axes[0];
    for (const bool is_jerk_limited : {true, false}) {
        m.guard.free_jerk_limited = is_jerk_limited;
        for (const double speed : {0.0, 3.0, 0.2 * axis.speed_max, 0.9 * axis.speed_max}) {
            for (const double acceleration : {0.0, 200.0, 0.3 * axis.acceleration_max}) {
                if (!is_jerk_limited && acceleration != 0) {
                    continue;  // it may jump, and is not looked at
                }
                make();
                for (int i = -static_cast<int>(kSamplesKept); i <= 0; ++i) {
                    const double t = i * 1e-3;  // jerk-limited only if it has been so for long
                    cycle(t * (speed + 0.5 * acceleration * t), 60);
                }
                double last = 0;
                for (const double share : {0.01, 0.1, 0.5, 1.0}) {
                    const double x = rest_of(m, axis, speed, acceleration, share * axis.speed_max);
                    const JointBox box = capped_reach(m, *certificate, share);
                    const double high = box.centre[0] + box.half[0];
                    EXPECT_GE(high, x - 0.01) << speed << " " << acceleration << " " << share;
                    EXPECT_GE(high, last) << "a larger share";
                    last = high;
                }
            }
        }
    }
}

}  // namespace
}  // namespace axg::test
