// SPDX-License-Identifier: Apache-2.0
// A board that keeps its caps is never stopped for them; one that does not is, with its reason. The
// whole in closed loop: tests/oracle/hil_replay/drive/enforced_cap_test.cpp.
#include "core/guard/cap_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

namespace axg {
namespace {

constexpr double kErrorMm = 0.005;

Machine capped_machine(CapPromise promise = CapPromise::all_axes) {
    Machine machine;
    machine.axes.resize(2);
    for (Axis& axis : machine.axes) {
        axis.speed_max = 500;
        axis.acceleration_max = 4000;
        axis.jerk_max = 50'000;
    }
    machine.guard.cap = promise;
    machine.can.permit_samples = {3, 12};
    return machine;
}

CapFacts facts_at(std::uint8_t acked) {
    CapFacts facts;
    facts.status = AckStatus::known;
    facts.acked = facts.since = caps_of_permit(acked, 0xFF);
    return facts;
}

constexpr CapWish kSlower{.best = {.cap = 187, .mask = 0xFF}, .is_kept_fine = false};

struct GuardBench {
    explicit GuardBench(CapPromise promise = CapPromise::all_axes)
        : machine(capped_machine(promise)), guard(machine) {}

    /// One sample further, the second axis by so much.
    CycleResult step(const CapFacts& facts, double step_mm, const CapWish& wish = {},
                     bool is_armed = true) {
        ++snapshot.sample;
        snapshot.latched_us += 1000;
        snapshot.axis_count = 2;
        snapshot.position[1] += step_mm;
        std::array<double, kAxesMax> errors{};
        errors.fill(kErrorMm);
        guard.note(snapshot, facts, false, errors);
        CycleResult result;
        result.has_permit = true;
        guard.judge({.status = SnapshotStatus::ok,
                     .is_settled = true,
                     .samples = 10,
                     .is_longer_proven = true},
                    &wish, is_armed, result);
        return result;
    }
    /// So many; the first result that stops.
    std::optional<CycleResult> steps(int count, const CapFacts& facts, double step_mm,
                                     const CapWish& wish = {}) {
        for (int i = 0; i < count; ++i) {
            const CycleResult result = step(facts, step_mm, wish);
            if (result.is_stop) {
                return result;
            }
        }
        return {};
    }

    /// As many as a fall of the cap needs; the last result.
    CycleResult slow_down() {
        (void)steps(kCapPatience - 1, facts_at(kCapRapid), 0, kSlower);
        return step(facts_at(kCapRapid), 0, kSlower);
    }

