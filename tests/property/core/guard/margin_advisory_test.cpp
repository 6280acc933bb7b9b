// SPDX-License-Identifier: Apache-2.0
// The clearance levels of a cycle, on a machine whose distances are known by heart: what better
// than slow claims holds everywhere in the reachable box; the two thresholds that are queried of a
// pair lead to the levels that its clearance itself would; approaches under noise do not flap; and
// the queries stay within what the certificate leaves. mm.
#include "core/guard/margin_advisory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <vector>

#include "tests/support/containment_fixture.hpp"
#include "tests/support/count.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

using enum ClearanceLevel;

class MarginAdvisoryTest : public testing::Test {
  protected:
    MarginAdvisoryTest() : scene(table_and_head_scene()) {
        m.tools.resize(1);
        m.pairs[0].slow_mm = 2;  // cutter and table, margin 0.5
        m.pairs[0].warn_mm = 6;
        m.guard.level_band_mm = 0.5;
        m.guard.level_hold_samples = 3;
        counting = {this, [](void* self, std::span<const Query> queries,
                             std::span<QueryResult> results) noexcept {
                        auto& test = *static_cast<MarginAdvisoryTest*>(self);
                        ++test.batches;
                        test.query_count +=
                            queries.size() - 2;  // the known-answer test rides in each
                        test.scene.engine().run(queries, results);
                    }};
        make();
    }

    void make() {
        certificate.reset();
        certificate.emplace(certificate_over(scene, m));
        advisory.reset();
        advisory.emplace(*MarginAdvisory::create(m));
        sample = 0;
    }

    AxisSnapshot snapshot(double z) {
        AxisSnapshot out;
        out.sample = ++sample;
        out.axis_count = 5;
        out.tool = 1;
        out.mode = kModeMoving;
        out.position[2] = z;
        return out;
    }
    /// One cycle of stoppable mode with the axis reported at z.
    void cycle(double z) {
        certificate->note(snapshot(z), sample == 1);
        certificate->prove(scene.engine().engine(), scene.containment_test());
        certificate->keep();
        query_count = batches = 0;
        advisory->update(counting, *certificate, queries_left);
    }
    /// One cycle of contact mode.
    void contact_cycle(double z) {
        make_contact_queries(m, snapshot(z), contact);
        std::vector<QueryResult> results(contact.count + 2);
        std::vector<ContainmentResult> containment_results(contact.count);
        const std::span<const Query> queries{contact.queries.data(), results.size()};
        scene.engine().run(queries, results);
        scene.containment_test().run(queries.first(contact.count), {results.data(), contact.count},
                                     containment_results);
        query_count = batches = 0;
        advisory->update(counting, contact, results, containment_results);
    }
    void stand(double z, std::uint32_t cycles) {
        for (std::uint32_t i = 0; i < cycles; ++i) {
            cycle(z);
        }
    }

    /// The least distance of cutter and table anywhere in the reachable box.
    [[nodiscard]] double reach_clearance_mm() const {
        const JointBox box = certificate->reach(3);
        return 60 + box.centre[2] - box.half[2];
    }
    [[nodiscard]] ClearanceLevel level() const { return advisory->clearance_levels()[0].level; }
    [[nodiscard]] MarginRule rule() const { return margin_rule(m, m.pairs[0]); }

    Machine m = table_and_head_machine();
    ContainmentScene scene;
    Engine counting;
    std::uint64_t query_count = 0, batches = 0, sample = 0;
    std::uint32_t queries_left = 500;
    std::optional<StopCertificate> certificate;
    std::optional<MarginAdvisory> advisory;
    PairQueries contact;
};

TEST_F(MarginAdvisoryTest, BeforeAnythingIsKnownItIsTheWorstLevelThatThePairHas) {
    EXPECT_EQ(advisory->worst(), 0U);
    EXPECT_EQ(level(), slow);
    EXPECT_EQ(advisory->clearance_levels()[1].level, clear) << "a pair without levels";
    m.pairs[0].slow_mm = 0;
    make();
    EXPECT_EQ(level(), warn);
    EXPECT_TRUE(has_clearance_levels(m));
    m.pairs[0].warn_mm = 0;
    EXPECT_FALSE(has_clearance_levels(m));
}

