// SPDX-License-Identifier: Apache-2.0
// The CPU engine on small bodies near contact, judged pair by pair in exact arithmetic with the
// numbers of the pose taken as they are: every claim true, every lane set the same bits, and what
// stays undecided below a millionth of a mm. The number of poses: AXG_COUNT.
#include <gtest/gtest.h>

#ifdef AXG_EXACT
#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

#include "core/collision/cpu_engine.hpp"
#include "tests/support/count.hpp"
#include "tests/support/exact_bodies.hpp"
#include "tests/support/exact_distance.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

constexpr double kBandMm = 1e-6;   // what the recheck in double may leave undecided
constexpr double kShortMm = 1e-5;  // clearance below the distance: 2^-24 of 200 mm
constexpr Capacities kRoomForAll{.node_pairs = 8192, .triangle_pairs = 8192, .rechecks = 8192};

unsigned pose_count() {
    return test::exact_count(360, 30);
}

bool same(const QueryResult& x, const QueryResult& y) {
    return x.status == y.status && x.proof == y.proof && x.touching == y.touching &&
           x.clearance_mm == y.clearance_mm && x.nearest == y.nearest &&
           x.node_pairs == y.node_pairs && x.triangle_pairs == y.triangle_pairs &&
           x.rechecks == y.rechecks;
}

/// One engine a lane set that this machine has.
std::vector<CpuEngine> engines_for(const Mesh& a, const Mesh& b) {
    const Mesh* const meshes[] = {&a, &b};
    std::vector<CpuEngine> engines;
    for (const LaneSet set : {LaneSet::avx512, LaneSet::avx2, LaneSet::neon}) {
        if (has_lane_set(set)) {
            std::optional<CpuEngine> made = CpuEngine::create(meshes, kRoomForAll, set);
            EXPECT_TRUE(made.has_value());
            engines.push_back(std::move(*made));
        }
    }
    EXPECT_FALSE(engines.empty());
    return engines;
}

struct Widest {
    double undecided_mm = 0;         // not proven at r = 0, though apart by this
    double undecided_margin_mm = 0;  // not proven at r, though apart by more than r by this
    double clearance_mm = 0;         // reported too small by
    unsigned queries = 0, far = 0, not_proven = 0;
};

/// Puts queries about one pose to every engine and judges the results.
class Fixture {
  public:
    Fixture(const Mesh& a, const Mesh& b, Widest& widest)
        : a_(a), b_(b), engines_(engines_for(a, b)), widest_(widest) {}

    void judge(std::mt19937_64& random, const Pose& pose) {
        truth_ = std::make_unique<ExactScene>(a_, b_, pose, kNearMm);
        pose_ = pose;
        const double d = truth_->distance_mm();
        farther(0, 0);
        clearance(kNearMm, 0);
        touching(0);
        const double power = std::ldexp(1.0, static_cast<int>(random() % 50) - 46);
        for (const double r : {d, d * (1 + between(random, -1, 1) * 0x1p-16),
                               d * (1 + between(random, -1, 1) * 0x1p-44), power}) {
            if (r <= kNearMm) {
                farther(r, 0);
                touching(r);
            }
        }
        const double error = std::ldexp(1.0, -static_cast<int>(random() % 40));
        farther(power, error);
        farther(0, error);
        clearance(kNearMm, error);
    }

  private:
    static constexpr double kNearMm = 20;

    QueryResult run_query(const Query& query) {
        QueryResult first;
        for (std::size_t i = 0; i < engines_.size(); ++i) {
            QueryResult result;
            engines_[i].run({&query, 1}, {&result, 1});
            if (i == 0) {
                first = result;
            }
            EXPECT_TRUE(same(first, result)) << engines_[i].lanes() << " answers otherwise";
        }
        EXPECT_EQ(first.status, QueryStatus::ok);
        ++widest_.queries;
        widest_.far += first.proof == Proof::far ? 1 : 0;
        widest_.not_proven += first.proof == Proof::far ? 0 : 1;
        return first;
    }

