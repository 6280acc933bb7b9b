// SPDX-License-Identifier: Apache-2.0
// The prover's bounds and refusals, with engines made up for the purpose; the path between two
// bodies; halves that cover the whole.
#include "core/certificate/joint_box_proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/collision/known_answer.hpp"

namespace axg {
namespace {

/// Says far to margins up to `far_mm`, and counts.
struct MarginEngine {
    double far_mm = 0;
    QueryStatus otherwise = QueryStatus::ok;
    std::uint32_t batches = 0, queries = 0;
    std::vector<Query> seen{};

    static void run(void* self, std::span<const Query> queries,
                    std::span<QueryResult> results) noexcept {
        MarginEngine& fake = *static_cast<MarginEngine*>(self);
        ++fake.batches;
        for (std::size_t i = 0; i < queries.size(); ++i) {
            ++fake.queries;
            fake.seen.push_back(queries[i]);
            results[i] = QueryResult{};
            results[i].status = QueryStatus::ok;
            results[i].proof = queries[i].r_mm <= fake.far_mm ? Proof::far : Proof::not_proven;
            if (results[i].proof != Proof::far) {
                results[i].status = fake.otherwise;
            }
        }
    }
    Engine engine() { return {this, run}; }
};

/// One slide along x that carries a small body past a fixed one.
struct Slide {
    Machine machine;
    BodyExtent extent;
    JointBoxTask task;

