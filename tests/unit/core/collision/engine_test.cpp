// SPDX-License-Identifier: Apache-2.0
// The engine's contract where it can go wrong: contact without depth, both sides of a margin,
// questions that make no sense, lists that are one too short. On every lane set of this processor.
#include "core/collision/engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "tests/support/engine_bench.hpp"
#include "tests/support/random_questions.hpp"
#include "tests/support/solids.hpp"

namespace axg {
namespace {

using test::ask;
using test::shifted;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Ask kAsks[] = {Ask::farther, Ask::touching, Ask::clearance};

enum : std::uint32_t { kCube, kEmpty, kBallA, kBallB, kMeshes };

std::vector<Mesh> surfaces() {
    test::Draw draw(4);
    return {{"cube", test::box({0, 0, 0}, {10, 10, 10})},
            {"empty", {}},
            test::lumpy_ball(draw, 6, 30, 0.2),
            test::lumpy_ball(draw, 9, 40, 0.2)};
}

class Engine : public testing::TestWithParam<LaneSet> {
  protected:
    [[nodiscard]] CpuEngine make(const Capacities& capacities = {}) const {
        return *test::engine_over(surfaces(), capacities, GetParam());
    }
    static Question cubes(Ask kind, const Pose& pose, double r_mm) {
        Question q;
        q.ask = kind;
        q.mesh_a = q.mesh_b = kCube;
        q.pose = pose;
        q.r_mm = r_mm;
        return q;
    }
};

INSTANTIATE_TEST_SUITE_P(Lanes, Engine, testing::ValuesIn(test::lane_sets()), [](const auto& set) {
    return set.param == LaneSet::avx512 ? "avx512" : set.param == LaneSet::avx2 ? "avx2" : "neon";
});

void expect_near(const Answer& answer) {
    EXPECT_EQ(answer.status, AnswerStatus::ok);
    EXPECT_EQ(answer.proof, Proof::not_proven);
    EXPECT_EQ(answer.clearance_mm, 0);
}

TEST(EngineAnswer, ZeroedMemoryMeansNear) {
    const Answer answer{};
    EXPECT_EQ(answer.status, AnswerStatus::not_run);
    EXPECT_EQ(answer.proof, Proof::not_proven);
    EXPECT_EQ(answer.clearance_mm, 0);
    EXPECT_EQ(static_cast<int>(Proof::not_proven), 0);
    EXPECT_EQ(static_cast<int>(AnswerStatus::not_run), 0);
}

TEST_P(Engine, ASharedFaceEdgeOrVertexIsNotProvenApart) {
    CpuEngine engine = make();
    for (const Pose& pose : {shifted(10, 0, 0), shifted(0, -10, 0), shifted(10, 10, 0),
                             shifted(-10, 0, 10), shifted(10, 10, 10), shifted(-10, 10, -10)}) {
        for (const Ask kind : kAsks) {
            SCOPED_TRACE(static_cast<int>(kind));
            const Answer answer = ask(engine, cubes(kind, pose, kind == Ask::clearance ? 50 : 0));
            expect_near(answer);
            if (kind == Ask::touching) {
                EXPECT_GT(answer.touching, 0U);
            }
        }
    }
}

TEST_P(Engine, AMicrometreOfAirIsProven) {
    CpuEngine engine = make();
    for (const Pose& pose :
         {shifted(10 + 1e-3, 0, 0), shifted(10 + 1e-3, 10, 0), shifted(10, 10, 10 + 1e-3)}) {
        for (const Ask kind : kAsks) {
            const Answer answer = ask(engine, cubes(kind, pose, kind == Ask::clearance ? 50 : 0));
            EXPECT_EQ(answer.proof, Proof::far);
            EXPECT_EQ(answer.touching, 0U);
        }
    }
}

TEST_P(Engine, AMarginHasTwoSides) {
    CpuEngine engine = make();
    // Face to face, edge to edge (3-4-5), corner to corner (2-3-6 makes 7).
    const struct {
        Pose pose;
        double distance_mm;
    } cases[] = {{shifted(15, 1, 2), 5}, {shifted(13, 14, 3), 5}, {shifted(12, 13, 16), 7}};
    for (const auto& c : cases) {
        for (const Ask kind : {Ask::farther, Ask::touching}) {
            EXPECT_EQ(ask(engine, cubes(kind, c.pose, c.distance_mm - 1e-4)).proof, Proof::far);
            EXPECT_EQ(ask(engine, cubes(kind, c.pose, c.distance_mm)).proof, Proof::not_proven);
            const Answer inside = ask(engine, cubes(kind, c.pose, c.distance_mm + 1e-4));
            EXPECT_EQ(inside.proof, Proof::not_proven);
            EXPECT_EQ(inside.status, AnswerStatus::ok);
            EXPECT_GT(inside.touching, 0U);
        }
        const Answer near = ask(engine, cubes(Ask::clearance, c.pose, 50));
        EXPECT_LE(near.clearance_mm, c.distance_mm);
        EXPECT_GT(near.clearance_mm, c.distance_mm - 1e-6);
    }
}

TEST_P(Engine, APoseErrorCountsAsDistanceLost) {
    CpuEngine engine = make();
    Question q = cubes(Ask::farther, shifted(10.5, 0, 0), 0);
    q.pose_error_mm = 0.4;
    EXPECT_EQ(ask(engine, q).proof, Proof::far);
    q.pose_error_mm = 0.501;
    EXPECT_EQ(ask(engine, q).proof, Proof::not_proven);
    q.ask = Ask::clearance;
    q.r_mm = 50;
    q.pose_error_mm = 0.4;
    EXPECT_LE(ask(engine, q).clearance_mm, 0.1);
    EXPECT_GT(ask(engine, q).clearance_mm, 0.04);
}

TEST_P(Engine, ClearanceIsTheLimitWhenNothingIsNearerAndZeroAtNoInterest) {
    CpuEngine engine = make();
    for (const double limit : {1e-6, 0.1, 50.0, 89.9}) {
        const Answer answer = ask(engine, cubes(Ask::clearance, shifted(100, 0, 0), limit));
        EXPECT_EQ(answer.clearance_mm, limit);
        EXPECT_EQ(answer.proof, Proof::far);
        EXPECT_EQ(answer.nearest, TriangleIds{});
    }
    expect_near(ask(engine, cubes(Ask::clearance, shifted(100, 0, 0), 0)));
}

TEST_P(Engine, ClearanceNamesThePairThatSetIt) {
    CpuEngine engine = make();
    const Answer answer = ask(engine, cubes(Ask::clearance, shifted(13, 1, 2), 50));
    const Mesh cube = surfaces()[kCube];
    const auto least_x = [](const Triangle& t) { return std::min({t.a.x, t.b.x, t.c.x}); };
    const auto most_x = [](const Triangle& t) { return std::max({t.a.x, t.b.x, t.c.x}); };
    EXPECT_EQ(least_x(cube.triangles.at(answer.nearest.a)), 0) << "the moved cube's near face";
    EXPECT_EQ(most_x(cube.triangles.at(answer.nearest.b)), 10);
}

TEST_P(Engine, QuestionsThatMakeNoSenseAreRefusedAndNear) {
    CpuEngine engine = make();
    std::vector<std::pair<const char*, Question>> bad;
    const auto add = [&bad](const char* name, auto change) {
        Question q = cubes(Ask::farther, shifted(1000, 0, 0), 1);
        change(q);
        bad.emplace_back(name, q);
    };
    add("mesh a", [](Question& q) { q.mesh_a = kMeshes; });
    add("mesh b", [](Question& q) { q.mesh_b = 0xffffffffU; });
    add("empty a", [](Question& q) { q.mesh_a = kEmpty; });
    add("empty b", [](Question& q) { q.mesh_b = kEmpty; });
    add("r below 0", [](Question& q) { q.r_mm = -1e-300; });
    add("r NaN", [](Question& q) { q.r_mm = kNaN; });
    add("r infinite", [](Question& q) { q.r_mm = kInfinity; });
    add("r too large", [](Question& q) { q.r_mm = std::nextafter(kMarginMmMax, kInfinity); });
    add("error below 0", [](Question& q) { q.pose_error_mm = -1e-12; });
    add("error NaN", [](Question& q) { q.pose_error_mm = kNaN; });
    add("error large", [](Question& q) { q.pose_error_mm = std::nextafter(1.0, 2.0); });
    for (int k = 0; k < 3; ++k) {
        add("t NaN", [k](Question& q) { q.pose.t[k] = kNaN; });
        add("t infinite", [k](Question& q) { q.pose.t[k] = -kInfinity; });
        add("t too far",
            [k](Question& q) { q.pose.t[k] = std::nextafter(4 * kCoordinateMmMax, kInfinity); });
        for (int j = 0; j < 3; ++j) {
            add("r NaN", [=](Question& q) { q.pose.r[k][j] = kNaN; });
            add("r infinite", [=](Question& q) { q.pose.r[k][j] = kInfinity; });
            add("not rigid", [=](Question& q) { q.pose.r[k][j] += 1e-8; });
        }
    }
    add("scaled", [](Question& q) {
        for (auto& row : q.pose.r) {
            for (double& x : row) {
                x *= 1.1;
            }
        }
    });
    for (auto& [name, question] : bad) {
        for (const Ask kind : kAsks) {
            SCOPED_TRACE(name);
            question.ask = kind;
            const Answer answer = ask(engine, question);
            EXPECT_EQ(answer.status, AnswerStatus::bad_question);
            EXPECT_EQ(answer.proof, Proof::not_proven);
            EXPECT_EQ(answer.clearance_mm, 0);
            EXPECT_EQ(answer.touching, 0U);
        }
    }
}

TEST_P(Engine, TheLargestValuesAllowedAreAnswered) {
    CpuEngine engine = make();
    Question q = cubes(Ask::farther, shifted(4 * kCoordinateMmMax, 0, 0), kMarginMmMax);
    EXPECT_EQ(ask(engine, q).proof, Proof::far);
    q.pose_error_mm = 1.0;
    EXPECT_EQ(ask(engine, q).proof, Proof::far);
    q.pose.r[0][0] += 0.4e-9;  // |R^T R - I| = 0.8e-9
    EXPECT_EQ(ask(engine, q).status, AnswerStatus::ok);
    q.pose.r[0][0] += 0.2e-9;  // 1.2e-9
    EXPECT_EQ(ask(engine, q).status, AnswerStatus::bad_question);
}

TEST_P(Engine, TheListOfTouchingPairsIsCutAtItsLengthNotTheCount) {
    CpuEngine engine = make();
    Question q;
    q.ask = Ask::touching;
    q.mesh_a = kBallA;
    q.mesh_b = kBallB;
    q.pose = shifted(50, 3, 1);
    const std::uint32_t count = ask(engine, q).touching;
    ASSERT_GT(count, 10U);
    std::vector<TriangleIds> whole(count);
    q.list = whole;
    EXPECT_EQ(ask(engine, q).touching, count);
    EXPECT_EQ(std::set<TriangleIds>(whole.begin(), whole.end()).size(), count) << "each pair once";
    constexpr TriangleIds kMark{77777, 88888};
    for (const std::uint32_t length : {0U, 1U, count - 1, count, count + 1}) {
        std::vector<TriangleIds> list(length + 1, kMark);
        q.list = std::span(list).first(length);
        EXPECT_EQ(ask(engine, q).touching, count);
        EXPECT_EQ(list[length], kMark) << "nothing is written behind the end";
        for (std::uint32_t i = 0; i < length; ++i) {
            EXPECT_EQ(list[i], i < count ? whole[i] : kMark);
        }
    }
}

bool equal(const Answer& a, const Answer& b) {
    test::Hash one, two;
    one.add(a, {});
    two.add(b, {});
    return one.value() == two.value();
}

void expect_overflow(const Answer& answer, AnswerStatus status) {
    EXPECT_EQ(answer.status, status);
    EXPECT_EQ(answer.proof, Proof::not_proven);
    EXPECT_EQ(answer.clearance_mm, 0);
}

TEST_P(Engine, ListsOneTooShortAreNotProvenAndListsJustLongEnoughChangeNothing) {
    CpuEngine ample = make();
    const Capacities usual;
    for (const Ask kind : kAsks) {
        SCOPED_TRACE(static_cast<int>(kind));
        Question q;
        q.mesh_a = kBallA;
        q.mesh_b = kBallB;
        q.r_mm = 0.5;
        double x = 90;  // the last place of an approach at which the margin is proven: most work
        do {
            x -= 0.125;
            q.pose = shifted(x, 5, 2);
        } while (ask(ample, q).proof == Proof::far);
        q.pose = shifted(x + 0.125, 5, 2);
        q.ask = kind;
        q.r_mm = kind == Ask::clearance ? 50 : 0.5;
        const Answer full = ask(ample, q);
        ASSERT_EQ(full.proof, Proof::far) << "a proof that is then lost";
        ASSERT_GT(full.node_pairs, 2U);
        ASSERT_GT(full.triangle_pairs, 2U);
        for (const int more : {-1, 0, 1}) {
            Capacities few = usual;
            few.node_pairs = full.node_pairs + static_cast<std::uint32_t>(more);
            CpuEngine nodes = make(few);
            few = usual;
            few.triangle_pairs = full.triangle_pairs + static_cast<std::uint32_t>(more);
            CpuEngine triangles = make(few);
            if (more < 0) {
                expect_overflow(ask(nodes, q), AnswerStatus::too_many_node_pairs);
                expect_overflow(ask(triangles, q), AnswerStatus::too_many_triangle_pairs);
            } else {
                EXPECT_TRUE(equal(ask(nodes, q), full));
                EXPECT_TRUE(equal(ask(triangles, q), full));
            }
        }
    }
}

TEST_P(Engine, RechecksOneTooManyAreNotProven) {
    CpuEngine ample = make();
    for (const Ask kind : {Ask::farther, Ask::touching}) {
        // So near that float32 cannot prove it and double can.
        const Question q = cubes(kind, shifted(10 + 2e-9, 0, 0), 0);
        const Answer full = ask(ample, q);
        ASSERT_EQ(full.proof, Proof::far);
        ASSERT_GT(full.rechecks, 1U);
        for (const int more : {-1, 0, 1}) {
            Capacities few;
            few.rechecks = full.rechecks + static_cast<std::uint32_t>(more);
            CpuEngine engine = make(few);
            if (more < 0) {
                expect_overflow(ask(engine, q), AnswerStatus::too_many_rechecks);
            } else {
                EXPECT_TRUE(equal(ask(engine, q), full));
            }
        }
    }
}

TEST_P(Engine, WithoutAnyRoomNothingIsProven) {
    Capacities none;
    none.node_pairs = 0;
    CpuEngine engine = make(none);
    for (const Ask kind : kAsks) {
        expect_overflow(ask(engine, cubes(kind, shifted(1000, 0, 0), 1)),
                        AnswerStatus::too_many_node_pairs);
    }
}

TEST_P(Engine, ABadOrOverflowingQuestionHarmsNoOtherOfItsBatch) {
    CpuEngine ample = make();
    Question heavy;
    heavy.ask = Ask::touching;
    heavy.mesh_a = kBallA;
    heavy.mesh_b = kBallB;
    heavy.pose = shifted(50, 3, 1);
    Capacities few;
    few.node_pairs = ask(ample, heavy).node_pairs - 1;
    CpuEngine engine = make(few);
    Question bad = cubes(Ask::farther, shifted(kNaN, 0, 0), 0);
    const Question good = cubes(Ask::farther, shifted(11, 0, 0), 0.5);
    const Question questions[] = {good, bad, good, heavy, good};
    Answer answers[5];
    for (Answer& answer : answers) {
        answer.proof = Proof::far;  // what was there before must not stay
        answer.clearance_mm = 9;
    }
    engine.ask(questions, answers);
    const Answer alone = ask(engine, good);
    for (const std::size_t i : {0U, 2U, 4U}) {
        EXPECT_EQ(answers[i].proof, Proof::far);
        EXPECT_TRUE(equal(answers[i], alone));
    }
    EXPECT_EQ(answers[1].status, AnswerStatus::bad_question);
    EXPECT_EQ(answers[1].proof, Proof::not_proven);
    expect_overflow(answers[3], AnswerStatus::too_many_node_pairs);
}

TEST(CpuEngine, PlansItsMemoryToTheByte) {
    const std::vector<Mesh> meshes = surfaces();
    Capacities small, large;
    large.node_pairs = small.node_pairs + 1024;
    const auto one = test::engine_over(meshes, small), two = test::engine_over(meshes, large);
    ASSERT_TRUE(one && two);
    EXPECT_EQ(one->memory().trees_bytes, two->memory().trees_bytes);
    EXPECT_EQ(two->memory().lists_bytes - one->memory().lists_bytes, 1024 * sizeof(NodePair));
    EXPECT_EQ(one->memory().total_bytes(), one->memory().trees_bytes + one->memory().lists_bytes);
}

TEST(CpuEngine, ALaneSetThatThisProcessorLacksIsRefused) {
    for (const LaneSet set : {LaneSet::avx512, LaneSet::avx2, LaneSet::neon}) {
        EXPECT_EQ(test::engine_over(surfaces(), {}, set).has_value(), has_lane_set(set));
    }
    EXPECT_FALSE(has_lane_set(LaneSet::neon) && has_lane_set(LaneSet::avx2));
    EXPECT_FALSE(test::lane_sets().empty()) << kNoLaneSet;
}

TEST(CpuEngineDeathTest, AsManyAnswersAsQuestionsOrTheProgramStops) {
    auto engine = test::engine_over(surfaces());
    const Question questions[2] = {};
    Answer answer;
    EXPECT_DEATH(engine->ask(questions, {&answer, 1}), "");
}

}  // namespace
}  // namespace axg