    Query query(QueryKind kind, double r, double error) const {
        return {.kind = kind,
                .mesh_a = 0,
                .mesh_b = 1,
                .r_mm = r,
                .pose_error_mm = error,
                .pose = pose_};
    }

    void farther(double r, double error) {
        const QueryResult result = run_query(query(QueryKind::farther, r, error));
        if (result.proof == Proof::far) {
            // A body may be `error` nearer than its pose says: the claim must hold there too.
            EXPECT_TRUE(truth_->distance().more_than(r + error))
                << "r " << r << ", pose error " << error
                << ": claimed, and exact arithmetic denies";
            return;
        }
        if (error == 0) {
            const double beyond = truth_->distance_mm() - r;
            double& widest = r > 0 ? widest_.undecided_margin_mm : widest_.undecided_mm;
            widest = std::max(widest, beyond);
        }
    }

    void touching(double r) {
        std::vector<TriangleIds> list(a_.triangles.size() * b_.triangles.size());
        Query q = query(QueryKind::touching, r, 0);
        q.list = list;
        const QueryResult result = run_query(q);
        ASSERT_LE(result.touching, list.size());
        list.resize(result.touching);
        std::sort(list.begin(), list.end());
        EXPECT_TRUE(std::adjacent_find(list.begin(), list.end()) == list.end()) << "a pair twice";
        EXPECT_EQ(result.proof == Proof::far, result.touching == 0);
        for (const ExactPair& pair : truth_->near()) {
            EXPECT_TRUE(pair.square.more_than(r) ||
                        std::binary_search(list.begin(), list.end(), pair.ids))
                << "r " << r << ": pair " << pair.ids.a << ", " << pair.ids.b << " is missing";
        }
    }

    void clearance(double up_to, double error) {
        const QueryResult result = run_query(query(QueryKind::clearance, up_to, error));
        const double d = truth_->distance_mm();
        const double claimed = result.clearance_mm;
        EXPECT_LE(claimed, up_to);
        EXPECT_EQ(result.proof == Proof::far, claimed > 0);
        if (claimed > 0) {
            EXPECT_TRUE(truth_->distance().at_least(claimed)) << "claimed " << claimed;
            EXPECT_GE(d, claimed + error - 1e-12) << "pose error " << error;
        }
        if (error == 0) {
            widest_.clearance_mm = std::max(widest_.clearance_mm, std::min(d, up_to) - claimed);
        }
    }

    const Mesh& a_;
    const Mesh& b_;
    std::vector<CpuEngine> engines_;
    Widest& widest_;
    Pose pose_;
    std::unique_ptr<ExactScene> truth_;
};

void judge_all(BodyKind kind_a, BodyKind kind_b, const char* name, unsigned count) {
    std::mt19937_64 random(printed_seed(20261122));
    Widest widest;
    for (unsigned made = 0; made < count && !testing::Test::HasFailure();) {
        const Mesh a = make_body(random, kind_a), b = make_body(random, kind_b);
        Fixture fixture(a, b, widest);
        for (unsigned i = 0; i < 3; ++i, ++made) {
            fixture.judge(random, pose_near(random, a, b, kind_a));
        }
    }
    std::printf(
        "%s: %u questions, %u far, %u not proven; widest undecided %.3g mm at r = 0, %.3g "
        "mm at r > 0; clearance too small by %.3g mm at most\n",
        name, widest.queries, widest.far, widest.not_proven, widest.undecided_mm,
        widest.undecided_margin_mm, widest.clearance_mm);
    EXPECT_LE(widest.undecided_mm, kBandMm);
    EXPECT_LE(widest.undecided_margin_mm, kBandMm);
    EXPECT_LE(widest.clearance_mm, kShortMm);
}

