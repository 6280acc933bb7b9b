// SPDX-License-Identifier: Apache-2.0
// No contact is missed: on pairs of every category of hil_replay/lab/cases/pair_cases.hpp, whatever
// the certified test calls apart is apart in exact arithmetic. Float on every lane set of this
// machine, whose bits must be equal, and the double test behind it; proven distances and margins on
// a share of the pairs. AXG_COUNT: pairs in all; AXG_SEED: which; AXG_FIRST: index of the first
// pair of each category, so that a large run can be split.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "core/collision/closest_direction.hpp"
#include "core/collision/cpu_engine.hpp"
#include "core/collision/double_test.hpp"
#include "core/collision/lane_kernels.hpp"
#include "core/collision/pair_test.hpp"
#include "hil_replay/lab/cases/draw.hpp"
#include "hil_replay/lab/cases/pair_cases.hpp"
#include "hil_replay/lab/judge/exact_judge.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/pair_text.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

using lab::Pair;

std::uint64_t number_from(const char* variable, std::uint64_t usual) {
    const char* const text = std::getenv(variable);
    return text == nullptr ? usual : std::strtoull(text, nullptr, 10);
}

std::uint64_t pair_count() {
#if defined(AXG_EXACT_SLOW) || !defined(NDEBUG)
    return number_from("AXG_COUNT", 30000);
#else
    return number_from("AXG_COUNT", 1000000);
#endif
}

// What is slow, or only counted, is done on one pair in so many, picked without regard to anything
// else: margins and widths want exact rational distances, 30 us each; pairs that nothing claims to
// be apart are judged for the counts alone; one lane by itself is compared with many.
constexpr std::uint64_t kMarginsEvery = 128, kWidthsEvery = 16, kLeftEvery = 4, kAloneEvery = 16,
                        kDoublesEvery = 4;

bool is_picked(std::uint64_t index, std::uint64_t every) {
    lab::Draw draw(index * 2 + every);
    return draw.bits() % every == 0;
}

