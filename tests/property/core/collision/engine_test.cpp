// SPDX-License-Identifier: Apache-2.0
// What holds for any surfaces, any poses and any question: equal bits on every lane set, more
// margin never proves more, the three kinds of question agree, and so do the two ways round.
#include "core/collision/engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "tests/support/engine_bench.hpp"
#include "tests/support/random_questions.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

using test::ask;

constexpr double kToleranceMm = 1.0e-3;  // what the certified bounds may lose, and much more

std::uint32_t question_count(std::uint32_t usual) {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? usual : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

struct Bench {
    test::Draw draw{test::printed_seed(2026)};
    std::vector<Mesh> meshes = test::random_surfaces(draw);
    CpuEngine engine = *test::engine_over(meshes);

    Question question() {
        return test::random_question(draw, static_cast<std::uint32_t>(meshes.size()));
    }
};

std::uint64_t hash_of(CpuEngine& engine, Question question) {
    std::vector<TriangleIds> list(64);
    question.list = list;
    const Answer answer = ask(engine, question);
    test::Hash hash;
    hash.add(answer, list);
    return hash.value();
}

TEST(EngineProperty, EveryLaneSetAnswersInEqualBits) {
    Bench bench;
    std::vector<CpuEngine> engines;
    for (const LaneSet set : test::lane_sets()) {
        engines.push_back(*test::engine_over(bench.meshes, {}, set));
    }
    if (engines.size() < 2) {
        GTEST_SKIP() << "this processor runs one lane set only";
    }
    // Few places: overflow must come at the same place as well.
    const Capacities few{200, 2000, 20};
    std::vector<CpuEngine> small;
    for (const LaneSet set : test::lane_sets()) {
        small.push_back(*test::engine_over(bench.meshes, few, set));
    }
    std::uint32_t far = 0, overflows = 0;
    const std::uint32_t count = question_count(20000);
    for (std::uint32_t i = 0; i < count; ++i) {
        const Question q = bench.question();
        const std::uint64_t wanted = hash_of(engines[0], q), wanted_few = hash_of(small[0], q);
        for (std::size_t e = 1; e < engines.size(); ++e) {
            ASSERT_EQ(hash_of(engines[e], q), wanted) << engines[e].lanes() << " question " << i;
            ASSERT_EQ(hash_of(small[e], q), wanted_few) << engines[e].lanes() << " question " << i;
        }
        const Answer answer = ask(small[0], q);
        far += answer.proof == Proof::far ? 1 : 0;
        overflows += answer.status != AnswerStatus::ok ? 1 : 0;
    }
    EXPECT_GT(far, count / 10);
    EXPECT_LT(far, count - count / 10);
    EXPECT_GT(overflows, count / 100) << "the small capacities were met";
}

TEST(EngineProperty, MoreMarginNeverProvesMore) {
    Bench bench;
    const std::uint32_t count = question_count(4000);
    std::uint32_t changes = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Question q = bench.question();
        q.ask = i % 2 == 0 ? Ask::farther : Ask::touching;
        Proof before = Proof::far;
        std::uint32_t touching = 0;
        for (const double r : {1e-6, 0.001, 0.1, 1.0, 1.0001, 3.0, 10.0, 30.0, 100.0, 1000.0}) {
            q.r_mm = r;
            const Answer answer = ask(bench.engine, q);
            if (answer.status != AnswerStatus::ok) {
                break;  // near from here on: wider margins are more work
            }
            ASSERT_TRUE(before == Proof::far || answer.proof == Proof::not_proven)
                << "question " << i << " r " << r;
            changes += before != answer.proof ? 1 : 0;
            before = answer.proof;
            if (q.ask == Ask::touching) {
                ASSERT_GE(answer.touching, touching) << "question " << i << " r " << r;
                touching = answer.touching;
            }
        }
    }
    EXPECT_GT(changes, count / 2) << "most questions met both answers";
}

TEST(EngineProperty, TheThreeKindsOfQuestionAgree) {
    Bench bench;
    const std::uint32_t count = question_count(8000);
    std::uint32_t near = 0, between = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Question q = bench.question();
        q.r_mm = 0;
        q.ask = Ask::farther;
        const Answer contact = ask(bench.engine, q);
        q.ask = Ask::touching;
        const Answer touching = ask(bench.engine, q);
        q.ask = Ask::clearance;
        q.r_mm = 50;
        const Answer clearance = ask(bench.engine, q);
        ASSERT_EQ(contact.proof, touching.proof) << i;
        ASSERT_EQ(touching.touching == 0, touching.proof == Proof::far) << i;
        ASSERT_EQ(clearance.proof == Proof::far, clearance.clearance_mm > 0) << i;
        ASSERT_LE(clearance.clearance_mm, 50) << i;
        if (clearance.status != AnswerStatus::ok) {
            continue;
        }
        ASSERT_EQ(clearance.proof, contact.proof) << i << " " << clearance.clearance_mm;
        near += contact.proof == Proof::far ? 0 : 1;
        if (clearance.clearance_mm < 2 * kToleranceMm || clearance.clearance_mm >= 50) {
            continue;
        }
        ++between;
        // The certified bound is near the distance: the margin's proof ends just beyond it. The
        // error of a pose is allowed for with up to an eighth more on one of the two ways.
        const double slack = kToleranceMm + q.pose_error_mm;
        q.ask = Ask::farther;
        q.r_mm = std::max(1e-6, clearance.clearance_mm - slack);
        ASSERT_EQ(ask(bench.engine, q).proof, Proof::far) << i << " " << clearance.clearance_mm;
        q.r_mm = clearance.clearance_mm + slack;
        ASSERT_EQ(ask(bench.engine, q).proof, Proof::not_proven) << i;
    }
    EXPECT_GT(near, count / 10);
    EXPECT_GT(between, count / 10);
}