    Machine machine;
    CapGuard guard;
    AxisSnapshot snapshot;
};

// A sample is old enough when it was latched no later than these positions, on the shortest period.
TEST(CapGuard, TheAgeOfPositionsIsASampleOrMoreBefore) {
    Machine machine = capped_machine();
    EXPECT_EQ(age_samples(machine), 0U);
    const double answer_s = cap_answer_seconds(machine);
    machine.can.latched_age = {0, 1000};  // 1010 us and 20 of jitter are more than 990
    EXPECT_EQ(age_samples(machine), 2U);
    EXPECT_NEAR(cap_answer_seconds(machine), answer_s + 1.01e-3, 1e-12);
    machine.can.latched_age = {900, 900};
    EXPECT_EQ(age_samples(machine), 1U);
    machine.can.latched_age = {1000, 2000};
    EXPECT_EQ(age_samples(machine), 3U);
}

// 250 mm/s for 1.01 ms, and the 1.01 ms by which one position may be older than the other.
TEST(CapGuard, PositionsOfDifferentAgesAreNotTooFast) {
    for (const bool is_stated : {true, false}) {
        GuardBench bench;
        bench.machine.can.latched_age = {0, is_stated ? 1000U : 0U};
        (void)bench.step(facts_at(125), 0);
        EXPECT_EQ(bench.step(facts_at(125), 0.5).is_stop, !is_stated);
    }
}

TEST(CapGuard, OrdersLessWhereThatIsWishedFor) {
    GuardBench bench;
    CycleResult result = bench.step(facts_at(kCapRapid), 0);
    EXPECT_TRUE(result.has_cap);
    EXPECT_EQ(result.cap_order.cap, kCapRapid);
    result = bench.slow_down();
    EXPECT_TRUE(result.has_permit);
    EXPECT_EQ(result.cap_order.cap, 187);
    EXPECT_EQ(result.cap_order.mask, 0xFF);
    EXPECT_EQ(bench.step(facts_at(kCapRapid), 0, kSlower, false).cap_order.cap, kCapRapid)
        << "not armed, nothing is ordered";
}

TEST(CapGuard, AResultOfACapThatIsNoLongerOrderedHasNoPermit) {
    GuardBench bench;
    bench.slow_down();
    EXPECT_FALSE(bench.step(facts_at(kCapRapid), 0, {}, false).has_permit);
    EXPECT_TRUE(bench.step(facts_at(kCapRapid), 0, {}, false).has_permit);
}

TEST(CapGuard, WithoutAPromiseItIsSilent) {
    GuardBench bench(CapPromise::none);
    const CycleResult result = bench.step(facts_at(1), 400, kSlower);
    EXPECT_FALSE(result.has_cap);
    EXPECT_TRUE(result.has_permit);
}

// 25 of 250 of 500 mm/s: 0.05 mm a period, and 0.01 mm of the errors of two samples.
TEST(CapGuard, AnAxisThatIsFasterThanItsCapIsSeen) {
    GuardBench kept;
    EXPECT_FALSE(kept.steps(500, facts_at(25), 0.05));
    GuardBench broken;
    const auto stop = broken.steps(17, facts_at(25), 0.0525);
    ASSERT_TRUE(stop);
    EXPECT_EQ(stop->reason, StopReason::left_cap);
    EXPECT_EQ(stop->cap_fact.kind, CapBreak::too_fast);
    EXPECT_EQ(stop->cap_fact.axis, 1U);
    EXPECT_FALSE(stop->has_permit);
    GuardBench fast;
    EXPECT_TRUE(fast.steps(2, facts_at(25), 0.07)) << "within a period";
    GuardBench unbound;
    EXPECT_FALSE(unbound.steps(100, CapFacts{}, 0.5)) << "rapid, which limits_broken watches";
}

TEST(CapGuard, AnOrderThatIsNotAcknowledgedInTimeStops) {
    GuardBench bench;
    bench.slow_down();
    const int most = static_cast<int>(cap_answer_seconds(bench.machine) * 1e3);
    for (const bool in_time : {true, false}) {
        const auto stop = bench.steps(in_time ? most - 1 : 3, facts_at(kCapRapid), 0, kSlower);
        ASSERT_EQ(stop.has_value(), !in_time);
        if (stop) {
            EXPECT_EQ(stop->reason, StopReason::left_cap);
            EXPECT_EQ(stop->cap_fact.kind, CapBreak::not_acknowledged);
        }
    }
}

// A replay that begins in the middle: the order was recorded, and its wait begins with it.
TEST(CapGuard, AnOrderThatIsTakenOverHasItsTimeToo) {
    GuardBench bench;
    bench.snapshot.latched_us = 5'000'000;
    EXPECT_FALSE(bench.step(facts_at(kCapRapid), 0).is_stop);
    const CapOrder order{.cap = 100, .mask = 0xFF};
    bench.guard.set_order(order);
    const int most = static_cast<int>(cap_answer_seconds(bench.machine) * 1e3);
    EXPECT_FALSE(bench.steps(most - 1, facts_at(kCapRapid), 0, {.best = order}));
    EXPECT_TRUE(bench.steps(3, facts_at(kCapRapid), 0, {.best = order}));
}

// Of axes that the machine does not have a record holds nothing, and reads as rapid.
TEST(CapGuard, AxesThatAreNotThereNeedNotAcknowledge) {
    GuardBench bench;
    const CapOrder order{.cap = 100, .mask = 0xFF};
    bench.guard.set_order(order);
    CapFacts facts = facts_at(100);
    std::fill(facts.acked.begin() + 2, facts.acked.end(), kCapRapid);
    EXPECT_FALSE(bench.steps(2000, facts, 0, {.best = order}));
}

TEST(CapGuard, APermitThatWasNeverSentStops) {
    GuardBench bench;
    CapFacts facts;
    facts.status = AckStatus::unknown;
    EXPECT_FALSE(bench.step(facts, 0, {}, false).is_stop);
    const CycleResult stop = bench.step(facts, 0);
    EXPECT_TRUE(stop.is_stop);
    EXPECT_EQ(stop.cap_fact.kind, CapBreak::unknown_permit);
    EXPECT_FALSE(bench.step(facts_at(kCapRapid), 0).is_stop) << "said once";
}

}  // namespace
}  // namespace axg