TEST(EngineExact, SoupsOfTriangles) {
    judge_all(BodyKind::soup, BodyKind::soup, "soups", pose_count());
}
TEST(EngineExact, Surfaces) {
    judge_all(BodyKind::surface, BodyKind::surface, "surfaces", pose_count() / 10);
}
TEST(EngineExact, SliversAndTrianglesWithoutArea) {
    judge_all(BodyKind::slivers, BodyKind::slivers, "slivers", pose_count());
}
TEST(EngineExact, WholeNumbersThatTouch) {
    judge_all(BodyKind::grid, BodyKind::grid, "grid", pose_count());
}
TEST(EngineExact, OneTriangleEach) {
    judge_all(BodyKind::single, BodyKind::single, "single", pose_count());
}
TEST(EngineExact, ManyTrianglesAgainstOne) {
    judge_all(BodyKind::many, BodyKind::single, "many against one", pose_count() / 6);
    judge_all(BodyKind::single, BodyKind::many, "one against many", pose_count() / 6);
}
TEST(EngineExact, AtTheEdgeOfTheDomain) {
    judge_all(BodyKind::far_away, BodyKind::far_away, "far away", pose_count() / 2);
}
TEST(EngineExact, NextToNothing) {
    judge_all(BodyKind::subnormal, BodyKind::subnormal, "subnormal", pose_count());
}

/// Whether the box holds the triangle, exactly.
testing::AssertionResult holds(const float* centre, const float* half, const Triangle& t) {
    const ExactTriangle vertices = exact(t);
    for (const ExactPoint& v : vertices) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Dyadic from = v[k] - Dyadic(centre[k]);
            if ((Dyadic(half[k]) - from).sign() < 0 || (Dyadic(half[k]) + from).sign() < 0) {
                return testing::AssertionFailure() << "outside along axis " << k;
            }
        }
    }
    return testing::AssertionSuccess();
}

/// Checks the boxes at and below a node; returns its triangles.
std::vector<std::uint32_t> check_boxes(const TreeData& tree, std::uint32_t index,
                                       const Mesh& mesh) {
    const TreeNode& node = tree.nodes[index];
    std::vector<std::uint32_t> all;
    for (std::uint32_t c = 0; c < node.count; ++c) {
        const std::vector<std::uint32_t> below =
            node.leaf != kNoLeaf ? std::vector{tree.leaves[node.leaf].triangle[c]}
                                 : check_boxes(tree, node.first_child + c, mesh);
        for (const std::uint32_t id : below) {
            const float centre[3] = {node.c[0][c], node.c[1][c], node.c[2][c]};
            const float half[3] = {node.h[0][c], node.h[1][c], node.h[2][c]};
            EXPECT_TRUE(holds(centre, half, mesh.triangles[id])) << "child of node " << index;
            EXPECT_TRUE(holds(node.box.c, node.box.h, mesh.triangles[id])) << "node " << index;
        }
        all.insert(all.end(), below.begin(), below.end());
    }
    return all;
}

// Every box of a tree holds its triangles in exact arithmetic, where a subtraction in double loses
// the small end too, and every triangle is in the tree once.
TEST(EngineExact, BoxesHoldTheirTriangles) {
    std::mt19937_64 random(printed_seed(20261123));
    for (unsigned i = 0; i < 200; ++i) {
        Mesh mesh = make_body(random, static_cast<BodyKind>(i % 7));
        mesh.triangles.push_back(
            {{1, 2, 3}, {-0x1p-100F, 0x1p-90F, 3e-40F}, {0.5F, 9e4F, -1e-30F}});
        std::vector<std::uint32_t> all = check_boxes(build_tree(mesh.triangles), 0, mesh);
        std::sort(all.begin(), all.end());
        ASSERT_EQ(all.size(), mesh.triangles.size());
        for (std::uint32_t id = 0; id < all.size(); ++id) {
            ASSERT_EQ(all[id], id);
        }
    }
}

}  // namespace
}  // namespace axg::test
#else
TEST(EngineExact, NeedsExactArithmetic) {
    GTEST_SKIP() << "built without GMP and its C++ bindings (Debian: libgmp-dev)";
}
#endif
