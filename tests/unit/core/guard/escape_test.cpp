// SPDX-License-Identifier: Apache-2.0
// Ways out of places that are known by heart: which there are, which there are not, and that a wall
// on the way, an engine that is broken or the end of the travel leave none.
#include "core/guard/escape.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/reach/jog.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/table_and_head.hpp"

namespace axg::test {
namespace {

enum : std::uint32_t { kX, kY, kZ };

class EscapeTest : public testing::Test {
  protected:
    /// The table and the tool as given; the foot of the tool is 60 mm up at Z 0.
    void make(Triangles table, Triangles tool) {
        m.tools.resize(1);
        scene.emplace(std::vector<Mesh>{{"table", std::move(table)},
                                        {"head", box({-20, -20, 520}, {20, 20, 600})},
                                        {"", {}},
                                        {"tool", std::move(tool)},
                                        known_answer_mesh()});
        counting = {this, [](void* self, std::span<const Query> queries,
                             std::span<QueryResult> results) noexcept {
                        static_cast<EscapeTest*>(self)->run_queries(queries, results);
                    }};
    }
    void run_queries(std::span<const Query> queries, std::span<QueryResult> results) {
        ++batches;
        query_count += queries.size();
        if (is_silent) {
            return;
        }
        scene->engine().run(queries, results);
        for (std::size_t i = 0; i < queries.size() && says_yes; ++i) {
            results[i].proof =
                queries[i].kind == QueryKind::clearance ? results[i].proof : Proof::far;
        }
    }
    void make_mill_over_plate() {
        make(box({-50, -50, -10}, {50, 50, 0}), box({-2, -2, 60}, {2, 2, 120}));
    }

    Escapes find(double x_mm, double z_mm, std::uint16_t tool = 1) {
        std::optional<StopCertificate> certificate = certificate_over(*scene, m);
        std::optional<EscapeFinder> finder = EscapeFinder::create(m);
        AxisSnapshot snapshot;
        snapshot.axis_count = 5;
        snapshot.tool = tool;
        snapshot.position[kX] = x_mm;
        snapshot.position[kZ] = z_mm;
        certificate->note(snapshot, true);
        certificate->prove(scene->engine().engine(), scene->containment_test());
        batches = query_count = 0;
        return finder->find(counting, scene->containment_test(), *certificate);
    }