    Slide() {
        machine.axes.resize(2);
        machine.bodies.resize(2);
        machine.bodies[1].joint = {0, {1, 0, 0}, {}};
        extent.radius_mm = 1;
        task.body_a = task.mesh_a = 1;
        task.extent_a = task.extent_b = &extent;
        task.path = path_between(machine, 1, 0);
        task.margin_mm = 0.5;
        task.box.half[0] = 8;
        task.box.half[1] = 100;  // an axis that is not on the path
    }
    JointBoxResult prove(MarginEngine& fake, JointBoxBudget budget) {
        auto prover = JointBoxProver::create(machine, 1, budget);
        JointBoxResult result;
        prover->prove(fake.engine(), {&task, 1}, {&result, 1});
        return result;
    }
};

TEST(JointBoxProver, RunsOnceWhereOneQueryIsEnough) {
    Slide slide;
    MarginEngine fake{.far_mm = 8.6};
    const JointBoxResult result = slide.prove(fake, {.rounds = 1, .queries = 1});
    EXPECT_EQ(result.proof, JointBoxProof::proven);
    EXPECT_EQ(fake.queries, 1U);
    EXPECT_NEAR(fake.seen[0].r_mm, 8.5, 1e-9) << "margin and motion";
    EXPECT_GE(fake.seen[0].r_mm, 8.5);
}

TEST(JointBoxProver, QueriesInFloatAloneWhereThereAreNoRechecks) {
    for (const std::uint32_t rechecks : {0U, 4U, 1024U}) {
        Slide slide;
        slide.machine.cycle.lists.rechecks = rechecks;
        MarginEngine fake{.far_mm = 1.6};
        EXPECT_EQ(slide.prove(fake, {}).proof, JointBoxProof::proven);
        for (const Query& query : fake.seen) {
            EXPECT_EQ(query.is_float_only, rechecks == 0);
        }
    }
}

TEST(JointBoxProver, SplitsUntilTheMotionFits) {
    Slide slide;
    MarginEngine fake{.far_mm = 1.6};  // 0.5 and at most 1.1: 8 -> 4 -> 2 -> 1
    EXPECT_EQ(slide.prove(fake, {.rounds = 4, .queries = 15}).proof, JointBoxProof::proven);
    EXPECT_EQ(fake.queries, 15U);
    EXPECT_EQ(fake.batches, 4U);
}

TEST(JointBoxProver, NeverRunsMoreThanItsBudget) {
    for (const JointBoxBudget budget :
         {JointBoxBudget{.rounds = 3, .queries = 15}, JointBoxBudget{.rounds = 4, .queries = 14},
          JointBoxBudget{.rounds = 4, .queries = 1}}) {
        Slide slide;
        MarginEngine fake{.far_mm = 1.6};
        const JointBoxResult result = slide.prove(fake, budget);
        EXPECT_EQ(result.proof, JointBoxProof::budget_spent);
        EXPECT_LE(fake.queries, budget.queries);
        EXPECT_LE(fake.batches, budget.rounds);
        EXPECT_GT(result.open.half[0], 0);
    }
}

// Two halves need two places. Where one is free the box stays open as it is: half of a box proves
// nothing, and its other half would be written past the list.
TEST(JointBoxProver, ABoxIsSplitOnlyWhereBothHalvesHaveRoom) {
    Slide slide;
    MarginEngine fake{.far_mm = 1.6};
    const JointBoxResult result = slide.prove(fake, {.rounds = 7, .queries = 3});
    EXPECT_EQ(result.proof, JointBoxProof::budget_spent);
    EXPECT_EQ(fake.queries, 3U) << "the box and its halves, of which the first takes two places";
    EXPECT_NEAR(result.open.half[0], 4, 1e-9);
    EXPECT_NEAR(result.open.centre[0], 4, 1e-9) << "the upper half, and not a part of it";
}

TEST(JointBoxProver, AnAxisOffThePathIsNeverSplit) {
    Slide slide;
    slide.task.box.half[0] = 0;
    MarginEngine fake{.far_mm = 0.4};
    const JointBoxResult result = slide.prove(fake, {});
    EXPECT_EQ(result.proof, JointBoxProof::budget_spent);
    EXPECT_EQ(fake.queries, 1U) << "nothing moves: splitting cannot help";
}

TEST(JointBoxProver, AFullListIsSplitAndABrokenEngineIsNot) {
    for (const QueryStatus full :
         {QueryStatus::too_many_node_pairs, QueryStatus::too_many_triangle_pairs,
          QueryStatus::too_many_rechecks}) {
        Slide slide;
        MarginEngine fake{.far_mm = 1.6, .otherwise = full};
        EXPECT_EQ(slide.prove(fake, {.rounds = 4, .queries = 15}).proof, JointBoxProof::proven);
    }
    for (const QueryStatus broken :
         {QueryStatus::not_run, QueryStatus::bad_query, QueryStatus::bad_rounding}) {
        Slide slide;
        MarginEngine fake{.far_mm = 1.6, .otherwise = broken};
        const JointBoxResult result = slide.prove(fake, {.rounds = 4, .queries = 15});
        EXPECT_EQ(result.proof, JointBoxProof::engine_failed);
        EXPECT_EQ(result.status, broken);
        EXPECT_EQ(fake.queries, 1U);
    }
}

// An engine that writes no result leaves those of the batch before in place, far and all.
TEST(JointBoxProver, AnEngineThatFallsSilentHasProvenNothing) {
    Slide slide;
    for (const std::uint32_t mesh : {kNoIndex, 77U}) {  // without a known-answer test, and with one
        auto prover = JointBoxProver::create(slide.machine, 1, {.known_answer_mesh = mesh});
        JointBoxResult result;
        MarginEngine fake{.far_mm = 8.6};
        prover->prove(fake.engine(), {&slide.task, 1}, {&result, 1});
        ASSERT_EQ(result.proof, JointBoxProof::proven);
        const Engine silent{nullptr,
                            [](void*, std::span<const Query>, std::span<QueryResult>) noexcept {}};
        const JointBoxWork work = prover->prove(silent, {&slide.task, 1}, {&result, 1});
        EXPECT_EQ(result.proof, JointBoxProof::engine_failed);
        EXPECT_EQ(result.status, QueryStatus::not_run);
        EXPECT_EQ(work.known_answer_signature, 0);
    }
}

TEST(JointBoxProver, FarCountsOnlyWithTheStatusOk) {
    for (const QueryStatus status : {QueryStatus::not_run, QueryStatus::too_many_node_pairs,
                                     QueryStatus::bad_query, QueryStatus::bad_rounding}) {
        Slide slide;
        QueryResult said{.status = status, .proof = Proof::far};
        const Engine far{
            &said, [](void* self, std::span<const Query>, std::span<QueryResult> results) noexcept {
                std::fill(results.begin(), results.end(), *static_cast<QueryResult*>(self));
            }};
        auto prover = JointBoxProver::create(slide.machine, 1, {});
        JointBoxResult result;
        prover->prove(far, {&slide.task, 1}, {&result, 1});
        EXPECT_NE(result.proof, JointBoxProof::proven);
    }
}

TEST(JointBoxProver, MotionsBeyondTheEnginesMarginAreSplitToo) {
    Slide slide;
    slide.task.box.half[0] = 4e4;
    MarginEngine fake{.far_mm = 1e4, .otherwise = QueryStatus::bad_query};
    EXPECT_EQ(slide.prove(fake, {.rounds = 4, .queries = 15}).proof, JointBoxProof::proven);
}

/// Knows the known-answer test by its mesh; `far` and `near` are what it says to the two queries.
struct KnownAnswerEngine {
    Proof far = Proof::far, near = Proof::not_proven;
    std::uint32_t wrong_from = UINT32_MAX;  // this batch, and later ones
    std::uint32_t batches = 0, known_answers = 0;

