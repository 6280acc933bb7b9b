// SPDX-License-Identifier: Apache-2.0
// ctest-labels: data rare
// The laboratory's exact judge against the tests' own exact distance, which shares no code with it,
// on every category of generated pairs, and against cases made elsewhere. AXG_COUNT: pairs a
// category.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"
#include "hil_replay/lab/judge/exact_signs.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/tritri_files.hpp"

namespace axg::test {
namespace {

std::uint64_t count_a_category() {
    const char* const text = std::getenv("AXG_COUNT");
#ifdef AXG_EXACT_SLOW
    constexpr std::uint64_t kUsual = 10;
#else
    constexpr std::uint64_t kUsual = 200;
#endif
    return text == nullptr ? kUsual : std::strtoull(text, nullptr, 10);
}

PlainTriangle<double> plain(const Vec3d (&t)[3]) {
    return {{{t[0].x, t[0].y, t[0].z}, {t[1].x, t[1].y, t[1].z}, {t[2].x, t[2].y, t[2].z}}};
}

mpq_class other_square(const lab::Pair<double>& pair) {
    const ExactSquare found = squared_distance(exact(plain(pair.a)), exact(plain(pair.b)));
    return found.above.value() / found.below.value();
}

/// Both judges on one pair. Returns whether it intersects.
bool agree(const lab::Pair<double>& pair, const std::string& what) {
    const bool meets = lab::intersect(pair);
    const mpq_class square = lab::squared_distance(pair), other = other_square(pair);
    EXPECT_EQ(square, other) << what;
    EXPECT_EQ(meets, other == 0) << what;
    return meets;
}

template <class T>
void agree_on_categories(const char* format) {
    const std::uint64_t seed = printed_seed(20261127);
    std::uint64_t pairs = 0, meet = 0;
    const lab::SignCounts before = lab::sign_counts();
    for (std::size_t c = 0; c < lab::pair_category_count(); ++c) {
        for (std::uint64_t i = 0; i < count_a_category() && !testing::Test::HasFailure(); ++i) {
            meet += agree(lab::in_double(lab::make_pair_case<T>(c, seed, i)),
                          std::string(lab::pair_category_name(c)) + " " + std::to_string(i))
                        ? 1
                        : 0;
            ++pairs;
        }
    }
    const lab::SignCounts after = lab::sign_counts();
    std::printf(
        "%s: %llu pairs, %llu of them meet; signs by double %llu, integers %llu, GMP %llu\n",
        format, static_cast<unsigned long long>(pairs), static_cast<unsigned long long>(meet),
        after.by_double - before.by_double, after.by_integers - before.by_integers,
        after.by_gmp - before.by_gmp);
    EXPECT_GT(meet, pairs / 5) << "the pairs show nothing";
    EXPECT_LT(meet, pairs - pairs / 5) << "the pairs show nothing";
    EXPECT_GT(after.by_integers, before.by_integers);
    EXPECT_GT(after.by_gmp, before.by_gmp);
}

TEST(ExactJudge, AgreesWithAnotherOnFloats) {
    agree_on_categories<float>("float");
}
TEST(ExactJudge, AgreesWithAnotherOnDoubles) {
    agree_on_categories<double>("double");
}

TEST(ExactJudge, AgreesWithAnotherOnPosedPairs) {
    const std::uint64_t seed = printed_seed(20261128);
    for (std::size_t c = 0; c < lab::pair_category_count(); ++c) {
        for (std::uint64_t i = 0; i < count_a_category() / 10; ++i) {
            const lab::PosedPair p = lab::make_posed_case(c, seed, i);
            const auto triangle = [](const Vec3f(&t)[3]) { return Triangle{t[0], t[1], t[2]}; };
            const ExactSquare other =
                squared_distance(placed(p.pose, triangle(p.pair.a)), exact(triangle(p.pair.b)));
            ASSERT_EQ(lab::squared_distance(lab::in_double(p.pair), p.pose),
                      other.above.value() / other.below.value())
                << lab::pair_category_name(c) << " " << i;
        }
    }
}

// Coordinates of very different size, where products leave the range of double: only GMP can tell.
TEST(ExactJudge, KnowsNoSizeTooSmallOrTooLarge) {
    for (const double size : {0x1p-1060, 0x1p-400, 0x1p-300, 1.0, 0x1p340, 0x1p1000}) {
        const double step = std::ldexp(size, -12);
        const Vec3d a[3] = {{-size, -size, 0}, {size, -size, 0}, {0, size, 0}};
        for (const int side : {-1, 0, 1}) {
            const lab::Pair<double> pair{{a[0], a[1], a[2]},
                                         {{0, 0, side * step}, {size, 0, size}, {-size, 0, size}}};
            EXPECT_EQ(lab::intersect(pair), side <= 0) << size << " " << side;
            agree(pair, "size " + std::to_string(size));
        }
    }
    EXPECT_EQ(lab::orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0x1p500, 0, 0x1p-1074}), 1);
    EXPECT_EQ(lab::orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0x1p500, 0, -0x1p-1074}), -1);
    EXPECT_EQ(lab::orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0x1p500, 0, 0}), 0);
}