TEST(EngineProperty, ANamedPairIsAsNearAsTheClearanceSays) {
    Bench bench;
    const std::uint32_t count = question_count(3000);
    std::uint32_t checked = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Question q = bench.question();
        q.ask = Ask::clearance;
        q.r_mm = 40;
        const Answer whole = ask(bench.engine, q);
        if (whole.status != AnswerStatus::ok || whole.clearance_mm >= 40) {
            continue;
        }
        const Mesh a{"a", {bench.meshes[q.mesh_a].triangles.at(whole.nearest.a)}};
        const Mesh b{"b", {bench.meshes[q.mesh_b].triangles.at(whole.nearest.b)}};
        CpuEngine two = *test::engine_over({a, b});
        q.mesh_a = 0;
        q.mesh_b = 1;
        const Answer alone = ask(two, q);
        ASSERT_NEAR(alone.clearance_mm, whole.clearance_mm, kToleranceMm + q.pose_error_mm) << i;
        ++checked;
    }
    EXPECT_GT(checked, count / 4);
}

TEST(EngineProperty, TheTwoWaysRoundAgreeOutsideAMicrometre) {
    Bench bench;
    const std::uint32_t count = question_count(8000);
    std::uint32_t compared = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        Question q = bench.question();
        q.ask = Ask::clearance;
        q.r_mm = 50;
        q.pose_error_mm = 0;
        Question back = q;
        std::swap(back.mesh_a, back.mesh_b);
        back.pose = inverse(q.pose);
        const Answer there = ask(bench.engine, q), again = ask(bench.engine, back);
        if (there.status != AnswerStatus::ok || again.status != AnswerStatus::ok) {
            continue;
        }
        ASSERT_NEAR(there.clearance_mm, again.clearance_mm, 1e-3) << i;
        const double margin = bench.draw.between(0, 10);
        if (std::abs(there.clearance_mm - margin) < 1e-3) {
            continue;  // inside the band either answer is right
        }
        q.ask = back.ask = Ask::farther;
        q.r_mm = back.r_mm = margin;
        const Answer one = ask(bench.engine, q), two = ask(bench.engine, back);
        if (one.status == AnswerStatus::ok && two.status == AnswerStatus::ok) {
            ASSERT_EQ(one.proof, two.proof) << i;
            ++compared;
        }
    }
    EXPECT_GT(compared, count / 2);
}

TEST(EngineProperty, TheOrderOfQuestionsDoesNotMatter) {
    Bench bench;
    std::vector<Question> questions(question_count(2000));
    std::generate(questions.begin(), questions.end(), [&bench] { return bench.question(); });
    std::vector<Answer> first(questions.size()), second(questions.size());
    bench.engine.ask(questions, first);
    for (std::size_t i = questions.size(); i > 1; --i) {
        const std::size_t j = bench.draw.below(static_cast<std::uint32_t>(i));
        std::swap(questions[i - 1], questions[j]);
        std::swap(first[i - 1], first[j]);
    }
    bench.engine.ask(questions, second);
    for (std::size_t i = 0; i < questions.size(); ++i) {
        test::Hash one, two;
        one.add(first[i], {});
        two.add(second[i], {});
        ASSERT_EQ(one.value(), two.value()) << i;
    }
}

TEST(EngineProperty, FewerPlacesNeverProveMore) {
    Bench bench;
    const std::uint32_t count = question_count(4000);
    std::uint32_t lost = 0;
    CpuEngine few = *test::engine_over(bench.meshes, {40, 100, 4});
    for (std::uint32_t i = 0; i < count; ++i) {
        const Question q = bench.question();
        const Answer full = ask(bench.engine, q), less = ask(few, q);
        ASSERT_TRUE(less.proof == Proof::not_proven || full.proof == Proof::far) << i;
        ASSERT_LE(less.clearance_mm, full.clearance_mm) << i;
        lost += full.proof != less.proof ? 1 : 0;
    }
    EXPECT_GT(lost, count / 50);
}

}  // namespace
}  // namespace axg