// Random journeys up and down: what is said never claims more than the box allows for.
TEST_F(MarginAdvisoryTest, BetterThanSlowMeansFartherEverywhereInTheBox) {
    std::mt19937_64 random(printed_seed(20261191));
    const auto in = [&random](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const std::uint64_t count = count_from_environment(60);
    std::array<std::uint64_t, 4> seen{};
    double nearest_warn_mm = 1e9;
    for (std::uint64_t run = 0; run < count; ++run) {
        make();
        double z = in(-59, -50), speed_mm_s = 0;
        for (int i = 0; i < 400; ++i) {
            const double wanted = i % 100 == 0 ? in(-40, 40) : speed_mm_s;
            speed_mm_s += std::clamp(wanted - speed_mm_s, -0.5, 0.5);
            z = std::max(-59.4, z + speed_mm_s * 1e-3);
            cycle(z);
            const double exact_mm = reach_clearance_mm();
            ++seen[static_cast<std::size_t>(level())];
            EXPECT_LE(level(), clearance_level(rule(), exact_mm)) << exact_mm;
            EXPECT_LE(advisory->clearance_levels()[0].distance_mm, std::max(exact_mm, 0.0));
            EXPECT_LE(query_count, queries_left);
            EXPECT_LE(batches, MarginAdvisory::kAdvisoryRounds);
            if (level() == warn) {
                nearest_warn_mm = std::min(nearest_warn_mm, exact_mm);
            }
        }
    }
    std::printf("samples at stop, slow, warn, clear: %llu %llu %llu %llu; nearest at warn %.4f\n",
                static_cast<unsigned long long>(seen[0]), static_cast<unsigned long long>(seen[1]),
                static_cast<unsigned long long>(seen[2]), static_cast<unsigned long long>(seen[3]),
                nearest_warn_mm);
    if (count >= 60) {
        for (const std::uint64_t samples : seen) {
            EXPECT_GT(samples, 100U) << "a level that hardly occurs";
        }
        EXPECT_LT(nearest_warn_mm, rule().slow_mm + 1)
            << "boxes and rounds cost more than they did";
    }
}

// Two thresholds a pair, chosen by the level that it has, tell as much as the clearance itself.
TEST_F(MarginAdvisoryTest, TwoQueriesAPairTellAsMuchAsItsClearance) {
    std::mt19937_64 random(printed_seed(20261192));
    const auto in = [&random](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::uint64_t better = 0, worse = 0;
    for (const bool has_slow : {true, false}) {
        m.pairs[0].slow_mm = has_slow ? 2 : 0;
        make();
        MarginState state{.level = has_slow ? slow : warn};
        const std::uint64_t count = count_from_environment(4000);
        double z = -50;
        for (std::uint64_t i = 0; i < count && !HasFailure(); ++i) {
            z = random() % 16 == 0 ? in(-59.4, -48) : std::max(-59.4, z + in(-0.2, 0.2));
            contact_cycle(z);
            const ClearanceLevel before = state.level;
            update_margin(state, rule(), 60 + z);
            EXPECT_EQ(level(), state.level) << "at " << 60 + z << " mm, cycle " << i;
            EXPECT_LE(query_count, has_slow ? 2U : 1U);
            better += state.level > before ? 1U : 0U;
            worse += state.level < before ? 1U : 0U;
        }
    }
    if (count_from_environment(4000) >= 4000) {
        EXPECT_GT(better, 100U);
        EXPECT_GT(worse, 100U);
    }
}

// Slowly towards the table, each position off by up to its error: the level only gets worse, where
// one without memory goes back and forth.
TEST_F(MarginAdvisoryTest, AnApproachUnderNoiseDoesNotFlap) {
    std::mt19937_64 random(printed_seed(20261193));
    std::uniform_real_distribution<double> noise(-0.00099, 0.00099), speed(0.5, 3);
    const std::uint64_t count = count_from_environment(12);
    std::uint64_t flips = 0, changes = 0;
    double most_mm = 0;
    for (std::uint64_t run = 0; run < count; ++run) {
        make();
        const double speed_mm_s = speed(random);
        double z = -52, least_mm = 1e9;
        stand(z, kSamplesKept + m.guard.level_hold_samples + 1);
        ClearanceLevel last = level(), memoryless = clearance_level(rule(), reach_clearance_mm());
        EXPECT_EQ(last, clear);
        double now_mm_s = 0;  // no axis has its speed at once
        for (; z > -58; z -= now_mm_s * 1e-3) {
            now_mm_s = std::min(speed_mm_s, now_mm_s + 0.1);
            cycle(z + noise(random));
            EXPECT_LE(level(), last) << "at " << z;
            changes += level() != last ? 1U : 0U;
            last = level();
            const double clearance_mm = reach_clearance_mm();
            most_mm = std::max(most_mm, clearance_mm - least_mm);
            least_mm = std::min(least_mm, clearance_mm);
            const ClearanceLevel now = clearance_level(rule(), clearance_mm);
            flips += now > memoryless ? 1U : 0U;
            memoryless = now;
        }
        EXPECT_EQ(last, slow);
    }
    std::printf("%llu flips without memory; the clearance rose by up to %.3f mm on its way down\n",
                static_cast<unsigned long long>(flips), most_mm);
    EXPECT_LT(most_mm, m.guard.level_band_mm) << "more noise than the band is made for";
    EXPECT_EQ(changes, 2 * count);
    if (count >= 12) {
        EXPECT_GT(flips, count) << "too little noise to tell anything";
    }
}

// The certificate has the first word: what it leaves is queried, and where that is nothing the pair
// stays slow.
TEST_F(MarginAdvisoryTest, WithoutQueriesLeftItIsSlow) {
    for (const std::uint32_t left : {2U, 1U, 0U}) {
        queries_left = 500;
        make();
        stand(0, kSamplesKept + 10);
        ASSERT_EQ(level(), clear);
        queries_left = left;
        cycle(0);
        EXPECT_EQ(query_count, left == 2 ? 2U : 0U);
        EXPECT_EQ(level(), left == 2 ? clear : slow) << left;
    }
}

TEST_F(MarginAdvisoryTest, AnEngineThatIsSilentOrWrongIsNoReasonToBeClear) {
    const Engine silent{this,
                        [](void*, std::span<const Query>, std::span<QueryResult>) noexcept {}};
    const Engine yes_man{
        this, [](void*, std::span<const Query>, std::span<QueryResult> results) noexcept {
            for (QueryResult& result : results) {
                result.status = QueryStatus::ok;
                result.proof = Proof::far;  // the known-answer test that is near as well
            }
        }};
    for (const Engine& engine : {silent, yes_man}) {
        make();
        stand(0, kSamplesKept + 10);
        ASSERT_EQ(level(), clear);
        advisory->update(engine, *certificate, queries_left);
        EXPECT_EQ(level(), slow);
        for (int i = 0; i < 10; ++i) {
            contact_cycle(0);
        }
        ASSERT_EQ(level(), clear);
        const std::vector<QueryResult> results(contact.count + 2,
                                               {.status = QueryStatus::ok, .proof = Proof::far});
        const std::vector<ContainmentResult> containment_results(
            contact.count, {QueryStatus::ok, Containment::none});
        advisory->update(engine, contact, results, containment_results);
        EXPECT_EQ(level(), slow);
    }
}

TEST_F(MarginAdvisoryTest, WhatIsNotProvenIsStopAndBeginsAgainAtTheWorstLevel) {
    for (int i = 0; i < 3; ++i) {
        contact_cycle(0);
    }
    ASSERT_EQ(level(), clear);
    contact_cycle(-59.6);  // nearer than the margin
    EXPECT_EQ(level(), stop);
    EXPECT_EQ(advisory->worst(), 0U);
    contact_cycle(0);
    contact_cycle(0);
    EXPECT_EQ(level(), slow) << "two of three samples";
    contact_cycle(0);
    EXPECT_EQ(level(), clear);
    EXPECT_EQ(advisory->worst(), kNoIndex);
    stand(0, 1);  // one snapshot says nothing about speed
    EXPECT_EQ(level(), stop);
}

// While the tool is changed either may be in the spindle: the longer one counts.
TEST_F(MarginAdvisoryTest, OfSeveralToolsTheNearestCounts) {
    Machine two = table_and_head_machine();
    two.pairs[0].slow_mm = 2;
    two.pairs[0].warn_mm = 6;
    two.guard.level_hold_samples = 1;
    ContainmentScene longer({scene.meshes()[0],
                             scene.meshes()[1],
                             scene.meshes()[2],
                             scene.meshes()[3],
                             {"drill", box({-2, -2, 50}, {2, 2, 120})},
                             known_answer_mesh()});
    StopCertificate stop_certificate = certificate_over(longer, two);
    MarginAdvisory margin_advisory = *MarginAdvisory::create(two);
    const auto at = [&](std::uint8_t mode, std::uint16_t tool) {
        for (std::uint32_t i = 0; i < 10; ++i) {  // until the tool before does not count any more
            AxisSnapshot now = snapshot(-45);
            now.mode = mode;
            now.tool = tool;
            stop_certificate.note(now, false);
            stop_certificate.prove(longer.engine().engine(), longer.containment_test());
            stop_certificate.keep();
            margin_advisory.update(longer.engine().engine(), stop_certificate, queries_left);
        }
        return margin_advisory.clearance_levels()[0].level;
    };
    for (std::uint32_t i = 0; i < kSamplesKept; ++i) {
        at(kModeStandstill, two.tools[0].number);
    }
    EXPECT_EQ(at(kModeStandstill, two.tools[0].number), clear) << "15 mm away";
    EXPECT_EQ(at(kModeStandstill, two.tools[1].number), warn) << "5 mm away";
    EXPECT_EQ(at(kModeStandstill, two.tools[0].number), clear);
    EXPECT_EQ(at(kModeToolChange, two.tools[0].number), warn) << "either";
}

}  // namespace
}  // namespace axg::test
