// SPDX-License-Identifier: Apache-2.0
// Leaves that are moved in float about their own centre, against an adversary: a small triangle far
// from the centre of its leaf that gets near the origin along one axis, so that the bound of a pair
// hardly covers what moving costs, and the rounding errors of it chosen as large as draws find
// them, towards a false claim. Exact arithmetic judges the vertices, the pairs and every engine.
// With the leaf's own term left out the claims must be false. AXG_COUNT: triangles.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/base/finite.hpp"
#include "core/collision/double_test.hpp"
#include "core/collision/lanes_one.hpp"
#include "core/collision/pair_test.hpp"
#include "core/collision/tree.hpp"
#include "tests/support/count.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using V = lanes::Float1;
constexpr unsigned kW = 1;
constexpr std::uint32_t kLaneBits = 1;
constexpr unsigned kLeafPairs = kNodeWidth * kNodeWidth;
#include "core/collision/box_test.inl"
#include "core/collision/traverse_query.inl"

constexpr double kUnit = 0x1p-24;
constexpr int kDraws = 16;  // of a vertex; the worst is taken

double coordinate(const Vec3f& v, int k) {
    return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/// One triangle of a leaf, moved as the engines move it.
struct Moved1 {
    QueryConstants c;
    float origin[3], leaf_d;
    sat::V3<float> v[3];

    Moved1(const Query& q, const Mesh& a, const Mesh& b, const Aabb& leaf, const Triangle& t) {
        set_constants(c, q, reach_of(a), reach_of(b));
        const Moved box = moved_box(c.a_in_b, leaf.c, leaf.h);
        std::copy(box.c, box.c + 3, origin);
        leaf_d = test::leaf_d(c.d32, leaf);
        const Vec3f from[3] = {t.a, t.b, t.c};
        for (int i = 0; i < 3; ++i) {
            float to[3];
            for (int k = 0; k < 3; ++k) {
                const V x{from[i].x - leaf.c[0]}, y{from[i].y - leaf.c[1]},
                    z{from[i].z - leaf.c[2]};
                to[k] =
                    moved_about(c.a_in_b, k, moved_centre(q.pose, k, leaf.c, origin[k]), x, y, z).v;
            }
            v[i] = {to[0], to[1], to[2]};
        }
    }
    /// Claimed apart in float, with these errors of a's vertices.
    [[nodiscard]] bool claims(const Triangle& b, float d) const {
        const Vec3f from[3] = {b.a, b.b, b.c};
        sat::V3<float> to[3];
        for (int i = 0; i < 3; ++i) {
            to[i] = {from[i].x - origin[0], from[i].y - origin[1], from[i].z - origin[2]};
        }
        const sat::PairLimits<float> limits{d, c.margin, c.r_square};
        return c.has_margin ? sat::apart<true>(v, to, limits) : sat::apart<false>(v, to, limits);
    }
};

/// One size of leaf, at one distance from its mesh's origin.
struct LeafKind {
    const char* name;
    double half_mm, at_mm;
    bool is_sliver = false;
};
constexpr LeafKind kKinds[] = {
    {"10 mm", 10, 10},
    {"10 mm, slivers", 10, 10, true},
    {"1 m at 1 m", 1e3, 1e3},
    {"1 um", 1e-3, 1e-3},
    {"100 mm at 1e5 mm", 100, 9.9e4},
    {"100 mm at 1e5 mm, slivers", 100, 9.9e4, true},
    {"50 m", 5e4, 0},
    {"50 m, slivers", 5e4, 0, true},
};

struct MotionTally {
    unsigned cases = 0, claims = 0, without_leaf = 0;
    double worst_error = 0;  // of a coordinate beyond its own rounding, in u h
};

/// Section 4: |computed - true| <= u |computed| + 8u d, for every coordinate.
void check_vertices(const Moved1& moved, const Aabb& leaf, const ExactTriangle& truth,
                    const char* name, MotionTally& tally) {
    const double h = std::max({leaf.h[0], leaf.h[1], leaf.h[2]});
    for (std::size_t i = 0; i < 3; ++i) {
        const float got[3] = {moved.v[i].x, moved.v[i].y, moved.v[i].z};
        for (std::size_t k = 0; k < 3; ++k) {
            const Dyadic error = Dyadic(got[k]) + Dyadic(moved.origin[k]) - truth[i][k];
            const double own = kUnit * std::fabs(double(got[k]));
            const Dyadic allowed = Dyadic(own) + Dyadic(8 * kUnit * moved.leaf_d);
            EXPECT_GE((allowed - error).sign(), 0) << name;
            EXPECT_GE((allowed + error).sign(), 0) << name;
            tally.worst_error = std::max(
                tally.worst_error,
                (std::fabs(error.value().get_d()) - own - 8 * kUnit * moved.c.d32) / (kUnit * h));
        }
    }
}

class Adversary {
  public:
    Adversary(std::mt19937_64& random, const LeafKind& kind) : random_(random), kind_(kind) {
        q_.pose = random_turn(random);
        k_ = static_cast<int>(random() % 3);
        make_leaf();
    }

    /// The worst vertex of some draws, and b's triangle where that would be missed.
    bool make() {
        Vec3f best{};
        double most = 0;
        for (int i = 0; i < kDraws; ++i) {
            const Vec3f v = near_plane();
            const double error = error_of(v);
            if (std::fabs(error) > std::fabs(most)) {
                best = v, most = error;
            }
        }
        if (most == 0) {
            return false;
        }
        put_triangles(best, most > 0 ? 1 : -1);
        return true;
    }

    void judge(MotionTally& tally) {
        const Triangle &ta = a_.triangles.back(), &tb = b_.triangles.back();
        const ExactTriangle truth = placed(q_.pose, ta);
        const Moved1 moved(q_, a_, b_, leaf_, ta);
        check_vertices(moved, leaf_, truth, kind_.name, tally);
        const ExactSquare distance = squared_distance(truth, exact(tb));
        if (distance.more_than(q_.r_mm)) {
            return;  // roundings of b's triangle put it beyond
        }
        ++tally.cases;
        tally.claims += moved.claims(tb, moved.leaf_d) ? 1 : 0;
        tally.without_leaf += moved.claims(tb, moved.c.d32) ? 1 : 0;
        for (const LaneSet set : lane_sets()) {
            CpuEngine engine = *engine_over({a_, b_}, {}, set);
            for (const bool is_float_only : {true, false}) {
                q_.is_float_only = is_float_only;
                const QueryResult result = run_query(engine, q_);
                EXPECT_EQ(result.status, QueryStatus::ok);
                EXPECT_EQ(result.proof, Proof::not_proven) << kind_.name << ", r " << q_.r_mm;
            }
        }
    }

  private:
    /// Two points span the leaf's box.
    void make_leaf() {
        Vec3f low, high;
        const auto draw = [this](float& from, float& to) {
            const double at = between(random_, -1, 1) * kind_.at_mm;
            from =
                static_cast<float>(std::max(at - kind_.half_mm * between(random_, 0.5, 1), -1e5));
            to = static_cast<float>(std::min(at + kind_.half_mm * between(random_, 0.5, 1), 1e5));
        };
        draw(low.x, high.x), draw(low.y, high.y), draw(low.z, high.z);
        a_.triangles = {{low, low, low}, {high, high, high}};
        leaf_ = build_tree(a_.triangles).nodes[0].box;
        for (int i = 0; i < 3; ++i) {
            const double* const row = q_.pose.r[i];
            const double to = row[0] * leaf_.c[0] + row[1] * leaf_.c[1] + row[2] * leaf_.c[2];
            q_.pose.t[i] = between(random_, -1, 1) * 0x1p-12 * kind_.half_mm - to;
        }
    }

    /// In the leaf's box, where one coordinate of its moved vertex is next to nothing.
    Vec3f near_plane() {
        const double* const row = q_.pose.r[k_];
        int out = 0;
        for (int j = 1; j < 3; ++j) {
            out = std::fabs(row[j]) > std::fabs(row[out]) ? j : out;
        }
        double y[3];
        do {
            for (int j = 0; j < 3; ++j) {
                y[j] = between(random_, -1, 1) * double(leaf_.h[j]);
            }
            y[out] = 0;
            y[out] = -(row[0] * y[0] + row[1] * y[1] + row[2] * y[2]) / row[out];
        } while (std::fabs(y[out]) > 0.999 * double(leaf_.h[out]));
        return {static_cast<float>(leaf_.c[0] + y[0]), static_cast<float>(leaf_.c[1] + y[1]),
                static_cast<float>(leaf_.c[2] + y[2])};
    }

    /// What moving it costs along that axis, computed less true.
    double error_of(const Vec3f& v) const {
        const Moved1 moved(q_, a_, b_, leaf_, {v, v, v});
        const float got[3] = {moved.v[0].x, moved.v[0].y, moved.v[0].z};
        const double* const row = q_.pose.r[k_];
        return got[k_] - std::fma(row[0], coordinate(v, 0),
                                  std::fma(row[1], coordinate(v, 1),
                                           std::fma(row[2], coordinate(v, 2),
                                                    q_.pose.t[k_] - moved.origin[k_])));
    }

    /// A small triangle of a with its lowest corner in v (its highest where `side` is -1), and one
    /// of b in the plane through that corner's true place, as near as floats tell.
    void put_triangles(const Vec3f& v, int side) {
        double size = 0;
        for (int k = 0; k < 3; ++k) {
            size = std::max(size, std::fabs(coordinate(v, k)));
        }
        size = std::max(0x1p-12 * kind_.half_mm, 32 * kUnit * size);
        const double* const up = q_.pose.r[k_];
        const double* const along = q_.pose.r[(k_ + 1) % 3];
        const double thin = kind_.is_sliver ? 0x1p-10 : 1;
        const auto beside = [&](double aside) {
            const auto at = [&](int k) {
                return static_cast<float>(coordinate(v, k) +
                                          size * (side * up[k] + aside * along[k]));
            };
            return Vec3f{at(0), at(1), at(2)};
        };
        a_.triangles.resize(2);
        a_.triangles.push_back({v, beside(thin), beside(-thin)});
        const ExactTriangle truth = placed(q_.pose, a_.triangles.back());
        // The greatest r so that the plane still lies above the corner, or on it.
        q_.r_mm = (random_() & 1U) == 0 ? 0 : 4 * size;
        const double corner = truth[0][static_cast<std::size_t>(k_)].value().get_d();
        float plane = static_cast<float>(corner - side * q_.r_mm);
        const float beyond = side > 0 ? HUGE_VALF : -HUGE_VALF;
        const auto is_short = [&] {
            const Dyadic gap = truth[0][static_cast<std::size_t>(k_)] - Dyadic(plane);
            return side * (gap - Dyadic(side * q_.r_mm)).sign() > 0;
        };
        while (is_short()) {
            plane = std::nextafter(plane, beyond);
        }
        float at[3][3];
        for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k) {
                const double foot = truth[0][static_cast<std::size_t>(k)].value().get_d();
                at[i][k] = k == k_
                               ? plane
                               : static_cast<float>(
                                     foot + size * (i == (k == (k_ + 1) % 3 ? 1 : 2) ? 16 : -8));
            }
        }
        b_.triangles = {{{at[0][0], at[0][1], at[0][2]},
                         {at[1][0], at[1][1], at[1][2]},
                         {at[2][0], at[2][1], at[2][2]}}};
    }

    std::mt19937_64& random_;
    const LeafKind& kind_;
    int k_ = 0;
    Query q_{.mesh_a = 0, .mesh_b = 1, .pose = {}};
    Aabb leaf_{};
    Mesh a_{"a", {}}, b_{"b", {}};
};