    static constexpr std::uint32_t kMesh = 77;
    static void run(void* self, std::span<const Query> queries,
                    std::span<QueryResult> results) noexcept {
        KnownAnswerEngine& fake = *static_cast<KnownAnswerEngine*>(self);
        for (std::size_t i = 0; i < queries.size(); ++i) {
            results[i] = QueryResult{};
            results[i].status = QueryStatus::ok;
            if (queries[i].mesh_a == kMesh) {
                const bool is_far = queries[i].pose.t[0] > 5;
                ++fake.known_answers;
                const bool lies = fake.batches >= fake.wrong_from;
                results[i].proof = lies ? Proof::far : is_far ? fake.far : fake.near;
            } else {
                results[i].proof = queries[i].r_mm <= 2.5 ? Proof::far : Proof::not_proven;
            }
        }
        ++fake.batches;
    }
    Engine engine() { return {this, run}; }
};

// Two queries of which the results are known ride in every batch, beside the budget.
TEST(JointBoxProver, TheKnownAnswerTestRidesInEveryBatch) {
    Slide slide;
    const JointBoxBudget budget{
        .rounds = 4, .queries = 15, .known_answer_mesh = KnownAnswerEngine::kMesh};
    auto prover = JointBoxProver::create(slide.machine, 1, budget);
    JointBoxResult result;
    KnownAnswerEngine good;
    JointBoxWork work = prover->prove(good.engine(), {&slide.task, 1}, {&result, 1});
    EXPECT_EQ(result.proof, JointBoxProof::proven);
    EXPECT_EQ(work.known_answer_signature, kKnownAnswerSignature);
    EXPECT_EQ(work.rounds, 4U);
    EXPECT_EQ(work.queries, 15U);
    EXPECT_EQ(good.known_answers, 2 * work.rounds);
    for (const std::uint32_t wrong_from : {0U, 1U, 2U}) {  // a liar in any batch is found out
        KnownAnswerEngine liar{.wrong_from = wrong_from};
        work = prover->prove(liar.engine(), {&slide.task, 1}, {&result, 1});
        EXPECT_EQ(work.known_answer_signature, 0) << wrong_from;
    }
    KnownAnswerEngine never_far{.far = Proof::not_proven};
    work = prover->prove(never_far.engine(), {&slide.task, 1}, {&result, 1});
    EXPECT_EQ(work.known_answer_signature, 0);
    KnownAnswerEngine idle;
    work = prover->prove(idle.engine(), {}, {});
    EXPECT_EQ(work.rounds, 1U) << "without a task the engine is asked too";
    EXPECT_EQ(work.queries, 0U);
    EXPECT_EQ(work.known_answer_signature, kKnownAnswerSignature);
}

/// Shared lists that are full for the first batches: nothing of those is proven, the known-far
/// known-answer test neither. A liar says far all the same.
struct FullEngine {
    std::uint32_t full_batches = 1, batches = 0;
    bool is_liar = false;