template <class T>
T coordinate(const Vec3<T>& v, int k) {
    return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/// Less an origin; the vertices are exact, so d is the least that the theorem allows.
template <class T>
sat::TrianglePair<T> pair_less_origin(const Pair<T>& pair, const Vec3<T>& origin) {
    sat::TrianglePair<T> p;
    T most[3] = {0, 0, 0};
    const auto local = [&](const Vec3<T>& v) {
        const sat::V3<T> c{v.x - origin.x, v.y - origin.y, v.z - origin.z};
        most[0] = std::max(most[0], std::fabs(c.x));
        most[1] = std::max(most[1], std::fabs(c.y));
        most[2] = std::max(most[2], std::fabs(c.z));
        return c;
    };
    for (int i = 0; i < 3; ++i) {
        p.a[i] = local(pair.a[i]);
        p.b[i] = local(pair.b[i]);
    }
    const T d = sizeof(T) == sizeof(float) ? static_cast<T>(0x1p-90) : T{0};
    p.scale = {sat::scale_of(most[0], d), sat::scale_of(most[1], d), sat::scale_of(most[2], d)};
    return p;
}

struct Tally {
    std::uint64_t pairs = 0, float_apart = 0, recheck_apart = 0;
    std::uint64_t left_judged = 0, left_apart = 0;     // of those that the recheck leaves, a share
    double float_widest_mm = 0, double_widest_mm = 0;  // of truly apart pairs not told apart

    void add(const Tally& t) {
        pairs += t.pairs;
        float_apart += t.float_apart;
        recheck_apart += t.recheck_apart;
        left_judged += t.left_judged;
        left_apart += t.left_apart;
        float_widest_mm = std::max(float_widest_mm, t.float_widest_mm);
        double_widest_mm = std::max(double_widest_mm, t.double_widest_mm);
    }
    /// Pairs that are apart and that the recheck leaves, from the judged share.
    [[nodiscard]] double lost() const {
        const auto left = static_cast<double>(pairs - float_apart - recheck_apart);
        return left_judged == 0
                   ? 0
                   : left * static_cast<double>(left_apart) / static_cast<double>(left_judged);
    }
    [[nodiscard]] double apart() const {
        return static_cast<double>(float_apart + recheck_apart) + lost();
    }
    void print(const char* name) const {
        const auto all = static_cast<double>(pairs);
        const double share = apart() == 0 ? 0 : 100 / apart();
        std::printf("%-38s %9llu %7.3f %9.3f %9.4f %11.3g %11.3g\n", name,
                    static_cast<unsigned long long>(pairs), 100 * (all - apart()) / all,
                    share * (apart() - static_cast<double>(float_apart)), share * lost(),
                    1e3 * float_widest_mm, 1e3 * double_widest_mm);
    }
};

/// kTilePairs pairs of one category, in every form that is tested.
struct Batch {
    std::vector<Pair<float>> pairs{kTilePairs};
    PairTile tile{};
    TileResult result{}, measured{};
};

class Judge {
  public:
    explicit Judge(std::size_t category, std::uint64_t seed) : category_(category), seed_(seed) {
        for (const LaneSet set : lane_sets()) {
            kernels_.push_back(lane_kernels(set));
        }
    }

    void run(std::uint64_t first, std::uint64_t count) {
        for (std::uint64_t at = 0; at < count && !testing::Test::HasFailure(); at += kTilePairs) {
            fill(first + at);
            test_lanes();
            for (unsigned i = 0; i < std::min<std::uint64_t>(kTilePairs, count - at); ++i) {
                index_ = first + at + i;
                judge_float(i);
                if (is_picked(index_, kDoublesEvery)) {
                    judge_double();
                }
            }
        }
    }
    [[nodiscard]] const Tally& tally() const { return tally_; }

  private:
    void fill(std::uint64_t first) {
        for (unsigned i = 0; i < kTilePairs; ++i) {
            const Pair<float> pair = lab::make_pair_case<float>(category_, seed_, first + i);
            batch_->pairs[i] = pair;
            const Vec3f origin = origin_of(pair, first + i);
            for (int c = 0; c < 18; ++c) {
                const Vec3f& v = c < 9 ? pair.a[c / 3] : pair.b[c / 3 - 3];
                batch_->tile.v[c][i] = coordinate(v, c % 3) - coordinate(origin, c % 3);
            }
            batch_->tile.d[i] = 0x1p-90F;
        }
    }

    /// Any float point is legitimate: now a's first vertex, now one of b's, now the middle of two.
    static Vec3f origin_of(const Pair<float>& p, std::uint64_t index) {
        switch (index % 4) {
            case 0:
                return p.a[0];
            case 1:
                return p.b[index / 4 % 3];
            case 2:
                return 0.5F * (p.a[1] + p.b[2]);
            default:
                return 0.25F * (p.a[0] + p.b[0]);
        }
    }

    void test_lanes() {
        for (std::size_t k = 0; k < kernels_.size(); ++k) {
            TileResult result{}, measured{};
            kernels_[k]->test_tiles(&batch_->tile, 1, &result);
            kernels_[k]->measure_tiles(&batch_->tile, 1, &measured);
            if (k == 0) {
                batch_->result = result;
                batch_->measured = measured;
            }
            ASSERT_EQ(result.apart, batch_->result.apart) << kernels_[k]->name << where();
            ASSERT_EQ(measured.apart, batch_->result.apart) << kernels_[k]->name << where();
            ASSERT_EQ(std::memcmp(measured.distance_mm, batch_->measured.distance_mm,
                                  sizeof measured.distance_mm),
                      0)
                << kernels_[k]->name << where();
        }
    }

    void judge_float(unsigned i) {
        const Pair<float>& pair = batch_->pairs[i];
        const Pair<double> wide = lab::in_double(pair);
        const bool apart = (batch_->result.apart >> i & 1U) != 0;
        const float certified_mm = batch_->measured.distance_mm[i];
        ++tally_.pairs;
        tally_.float_apart += apart ? 1 : 0;
        if (is_picked(index_, kAloneEvery)) {
            compare_alone(pair, apart);
        }
        if (apart || certified_mm > 0) {
            EXPECT_FALSE(lab::intersect(wide)) << "a missed contact, float" << where() << "\n"
                                               << in_hexadecimal(pair);
        }
        if (!apart) {
            recheck(wide);
        } else if (is_picked(index_, kMarginsEvery)) {
            check_margins(pair, certified_mm);
        }
    }

    /// One lane by itself gives what many give, and each form of the axes the same.
    void compare_alone(const Pair<float>& pair, bool apart) const {
        const sat::TrianglePair<float> p = pair_less_origin(pair, origin_of(pair, index_));
        const sat::PairAxes<float> axes = sat::axes_of(p);
        const sat::V3<float> direction = sat::closest_direction(p, axes).direction;
        const bool by_17 = sat::separated_17<false>(p, 0.0F);
        const bool staged = sat::apart<false>(p.a, p.b, {0x1p-90F, 0.0F, 0.0F});
        EXPECT_EQ(by_17, sat::separated_17_wide<false>(p, axes, 0.0F)) << where();
        EXPECT_EQ(apart, staged || sat::separates<false>(p, direction, 0.0F)) << where();
        EXPECT_TRUE(staged || !by_17) << where();
    }

    /// What the engine does with a pair that float does not tell apart.
    void recheck(const Pair<double>& wide) {
        const bool apart = kernels_[0]->apart_in_double(pair_less_origin(wide, wide.a[0]));
        tally_.recheck_apart += apart ? 1 : 0;
        if (!apart && !is_picked(index_, kLeftEvery)) {
            return;
        }
        const bool meets = lab::intersect(wide);
        EXPECT_FALSE(meets && apart) << "a missed contact, recheck" << where() << "\n"
                                     << in_hexadecimal(wide);
        tally_.left_judged += apart ? 0 : 1;
        tally_.left_apart += apart || meets ? 0 : 1;
        if (!meets && (!apart || is_picked(index_, kWidthsEvery))) {
            const double gap_mm = lab::distance_mm(lab::squared_distance(wide));
            tally_.float_widest_mm = std::max(tally_.float_widest_mm, gap_mm);
            tally_.double_widest_mm = std::max(tally_.double_widest_mm, apart ? 0 : gap_mm);
        }
    }

    /// Margins at the distance and a few bits beside it.
    void check_margins(const Pair<float>& pair, double certified_mm) const {
        const sat::TrianglePair<float> p = pair_less_origin(pair, origin_of(pair, index_));
        const sat::PairAxes<float> axes = sat::axes_of(p);
        const sat::V3<float> direction = sat::closest_direction(p, axes).direction;
        const mpq_class square = lab::squared_distance(lab::in_double(pair));
        const auto is_more = [&square](double r) { return square > mpq_class(r) * mpq_class(r); };
        const double exact_mm = lab::distance_mm(square);
        EXPECT_FALSE(certified_mm > 0 && square < mpq_class(certified_mm) * mpq_class(certified_mm))
            << "certified more than the distance" << where() << "\n"
            << in_hexadecimal(pair);
        for (const double share : {-0x1p-3, -0x1p-14, -0x1p-18, -0x1p-20, -0x1p-22, 0.0, 0x1p-21}) {
            const double r = std::max(exact_mm * (1 + share), 0x1p-40);
            const auto margin = static_cast<float>(r * (1 + 0x1p-20) * (1 + 0x1p-22));
            const auto r_square = static_cast<float>(r * r * (1 + 0x1p-17));
            const bool claimed = sat::apart<true>(p.a, p.b, {0x1p-90F, margin, r_square}) ||
                                 sat::separated_17<true>(p, margin) ||
                                 sat::separated_17_wide<true>(p, axes, margin) ||
                                 sat::separates<true>(p, direction, margin);
            EXPECT_FALSE(claimed && !is_more(r))
                << "claimed more than " << r << " mm" << where() << "\n"
                << in_hexadecimal(pair);
        }
    }

    /// Pairs whose vertices are doubles: the double test by itself.
    void judge_double() const {
        const Pair<double> pair = lab::make_pair_case<double>(category_, seed_, index_);
        const sat::TrianglePair<double> p = pair_less_origin(pair, pair.a[index_ % 3]);
        const bool apart = sat::apart_in_double<false>(p, 0.0);
        for (const LaneKernels* const kernels : kernels_) {
            EXPECT_EQ(kernels->apart_in_double(p), apart) << kernels->name << where();
        }
        if (apart) {
            EXPECT_FALSE(lab::intersect(pair)) << "a missed contact, double" << where() << "\n"
                                               << in_hexadecimal(pair);
        }
    }

    [[nodiscard]] std::string where() const {
        return ": category " + std::to_string(category_) + " (" +
               lab::pair_category_name(category_) + "), seed " + std::to_string(seed_) +
               ", index " + std::to_string(index_);
    }

    std::size_t category_;
    std::uint64_t seed_, index_ = 0;
    std::vector<const LaneKernels*> kernels_;
    std::unique_ptr<Batch> batch_ = std::make_unique<Batch>();
    Tally tally_;
};

TEST(CertifiedPairs, NoContactIsMissed) {
    if (lane_sets().empty()) {
        GTEST_SKIP() << kNoLaneSet;
    }
    const std::uint64_t seed = printed_seed(20261121), first = number_from("AXG_FIRST", 0);
    const std::size_t categories = lab::pair_category_count();
    const std::uint64_t each = (pair_count() + categories - 1) / categories;
    std::printf("%-38s %9s %7s %9s %9s %11s %11s\n", "category", "pairs", "meet %", "float ? %",
                "double ? %", "float ? um", "double ? um");
    Tally all;
    for (std::size_t c = 0; c < categories && !HasFailure(); ++c) {
        Judge judge(c, seed);
        judge.run(first, each);
        judge.tally().print(lab::pair_category_name(c));
        std::fflush(stdout);
        all.add(judge.tally());
    }
    all.print("all");
    std::printf("? : of the pairs that are apart, those not told apart; widest seen\n");
    EXPECT_LT(all.apart(), 0.8 * static_cast<double>(all.pairs)) << "these pairs show nothing";
    EXPECT_GT(all.float_apart, all.pairs / 5) << "nothing was told apart";
    EXPECT_GT(all.recheck_apart, all.pairs / 20) << "float left nothing to the recheck";
}

/// Whether a coordinate is larger than the engine's domain.
bool reaches_beyond(const Pair<float>& p) {
    float most = 0;
    for (int i = 0; i < 3; ++i) {
        for (const Vec3f& v : {p.a[i], p.b[i]}) {
            most = std::max({most, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
        }
    }
    return !(most <= kCoordinateMmMax);
}

// The same pairs with a carried by a body that stands somewhere else, through the engine: boxes,
// vertices moved and rounded once, recheck, clearance.
TEST(CertifiedPairs, NoContactOfPosedPairsIsMissed) {
    const std::uint64_t seed = printed_seed(20261207), first = number_from("AXG_FIRST", 0);
    const std::uint64_t each = 1 + pair_count() / 50 / lab::pair_category_count();
    std::uint64_t far = 0, meet = 0, undecided = 0;
    double widest_mm = 0;
    for (std::size_t c = 0; c < lab::pair_category_count(); ++c) {
        for (std::uint64_t i = first; i < first + each && !HasFailure(); ++i) {
            const lab::PosedPair p = lab::make_posed_case(c, seed, i);
            const auto mesh = [](const Vec3f(&t)[3]) { return Mesh{"", {{t[0], t[1], t[2]}}}; };
            const mpq_class square = lab::squared_distance(lab::in_double(p.pair), p.pose);
            Query q{.mesh_a = 0, .mesh_b = 1, .r_mm = 100, .pose = p.pose};
            for (const LaneSet set : lane_sets()) {
                CpuEngine engine =
                    *engine_over({mesh(p.pair.a), mesh(p.pair.b)}, Capacities{8, 64, 8}, set);
                q.kind = QueryKind::touching;
                q.r_mm = 0;
                const QueryResult contact = run_query(engine, q);
                q.kind = QueryKind::clearance;
                q.r_mm = 100;
                const QueryResult clearance = run_query(engine, q);
                if (reaches_beyond(p.pair)) {
                    EXPECT_EQ(contact.status, QueryStatus::bad_query);
                    continue;
                }
                ASSERT_EQ(contact.status, QueryStatus::ok);
                const bool is_far = contact.proof == Proof::far;
                const mpq_class proven(clearance.clearance_mm);
                EXPECT_FALSE(is_far && square == 0)
                    << lab::pair_category_name(c) << " " << i << "\n"
                    << in_hexadecimal(p.pair);
                EXPECT_LE(proven * proven, square) << lab::pair_category_name(c) << " " << i << "\n"
                                                   << in_hexadecimal(p.pair);
                far += is_far ? 1 : 0;
                if (!is_far && square != 0) {
                    ++undecided;
                    widest_mm = std::max(widest_mm, lab::distance_mm(square));
                }
            }
            meet += square == 0 ? 1 : 0;
        }
    }
    std::printf("%llu answers far, %llu pairs meet, %llu answers undecided, widest %.3g um\n",
                static_cast<unsigned long long>(far), static_cast<unsigned long long>(meet),
                static_cast<unsigned long long>(undecided), 1e3 * widest_mm);
    EXPECT_GT(far, 0U);
    EXPECT_GT(meet, 0U);
}

}  // namespace
}  // namespace axg::test
#else
TEST(CertifiedPairs, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
