// SPDX-License-Identifier: Apache-2.0
// The speed cap of a cycle: at random positions within 5 % of a bisection that has all the time
// there is; never more questions than the certificate leaves; and what a cap says: an axis that
// keeps to it stays in the box that was proven for it.
#include "core/speed_hint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/solid_bench.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

constexpr std::uint32_t kRise = 6;  // cycles from no cap to rapid: 8, 24, 56, 120, 248, 250

/// One tool, so that no other can be in the spindle.
Machine machine() {
    Machine m = table_and_head_machine();
    m.tools.resize(1);
    return m;
}

class SpeedHintTest : public testing::Test {
  protected:
    SpeedHintTest()
        : scene({{"table", box({-50, -50, -10}, {50, 50, 0})},
                 {"head", box({-20, -20, 120}, {20, 20, 200})},
                 {"", {}},
                 {"mill", box({-2, -2, 60}, {2, 2, 120})},
                 canary_mesh()}) {
        counting = {this, [](void* self, std::span<const Question> questions,
                             std::span<Answer> answers) noexcept {
                        auto& test = *static_cast<SpeedHintTest*>(self);
                        test.asked += questions.size();
                        test.scene.engine().ask(questions, answers);
                    }};
        make();
    }

    void make() {
        std::vector<const Mesh*> surfaces;
        for (std::size_t i = 0; i + 1 < scene.meshes().size(); ++i) {
            surfaces.push_back(&scene.meshes()[i]);
        }
        plan.reset();
        plan.emplace(*StopPlan::create(m, surfaces, {}));
        hint.reset();
        hint.emplace(*SpeedHint::create(m));
        sample = 0;
    }

    /// One cycle at rest. Returns the questions of the hint.
    std::uint64_t cycle(double x, double z) {
        AxisPicture picture;
        picture.sample = ++sample;
        picture.axis_count = 5;
        picture.tool = 1;
        picture.mode = kModeStandstill;
        picture.position[0] = x;
        picture.position[2] = z;
        plan->note(picture, sample == 1);
        plan->prove(scene.engine().engine(), scene.solids());
        plan->keep();
        asked = 0;
        hint->advise(counting, *plan);
        return asked;
    }
    void stand(double x, double z, std::uint32_t cycles) {
        for (std::uint32_t i = 0; i < cycles; ++i) {
            cycle(x, z);
        }
    }

    /// The same question asked of the engine again and again, finer than any grid.
    /// @param rounds  1: one question a pair, as the hint asks; more: boxes are halved as well, 64
    /// for each of the two pairs in the seventh
    [[nodiscard]] double bisected(std::uint32_t rounds) {
        auto prover = BoxProver::create(m, 4, {.rounds = rounds, .questions = 1024});
        const auto is_stoppable = [&](double share) {
            std::vector<BoxTask> tasks(plan->tasks().begin(), plan->tasks().end());
            for (BoxTask& task : tasks) {
                task.box = capped_reach(m, *plan, share);
            }
            std::vector<BoxResult> results(tasks.size());
            prover->prove(scene.engine().engine(), tasks, results);
            return std::all_of(results.begin(), results.end(), [](const BoxResult& result) {
                return result.proof == BoxProof::proven;
            });
        };
        if (is_stoppable(1)) {
            return 1;
        }
        double low = 0, high = 1;
        for (int step = 0; step < 20; ++step) {
            const double middle = 0.5 * (low + high);
            (is_stoppable(middle) ? low : high) = middle;
        }
        return low;
    }

    Machine m = machine();
    SolidScene scene;
    Engine counting;
    std::uint64_t asked = 0, sample = 0;
    std::optional<StopPlan> plan;
    std::optional<SpeedHint> hint;
};

TEST_F(SpeedHintTest, NothingIsKnownBeforeThePicturesAreEnough) {
    for (std::uint32_t i = 1; i < kSamplesKept; ++i) {
        EXPECT_EQ(cycle(250, 90), 0U);
        EXPECT_EQ(hint->cap(), 0);
    }
    for (const int cap : {8, 24, 56, 120, 248, 250, 250}) {
        EXPECT_GT(cycle(250, 90), 0U);
        EXPECT_EQ(hint->cap(), cap) << "far from everything it rises step by step";
    }
    cycle(0, -58.5);
    EXPECT_LT(hint->cap(), 8) << "and falls at once";
}