    static void run(void* self, std::span<const Query> queries,
                    std::span<QueryResult> results) noexcept {
        FullEngine& fake = *static_cast<FullEngine*>(self);
        const bool is_full = fake.batches++ < fake.full_batches;
        for (std::size_t i = 0; i < queries.size(); ++i) {
            const bool is_known_answer = queries[i].mesh_a == KnownAnswerEngine::kMesh;
            const bool is_far = is_known_answer ? queries[i].pose.t[0] > 5 : queries[i].r_mm <= 8.6;
            const bool says_far = is_far && (!is_full || (fake.is_liar && !is_known_answer));
            results[i] = QueryResult{};
            results[i].proof = says_far ? Proof::far : Proof::not_proven;
            results[i].status =
                is_full && !says_far ? QueryStatus::too_many_node_pairs : QueryStatus::ok;
        }
    }
    Engine engine() { return {this, run}; }
};

// Full lists are no broken engine: the batch proves nothing, its boxes are cut, and the next ones
// count. That must not be a way round the known-answer test.
TEST(JointBoxProver, AFullBatchProvesNothingAndBreaksNothing) {
    Slide slide;
    const JointBoxBudget budget{
        .rounds = 4, .queries = 15, .known_answer_mesh = KnownAnswerEngine::kMesh};
    auto prover = JointBoxProver::create(slide.machine, 1, budget);
    JointBoxResult result;
    for (const bool is_liar : {false, true}) {
        FullEngine once{.is_liar = is_liar};
        JointBoxWork work = prover->prove(once.engine(), {&slide.task, 1}, {&result, 1});
        EXPECT_EQ(result.proof, JointBoxProof::proven) << "the halves are";
        EXPECT_EQ(work.rounds, 2U) << "the first batch proved nothing";
        EXPECT_EQ(work.known_answer_signature, kKnownAnswerSignature);
        FullEngine always{.full_batches = UINT32_MAX, .is_liar = is_liar};
        work = prover->prove(always.engine(), {&slide.task, 1}, {&result, 1});
        EXPECT_EQ(result.proof, JointBoxProof::budget_spent);
        EXPECT_EQ(work.known_answer_signature, kKnownAnswerSignature);
    }
}

TEST(JointBoxProver, RefusesBoxesThatAreNoBoxes) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const double bad : {kNan, kInfinity, -1.0, 1.1e5}) {
        Slide slide;
        slide.task.box.half[0] = bad;
        MarginEngine fake{.far_mm = 1e9};
        EXPECT_EQ(slide.prove(fake, {}).proof, JointBoxProof::bad_box) << bad;
        EXPECT_EQ(fake.queries, 0U);
        slide.task.box.half[0] = 1;
        slide.task.box.centre[0] = bad == -1.0 ? -kInfinity : bad;
        EXPECT_EQ(slide.prove(fake, {}).proof, JointBoxProof::bad_box) << bad;
    }
}

// The cost of stated errors holds up to a position.
TEST(JointBoxProver, RefusesBoxesBeyondTheRangeOfStatedErrors) {
    Slide slide;
    MarginEngine fake{.far_mm = 1e9};
    slide.machine.pose_errors = {.are_stated = true, .mm = {0}, .within = {8, 100}};
    EXPECT_EQ(slide.prove(fake, {}).proof, JointBoxProof::proven);
    slide.machine.pose_errors.within[0] -= 1e-6;
    EXPECT_EQ(slide.prove(fake, {}).proof, JointBoxProof::bad_box);
}

TEST(JointBoxProver, ATaskThatFailsLeavesTheOthersAlone) {
    Slide slide;
    MarginEngine fake{.far_mm = 4.6};
    auto prover = JointBoxProver::create(slide.machine, 3, {.rounds = 2, .queries = 9});
    std::vector<JointBoxTask> tasks(3, slide.task);
    tasks[0].margin_mm = 5;
    tasks[1].box.half[0] = std::numeric_limits<double>::quiet_NaN();
    std::vector<JointBoxResult> results(3);
    prover->prove(fake.engine(), tasks, results);
    EXPECT_EQ(results[0].proof, JointBoxProof::budget_spent);
    EXPECT_EQ(results[1].proof, JointBoxProof::bad_box);
    EXPECT_EQ(results[2].proof, JointBoxProof::proven);
}