    Machine m = table_and_head_machine();
    std::optional<ContainmentScene> scene;
    Engine counting;
    std::size_t batches = 0, query_count = 0;
    bool is_silent = false;  // a broken engine: no result comes
    bool says_yes = false;   // or: right about every distance, and far to all the rest
};

TEST_F(EscapeTest, ATipOverAPlateGoesUpAndNowhereElse) {
    make_mill_over_plate();
    const Escapes out = find(0, -59.7);
    EXPECT_TRUE(out.is_clear);
    EXPECT_EQ(out.pair, 0U);
    EXPECT_NEAR(out.clearance_mm, 0.3, 1e-4);
    ASSERT_EQ(out.count, 1U);
    EXPECT_EQ(out.jogs[0].axis, kZ);
    EXPECT_FALSE(out.jogs[0].is_negative);
    EXPECT_NEAR(out.jogs[0].clearance_mm, 1.3, 1e-4);
    // Snapshots, two pairs: now, and for four ways (X, Z of the nearest pair) each of two pairs;
    // one way is proven, in no more than so many rounds and queries, known-answer tests not
    // counted.
    EXPECT_LE(batches, 1 + 4U + kEscapeRounds);
    EXPECT_LE(query_count, 2 + 4 * 2 + kEscapeQueries + 2U * kEscapeRounds);
}

// Beside an edge there are two ways, the one that gains more named first.
TEST_F(EscapeTest, BesideAWallTheBestWayComesFirst) {
    make(together(box({-50, -50, -10}, {50, 50, 0}), box({2.4F, -50, 5}, {10, 50, 61})),
         box({-2, -2, 60}, {2, 2, 120}));
    // 0.4 mm beside the wall, whose top is 0.9 mm above the tip.
    const Escapes out = find(0, 0.1);
    ASSERT_GE(out.count, 1U);
    EXPECT_NEAR(out.clearance_mm, 0.4, 1e-4);
    EXPECT_EQ(out.jogs[0].axis, kX);
    EXPECT_FALSE(out.jogs[0].is_negative) << "the table moves, and with it the wall";
    EXPECT_NEAR(out.jogs[0].clearance_mm, 1.4, 1e-4);
    for (std::uint32_t i = 1; i < out.count; ++i) {
        EXPECT_LE(out.jogs[i].clearance_mm, out.jogs[i - 1].clearance_mm);
    }
}

TEST_F(EscapeTest, InASlotThereIsNoneAtFirst) {
    make(together(box({2.2F, -50, 0}, {9, 50, 90}), box({-9, -50, 0}, {-2.2F, 50, 90})),
         box({-2, -2, 60}, {2, 2, 120}));
    const Escapes out = find(0, 0);
    EXPECT_TRUE(out.is_clear);
    EXPECT_NEAR(out.clearance_mm, 0.2, 1e-4);
    EXPECT_EQ(out.count, 0U) << "up the walls stay as near as they are";
}

// More clearance at the end, and a wall between: the step goes through it.
TEST_F(EscapeTest, AWallOnTheWayIsNoWayOut) {
    make(box({0.25F, -50, 0}, {0.35F, 50, 90}), box({-0.05F, -2, 60}, {0.05F, 2, 120}));
    const Escapes out = find(0, 0);
    EXPECT_NEAR(out.clearance_mm, 0.2, 1e-4);
    ASSERT_EQ(out.count, 1U);
    EXPECT_EQ(out.jogs[0].axis, kX);
    EXPECT_FALSE(out.jogs[0].is_negative);
    EXPECT_NEAR(out.jogs[0].clearance_mm, 1.2, 1e-4);
}

TEST_F(EscapeTest, OutOfAContactNothingIsProven) {
    make_mill_over_plate();
    for (const double z_mm : {-60.0, -61.0}) {
        const Escapes out = find(0, z_mm);
        EXPECT_FALSE(out.is_clear) << z_mm;
        EXPECT_EQ(out.clearance_mm, 0);
        EXPECT_EQ(out.count, 0U);
    }
    // So near that the error of a position may hide a contact.
    EXPECT_EQ(find(0, -60 + 0.0005).count, 0U);
    EXPECT_EQ(find(0, -60 + 0.003).count, 1U);
}

TEST_F(EscapeTest, OutOfABodyNothingIsProven) {
    make(box({-50, -50, -10}, {50, 50, 200}), box({-2, -2, 60}, {2, 2, 120}));
    const Escapes out = find(0, 0);
    EXPECT_FALSE(out.is_clear);
    EXPECT_EQ(out.count, 0U);
}

TEST_F(EscapeTest, FarFromEverythingThereIsNothingToGetAwayFrom) {
    make_mill_over_plate();
    const Escapes out = find(0, 0);
    EXPECT_TRUE(out.is_clear);
    EXPECT_EQ(out.pair, kNoIndex);
    EXPECT_EQ(out.clearance_mm, kEscapeWithinMm);
    EXPECT_EQ(out.count, 0U);
}

TEST_F(EscapeTest, AWayOutEndsWithinTheTravel) {
    make_mill_over_plate();
    m.axes[kZ].max = -59.7 + kEscapeStepMm;
    EXPECT_EQ(find(0, -59.7).count, 1U);
    m.axes[kZ].max = -59.7 + 0.99 * kEscapeStepMm;
    EXPECT_EQ(find(0, -59.7).count, 0U);
}

TEST_F(EscapeTest, AnEngineThatIsBrokenShowsNoWay) {
    make_mill_over_plate();
    is_silent = true;
    EXPECT_FALSE(find(0, -59.7).is_clear);
    is_silent = false;
    says_yes = true;
    const Escapes out = find(0, -59.7);
    EXPECT_TRUE(out.is_clear);
    EXPECT_EQ(out.count, 0U) << "the near known-answer test finds it out";
}

TEST_F(EscapeTest, ASnapshotThatCanNotBeQueriedShowsNoWay) {
    make_mill_over_plate();
    const Escapes out = find(0, -59.7, 9);
    EXPECT_FALSE(out.is_clear);
    EXPECT_EQ(out.count, 0U);
    EXPECT_EQ(query_count, 0U);
}

TEST(JogFloor, KeepsTheMarginOrWhatThereIs) {
    EXPECT_EQ(jog_floor_mm(1, 5, 0.01), 1);
    EXPECT_NEAR(jog_floor_mm(1, 0.5, 0.01), 0.5 - 0.03 - kJogGiveMm, 1e-15);
    EXPECT_EQ(jog_floor_mm(1, 0.04, 0.01), 0);
    EXPECT_EQ(jog_floor_mm(0, 0.5, 0.01), 0);
}

}  // namespace
}  // namespace axg::test