TEST(ExactJudge, RootsAreRoundedDown) {
    EXPECT_EQ(lab::distance_mm(mpq_class(0)), 0);
    for (const double x : {1.0, 3.0, 0x1p-1000, 0x1.fffffffffffffp+300, 1e-3}) {
        const mpq_class exactly(x), little(mpq_class(1) >> 200);
        EXPECT_EQ(lab::distance_mm(exactly * exactly), x);
        EXPECT_EQ(lab::distance_mm(exactly * exactly * (1 + little)), x);
        EXPECT_EQ(lab::distance_mm(exactly * exactly * (1 - little)), std::nextafter(x, 0.0));
    }
}

TEST(ExactJudge, CasesMadeElsewhere) {
    if (!std::ifstream(kTritriFolder + "answers.csv")) {
        GTEST_SKIP() << "no " << kTritriFolder
                     << "answers.csv: set the CMake variable AXG_SHARED_DATA";
    }
    const TritriAnswers answers = read_tritri_answers(kTritriFolder + "answers.csv");
    for (const char* const name : {"pairs_f32.bin", "pairs_f64.bin"}) {
        Bytes bytes(kTritriFolder + name);
        ASSERT_EQ((bytes.take<std::array<char, 4>>()), (std::array{'T', 'T', 'P', '1'}));
        const bool is_float = bytes.take<std::uint32_t>() == 4;
        ASSERT_EQ(bytes.take<std::uint32_t>(), 0U);
        const auto count = bytes.take<std::uint32_t>();
        unsigned judged = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto id = bytes.take<std::uint32_t>();
            double v[18];
            bool finite = true;
            for (double& x : v) {
                x = is_float ? double(bytes.take<float>()) : bytes.take<double>();
                finite = finite && std::isfinite(x);
            }
            const TritriExpected& expected = answers.at(id);
            ASSERT_EQ(finite, expected.answer != 'R') << id;
            if (!finite) {
                continue;
            }
            lab::Pair<double> pair;
            for (int k = 0; k < 6; ++k) {
                (k < 3 ? pair.a[k] : pair.b[k - 3]) = {v[3 * k], v[3 * k + 1], v[3 * k + 2]};
            }
            EXPECT_EQ(lab::intersect(pair), expected.answer == '1') << id;
            const double distance_mm = lab::distance_mm(lab::squared_distance(pair));
            EXPECT_LE(std::fabs(distance_mm - expected.distance_mm), 4e-16 * distance_mm) << id;
            ++judged;
        }
        EXPECT_TRUE(bytes.at_end());
        EXPECT_GT(judged, 3000U);
    }
}

}  // namespace
}  // namespace axg::test
#else
TEST(ExactJudge, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