/// A slide that was proven over its box, at `position`.
ApartPose apart_at(const Slide& slide, double position,
                   JointBoxProof proof = JointBoxProof::proven) {
    const std::vector<double> axes{position, 1e4};  // the second is not on the path
    std::vector<Pose> moved(slide.machine.bodies.size());
    move_bodies(slide.machine, axes, moved);
    JointBoxResult result;
    result.proof = proof;
    return apart_pose_in(slide.machine, slide.task, result, axes, moved);
}

// The surfaces are proven apart in the box and nowhere else: a hair outside of it nothing is known.
TEST(ApartPose, IsProvenInTheBoxAndNotAHairOutside) {
    Slide slide;
    slide.task.box.centre[0] = 3;
    for (const double at : {-5.0, 0.0, 3.0, 11.0}) {
        const ApartPose pose = apart_at(slide, at);
        EXPECT_TRUE(pose.is_proven) << at;
        EXPECT_EQ(pose.mesh_a, slide.task.mesh_a);
        EXPECT_EQ(pose.pose.t[0], at);
        EXPECT_GE(pose.pose_error_mm, kPlaceErrorMm);
    }
    for (const double at :
         {-5 - 1e-14, 11 + 1e-14, 1e4, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_FALSE(apart_at(slide, at).is_proven) << at;
    }
    for (const JointBoxProof proof : {JointBoxProof::not_run, JointBoxProof::budget_spent,
                                      JointBoxProof::engine_failed, JointBoxProof::bad_box}) {
        EXPECT_FALSE(apart_at(slide, 3, proof).is_proven);
    }
}

// A box around pieces holds positions that none of them does, and no piece but the first is where
// the stretch begins.
TEST(ApartPose, OfAStretchTheFirstLeafCountsAlone) {
    Slide slide;
    slide.task.box = {};
    const auto piece = [](double low, double high) {
        JointBox box;
        box.centre[0] = 0.5 * (low + high);
        box.half[0] = 0.5 * (high - low);
        return box;
    };
    const std::vector<JointBox> pieces{piece(0, 8), piece(0, 4), piece(4, 8), piece(0, 2),
                                       piece(2, 4), piece(4, 6), piece(6, 8)};
    slide.task.pieces = pieces;
    EXPECT_TRUE(apart_at(slide, 0).is_proven);
    EXPECT_TRUE(apart_at(slide, 2).is_proven);
    EXPECT_FALSE(apart_at(slide, std::nextafter(2.0, 3.0)).is_proven);
    EXPECT_FALSE(apart_at(slide, 5).is_proven);
    slide.task.pieces = std::span(pieces).subspan(3, 1);
    EXPECT_TRUE(apart_at(slide, 1).is_proven) << "a stretch of one piece";
}

// What is left of a surface stands for it where the box was proven with it.
TEST(ApartPose, HasTheSurfacesThatItsBoxWasProvenWith) {
    Slide slide;
    slide.machine.travel.low[0] = -8;
    slide.machine.travel.high[0] = 8;
    slide.machine.travel.proofs.resize(1);
    slide.task.pruned = {.up_to_mm = 0.5, .mesh_a = 7, .mesh_b = 9};
    EXPECT_EQ(apart_at(slide, 1).mesh_a, 7U);
    EXPECT_EQ(apart_at(slide, 1).mesh_b, 9U);
    slide.task.margin_mm = 0.6;
    EXPECT_EQ(apart_at(slide, 1).mesh_a, slide.task.mesh_a) << "more than what was pruned keeps";
    slide.task.margin_mm = 0.5;
    slide.task.box.half[0] = std::nextafter(8.0, 9.0);
    EXPECT_EQ(apart_at(slide, 1).mesh_b, slide.task.mesh_b) << "the box ends outside the travel";
}

// Around 65,537 doubles are 2^-36 apart, and the centres of these halves lie between them. A long
// double holds every end exactly.
TEST(JointBox, ItsHalvesCoverItWhereTheirCentresAreRounded) {
    const auto low = [](const JointBox& box) {
        return static_cast<long double>(box.centre[0]) - box.half[0];
    };
    const auto high = [](const JointBox& box) {
        return static_cast<long double>(box.centre[0]) + box.half[0];
    };
    for (const double centre : {-65537.0, 65537.0}) {
        for (int n = 1; n < 16; ++n) {
            JointBox box;
            box.centre[0] = centre;
            box.half[0] = n * 0x1p-37;
            const JointBox lower = half_of(box, 0, false, box), upper = half_of(box, 0, true, box);
            EXPECT_LE(low(lower), low(box)) << n;
            EXPECT_GE(high(lower), low(upper)) << n;
            EXPECT_GE(high(upper), high(box)) << n;
        }
    }
}

// All the way down a grid: its boxes are equally wide, and together cover the box that it is of.
// Ends are compared without rounding, as sums of two doubles.
TEST(JointBox, AGridCoversItsBoxAtEveryLevel) {
    const auto is_below = [](double c, double h, double d, double g) {  // c + h < d - g, exactly
        const long double left = static_cast<long double>(c) - d;
        return left + h < -static_cast<long double>(g);
    };
    for (const double centre : {65537.0 / 3, -1.0 / 3, 1e-7 / 3, 0.0}) {
        for (const double half : {8.0 / 3, 1e-9 / 3, 0x1p-37, 0.0}) {
            JointBox grid;
            grid.centre[0] = centre;
            grid.half[0] = half;
            std::vector<JointBox> level{grid};
            for (int depth = 0; depth < 9; ++depth) {
                std::vector<JointBox> next;
                for (const JointBox& box : level) {
                    next.push_back(half_of(box, 0, false, grid));
                    next.push_back(half_of(box, 0, true, grid));
                }
                level = next;
                EXPECT_LE(static_cast<long double>(level.front().centre[0]) - level[0].half[0],
                          static_cast<long double>(centre) - half);
                EXPECT_GE(static_cast<long double>(level.back().centre[0]) + level[0].half[0],
                          static_cast<long double>(centre) + half);
                for (std::size_t i = 0; i < level.size(); ++i) {
                    EXPECT_EQ(level[i].half[0], level[0].half[0]) << centre << ' ' << half;
                    EXPECT_FALSE(i > 0 && is_below(level[i - 1].centre[0], level[i - 1].half[0],
                                                   level[i].centre[0], level[i].half[0]))
                        << centre << ' ' << half << ' ' << depth << ' ' << i;
                }
            }
        }
    }
}

/// Two links of 300 mm: the second joint takes the tip, which lies on the first axis where both are
/// 0, away from it.
struct TwoLinks {
    Machine machine;
    BodyExtent tip, plate;
    JointBoxTask task;

    TwoLinks() {
        machine.axes.resize(2);
        machine.axes[0].kind = machine.axes[1].kind = AxisKind::rotary;
        machine.bodies.resize(3);
        machine.bodies[1].joint = {0, {0, 1, 0}, {0, 0, 0}};
        machine.bodies[2].parent = 1;
        machine.bodies[2].joint = {1, {0, 1, 0}, {300, 0, 0}};
        tip = {{-0.01, -0.01, -0.01}, {0.01, 0.01, 0.01}, {}, 0.02};
        plate = {{-500, -500, -500}, {500, 500, 500}, {}, 1000};
        task.body_a = 2;
        task.mesh_a = 2;
        task.extent_a = &tip;
        task.extent_b = &plate;
        task.path = path_between(machine, 2, 0);
        task.box.centre = {0.3, 0.2};
        task.box.half = {0.1, 0.2};
    }
    [[nodiscard]] PathLevers levers(const JointBox& box) const {
        std::array<Pose, kBodiesMax> moved;
        move_bodies(machine, box.centre, moved);
        const PlacedPair pair = placed_pair(task, moved);
        return levers_over(machine, task.path, moved, pair.a, pair.b, box);
    }
};

// Levers of one half of the box are too short in the other.
TEST(JointBoxProver, HasTheLeversOfTheWholeBoxInEveryPart) {
    TwoLinks links;
    const PathLevers whole = links.levers(links.task.box);
    const PathLevers lower = links.levers(half_of(links.task.box, 1, false, links.task.box));
    EXPECT_GT(whole.mm[1], 1.5 * lower.mm[1]) << "the first joint's, the last on the path";
    MarginEngine fake{.far_mm = -1};
    auto prover = JointBoxProver::create(links.machine, 1, {.rounds = 6, .queries = 63});
    JointBoxResult result;
    prover->prove(fake.engine(), {&links.task, 1}, {&result, 1});
    ASSERT_EQ(fake.queries, 63U);
    JointBox box = links.task.box;
    for (std::size_t level = 0, first = 0; level < 6; first += std::size_t{1} << level++) {
        const PathMotion motion = motion_by(links.machine, links.task.path, whole, box.half);
        for (std::size_t i = first; i < first + (std::size_t{1} << level); ++i) {
            EXPECT_EQ(fake.seen[i].r_mm, motion.total_mm) << level;
        }
        box = half_of(box, motion.widest_axis, false, links.task.box);
    }
}

// What a level's queries are posed at: each place of the grid once, and no place left out.
TEST(JointBoxProver, QueriesEveryPlaceOfAGridOnce) {
    Slide slide;
    slide.machine.bodies.resize(3);
    slide.machine.bodies[2].parent = 1;
    slide.machine.bodies[2].joint = {1, {0, 1, 0}, {}};
    slide.task.body_a = 2;
    slide.task.path = path_between(slide.machine, 2, 0);
    slide.task.box.centre = {3, -2};
    slide.task.box.half = {8, 8.5};
    MarginEngine fake{.far_mm = -1};
    slide.prove(fake, {.rounds = 7, .queries = 127});
    ASSERT_EQ(fake.queries, 127U);
    std::vector<std::array<double, 2>> places;
    for (const Query& query : std::span(fake.seen).subspan(63)) {
        places.push_back({query.pose.t[0], query.pose.t[1]});
    }
    std::sort(places.begin(), places.end());
    for (std::size_t i = 0; i < 64; ++i) {
        EXPECT_NEAR(places[i][0], 3 - 7 + 2 * static_cast<double>(i / 8), 1e-9) << i;
        EXPECT_NEAR(places[i][1], -2 - 8.5 * 7 / 8 + 2.125 * static_cast<double>(i % 8), 1e-9) << i;
    }
}

TEST(JointPath, HoldsTheMovingJointsFromOneBodyToTheOther) {
    Machine m;
    m.axes.resize(4);
    m.bodies.resize(6);  // 0 base; 1 on axis 0; 2 fixed on 1; 3 on axis 1 on 2; 4 on axis 2 on base
    m.bodies[1].joint.axis = 0;
    m.bodies[1].parent = 0;
    m.bodies[2].parent = 1;
    m.bodies[3].parent = 2;
    m.bodies[3].joint.axis = 1;
    m.bodies[4].parent = 0;
    m.bodies[4].joint.axis = 2;
    const auto bodies = [&m](std::uint32_t a, std::uint32_t b) {
        const JointPath path = path_between(m, a, b);
        return std::vector<std::uint32_t>(path.body.begin(), path.body.begin() + path.count);
    };
    EXPECT_EQ(bodies(3, 4), (std::vector<std::uint32_t>{3, 1, 4}));
    EXPECT_EQ(bodies(4, 3), (std::vector<std::uint32_t>{4, 1, 3}));
    EXPECT_EQ(bodies(3, 1), (std::vector<std::uint32_t>{3}));
    EXPECT_EQ(bodies(1, 2), (std::vector<std::uint32_t>{}));
    EXPECT_EQ(bodies(5, 3), (std::vector<std::uint32_t>{1, 3})) << "5 has no parent of its own";
}

}  // namespace
}  // namespace axg