TEST(LeafMotion, ATriangleThatIsNotApartIsNeverClaimedToBe) {
    std::mt19937_64 random(printed_seed(20261128));
    const unsigned count = exact_count(240, 24);
    unsigned cases = 0, without_leaf = 0;
    for (const LeafKind& kind : kKinds) {
        MotionTally tally;
        for (unsigned i = 0; i < count && !HasFailure(); ++i) {
            Adversary adversary(random, kind);
            if (adversary.make()) {
                adversary.judge(tally);
            }
        }
        std::printf(
            "%-26s %u pairs, %u false claims; %u with the leaf's term left out; a "
            "coordinate off by %.2f u h at most\n",
            kind.name, tally.cases, tally.claims, tally.without_leaf, tally.worst_error);
        EXPECT_EQ(tally.claims, 0U) << kind.name;
        cases += tally.cases;
        without_leaf += tally.without_leaf;
    }
    EXPECT_GT(cases, count * std::size(kKinds) / 2) << "hardly a pair is judged";
    EXPECT_GT(without_leaf, cases / 10) << "the term is not what keeps the claims true";
}

// Found by an adversary that chose rows and corners so that all roundings go one way: nearly the
// whole term is needed, so no smaller factor would do.
TEST(LeafMotion, NearlyTheWholeTermIsNeeded) {
    Mesh a{"a", {}}, b{"b", {}};
    const Vec3f low{-0x1.6131dp+4F, -0x1.fd2cep+4F, -0x1.12014cp+5F};
    const Vec3f high{0x1.4f67b2p+5F, 0x1.016a2ap+5F, 0x1.dbfe9cp+4F};
    const Vec3f v{0x1.4f6792p+5F, -0x1.fd2c4cp+4F, -0x1.12012ep+5F};
    a.triangles = {{low, low, low}, {high, high, high}};
    b.triangles = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    Query q{.mesh_a = 0, .mesh_b = 1, .pose = {}};
    const double rows[3][3] = {{0x1.28b6ccfe69ac9p-1, 0x1.00039b02814acp-1, 0x1.497c9f007011ap-1},
                               {-0x1.a13f0cc19eb3dp-1, 0x1.65e01c5dc32b1p-2, 0x1.d96aa8d66b9eep-2},
                               {0x1.9ac30eb21895p-8, -0x1.95afea93ccd3fp-1, 0x1.385521beb8365p-1}};
    const double shift[3] = {-0x1.1ce6f5000001p+2, 0x1.dc90580c138e6p+1, 0x1.f2e9daa97c288p+1};
    for (int i = 0; i < 3; ++i) {
        std::copy(rows[i], rows[i] + 3, q.pose.r[i]);
        q.pose.t[i] = shift[i];
    }
    const Triangle triangle{v, v, v};
    const Aabb leaf = build_tree(a.triangles).nodes[0].box;
    MotionTally tally;
    check_vertices(Moved1(q, a, b, leaf, triangle), leaf, placed(q.pose, triangle), "corner",
                   tally);
    EXPECT_GT(tally.worst_error, 4.6) << "in u h, of 5.39";
}

}  // namespace
}  // namespace axg::test

#else
TEST(LeafMotion, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