// Near the table, beside it, and far above: caps of all sizes.
TEST_F(SpeedHintTest, IsWithinFivePercentOfAnUnboundedBisection) {
    std::mt19937_64 random(printed_seed(20261181));
    const auto in = [&random](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const std::uint64_t count = count_from_environment(400);
    std::uint64_t between = 0, least = 250, most = 0;
    std::vector<double> ratios;
    for (std::uint64_t i = 0; i < count; ++i) {
        make();
        stand(in(-200, 200), -60 + std::exp(in(0, std::log(150.0))), kSamplesKept + kRise);
        const double exact = bisected(1) * kSpeedCapRapid;
        const std::uint8_t cap = hint->cap();
        EXPECT_LE(cap, exact + 1e-3);
        EXPECT_GE(cap, std::min(0.95 * exact, exact - 1 - 1e-3)) << "of " << exact;
        EXPECT_TRUE(exact < 250.0 / 12 || cap >= 0.95 * exact) << cap << " of " << exact;
        between += exact >= 250.0 / 12 && cap < kSpeedCapRapid ? 1U : 0U;
        least = std::min<std::uint64_t>(least, cap);
        most = std::max<std::uint64_t>(most, cap);
        if (i % 8 == 0 && exact >= 250.0 / 12 && cap < kSpeedCapRapid) {
            ratios.push_back(cap / (bisected(m.guard.rounds) * kSpeedCapRapid));
        }
    }
    std::sort(ratios.begin(), ratios.end());
    std::printf("against boxes halved in up to %u rounds: median %.3f, least %.3f of the feed\n",
                m.guard.rounds, ratios.empty() ? 0 : ratios[ratios.size() / 2],
                ratios.empty() ? 0 : ratios[0]);
    std::printf("caps from %llu to %llu, %llu of %llu between a twelfth and rapid\n",
                static_cast<unsigned long long>(least), static_cast<unsigned long long>(most),
                static_cast<unsigned long long>(between), static_cast<unsigned long long>(count));
    if (count >= 400) {
        EXPECT_GT(between, count / 10) << "too few positions at which the search has to search";
        EXPECT_EQ(most, kSpeedCapRapid);
    }
}

// Two questions a pair, and only where the certificate has left them: else nothing is known.
TEST_F(SpeedHintTest, ACycleAsksNoMoreThanTheCertificateLeaves) {
    stand(20, -40, kSamplesKept + kRise);
    const std::uint32_t certificate = plan->work().questions;
    for (const std::uint32_t left : {4U, 3U, 0U}) {
        m.guard.questions = certificate + left;
        const std::uint64_t hints = cycle(20, -40);
        EXPECT_EQ(hints, hint->questions());
        EXPECT_LE(plan->work().questions + hints, m.guard.questions);
        EXPECT_EQ(hints > 0, left == 4) << left;
        EXPECT_EQ(hint->cap() > 0, left == 4) << left;
    }
}

// A pair without an answer has no clearance: an engine that gives up is no reason to go fast.
TEST_F(SpeedHintTest, WithoutAnAnswerNoFeedIsProven) {
    stand(200, 0, kSamplesKept + kRise);
    ASSERT_GT(hint->cap(), 0);
    const Engine silent{this, [](void*, std::span<const Question>, std::span<Answer>) noexcept {}};
    hint->advise(silent, *plan);
    EXPECT_EQ(hint->cap(), 0);
}

TEST_F(SpeedHintTest, ABoardThatTakesLongerGetsALowerCap) {
    std::uint8_t last = 255;
    for (const double lead_s : {0.0, 0.02, 0.1, 0.5}) {
        m.guard.cap_lead_s = lead_s;
        make();
        stand(0, -30, kSamplesKept + kRise);
        EXPECT_LT(hint->cap(), last) << lead_s;
        last = hint->cap();
    }
    EXPECT_GT(last, 0);
}

// The box of a share holds where an axis gets that keeps to the share: at that speed for as long as
// a cap takes to arrive, then as fast as it may while the permit lasts, then braking at the least.
TEST_F(SpeedHintTest, TheBoxHoldsAnAxisThatKeepsToTheShare) {
    for (const bool is_jerk_limited : {true, false}) {
        m.guard.free_jerk_limited = is_jerk_limited;
        make();
        stand(0, 60, kSamplesKept);
        const Axis& axis = m.axes[0];
        for (const double share : {0.01, 0.1, 0.5, 1.0}) {
            const double j = axis.jerk_max, a_max = axis.acceleration_max, step = 1e-5;
            double x = share * axis.speed_max * cap_lead_seconds(m);
            double v = share * axis.speed_max, a = is_jerk_limited ? 0 : a_max;
            for (double t = 0; t < free_seconds(m); t += step) {
                a = std::min(a_max, a + j * step);
                v = std::min(axis.speed_max, v + a * step);
                x += v * step;
            }
            for (a = v < axis.speed_max ? a : 0; v > 0; v += a * step) {
                a = std::max(-axis.stopping_min, a - j * step);
                x += v * step;
            }
            const JointBox box = capped_reach(m, *plan, share);
            EXPECT_GE(box.centre[0] + box.half[0], x - 0.01) << share;
            EXPECT_LE(box.centre[0] - box.half[0], -x + 0.01) << share;
        }
    }
}

}  // namespace
}  // namespace axg::test
