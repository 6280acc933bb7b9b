// SPDX-License-Identifier: Apache-2.0
// Boxes of axis positions against samples of them: no position in a box brings two bodies closer
// than the levers say, and what is proven of a box holds at every position tried. The oracle
// measures surfaces on its own (tests/support/surface_distance.hpp). AXG_COUNT: machines.
#include "core/certificate/joint_box_proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/certificate/box_poses.hpp"
#include "tests/support/engine_fixture.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/surface_distance.hpp"
#include "tests/support/triangle_cases.hpp"

namespace axg::test {
namespace {

using Random = std::mt19937_64;

unsigned machine_count(unsigned usual) {
    const char* const text = std::getenv("AXG_COUNT");
    return text == nullptr ? usual : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

Vec3d unit_vector(Random& random) {
    const Pose turn = random_turn(random);
    return {turn.r[0][0], turn.r[1][0], turn.r[2][0]};
}

Mesh random_box(Random& random) {
    const auto size = [&] { return static_cast<float>(between(random, 2, 60)); };
    const Vec3f low{-size(), -size(), -size()}, high{size(), size(), size()};
    return {"box", box(low, high)};
}

/// A random tree of two to seven bodies; some joints share an axis, some are fixed.
Machine random_machine_of(Random& random, std::vector<Mesh>& meshes) {
    Machine m;
    const std::size_t bodies = 2 + random() % 6, axes = 1 + random() % 5;
    for (std::size_t i = 0; i < axes; ++i) {
        Axis axis;
        axis.kind = (random() & 1U) != 0 ? AxisKind::linear : AxisKind::rotary;
        m.axes.push_back(axis);
    }
    for (std::size_t i = 0; i < bodies; ++i) {
        Body body;
        body.parent =
            i == 0 || (random() & 3U) == 0 ? kNoIndex : static_cast<std::uint32_t>(random() % i);
        if ((random() & 7U) != 0) {
            body.joint.axis = static_cast<std::uint32_t>(random() % axes);
            body.joint.direction = unit_vector(random);
            body.joint.pivot_mm = {between(random, -200, 200), between(random, -200, 200),
                                   between(random, -200, 200)};
        }
        body.at = random_turn(random);
        for (double& t : body.at.t) {
            t = between(random, -300, 300);
        }
        m.bodies.push_back(body);
        meshes.push_back(random_box(random));
    }
    return m;
}

JointBox random_joint_box(Random& random, const Machine& m, double scale = 1) {
    JointBox b;
    for (std::size_t i = 0; i < m.axes.size(); ++i) {
        const bool is_linear = m.axes[i].kind == AxisKind::linear;
        b.centre[i] = is_linear ? between(random, -200, 200) : between(random, -4, 4);
        const double size = scale * std::exp2(between(random, -10, 1));
        b.half[i] = (random() & 3U) == 0 ? 0 : is_linear ? 60 * size : size;
    }
    return b;
}

/// A corner, a face or an inner point of the box.
std::array<double, kAxesMax> somewhere_in(Random& random, const JointBox& b) {
    std::array<double, kAxesMax> q = b.centre;
    for (std::size_t i = 0; i < q.size(); ++i) {
        const double u =
            (random() & 1U) != 0 ? ((random() & 1U) != 0 ? 1 : -1) : between(random, -1, 1);
        q[i] += u * b.half[i];
    }
    return q;
}

struct Fixture {
    std::vector<Mesh> meshes;  // before the machine: random_machine_of fills it
    Machine machine;
    std::vector<DistanceTree> trees;
    std::vector<BodyExtent> extents;

    explicit Fixture(Random& random) : machine(random_machine_of(random, meshes)) {
        for (const Mesh& mesh : meshes) {
            trees.emplace_back(mesh.triangles);
            extents.push_back(extent_of(mesh));
        }
    }
    [[nodiscard]] double distance_mm(std::uint32_t a, std::uint32_t b,
                                     const std::array<double, kAxesMax>& q) const {
        std::array<Pose, kBodiesMax> placed;
        place_bodies(machine, q, placed);
        return surface_distance(trees[a], trees[b], relative_pose(placed[a], placed[b]), 1e5);
    }
    [[nodiscard]] double motion_mm(std::uint32_t a, std::uint32_t b, const JointBox& box) const {
        std::array<Pose, kBodiesMax> moved;
        move_bodies(machine, box.centre, moved);
        const PlacedBody pa{&extents[a], compose(moved[a], machine.bodies[a].at)};
        const PlacedBody pb{&extents[b], compose(moved[b], machine.bodies[b].at)};
        return motion_along(machine, path_between(machine, a, b), moved, pa, pb, box).total_mm;
    }
    [[nodiscard]] PathLevers levers(std::uint32_t a, std::uint32_t b, const JointBox& box) const {
        std::array<Pose, kBodiesMax> moved;
        move_bodies(machine, box.centre, moved);
        const PlacedBody pa{&extents[a], compose(moved[a], machine.bodies[a].at)};
        const PlacedBody pb{&extents[b], compose(moved[b], machine.bodies[b].at)};
        return levers_over(machine, path_between(machine, a, b), moved, pa, pb, box);
    }
    [[nodiscard]] JointBoxTask task(std::uint32_t a, std::uint32_t b, double margin_mm,
                                    const JointBox& box) const {
        JointBoxTask t;
        t.body_a = t.mesh_a = a, t.body_b = t.mesh_b = b;
        t.extent_a = &extents[a], t.extent_b = &extents[b];
        t.at_a = machine.bodies[a].at, t.at_b = machine.bodies[b].at;
        t.path = path_between(machine, a, b);
        t.margin_mm = margin_mm;
        t.box = box;
        return t;
    }
};

TEST(JointPath, NoPositionInTheBoxComesCloserThanTheMotionSays) {
    Random random(printed_seed(20261140));
    unsigned moved = 0;
    double tightest = 0;  // share of the motion that some position really used
    const unsigned machines = machine_count(300);
    for (unsigned i = 0; i < machines && !HasFailure(); ++i) {
        const Fixture fixture(random);
        const auto bodies = static_cast<std::uint32_t>(fixture.machine.bodies.size());
        for (unsigned round = 0; round < 4; ++round) {
            const auto a = static_cast<std::uint32_t>(random() % bodies);
            const auto b = static_cast<std::uint32_t>(random() % bodies);
            if (a == b) {
                continue;
            }
            const JointBox box = random_joint_box(random, fixture.machine);
            const double motion = fixture.motion_mm(a, b, box);
            const double from = fixture.distance_mm(a, b, box.centre);
            for (unsigned k = 0; k < 20; ++k) {
                const double to = fixture.distance_mm(a, b, somewhere_in(random, box));
                EXPECT_GE(to, from - motion - 1e-9) << "machine " << i;
                if (motion > 1e-6) {
                    ++moved;
                    tightest = std::max(tightest, (from - to) / motion);
                }
            }
        }
    }
    std::printf("%u positions; at most %.3f of the motion was used\n", moved, tightest);
    EXPECT_GT(moved, machines * 10 / 3);
    EXPECT_GT(tightest, 0.8) << "the motions are so wide that the test could not fail";
}

/// A part of the box as cuts make them, wherever it lies in it.
JointBox part_of(Random& random, const JointBox& whole) {
    JointBox part = whole;
    for (std::size_t i = 0; i < part.centre.size(); ++i) {
        const double share = std::exp2(-static_cast<double>(random() % 4));
        part.half[i] *= share;
        part.centre[i] += between(random, -1, 1) * (1 - share) * whole.half[i];
    }
    return part;
}

// The levers of a whole box hold in every part of it; those of a part do not hold elsewhere.
TEST(JointPath, LeversOfTheWholeBoxHoldInEveryPart) {
    Random random(printed_seed(20261142));
    unsigned moved = 0;
    double tightest = 0;
    const unsigned machines = machine_count(300);
    for (unsigned i = 0; i < machines && !HasFailure(); ++i) {
        const Fixture fixture(random);
        const auto bodies = static_cast<std::uint32_t>(fixture.machine.bodies.size());
        for (unsigned round = 0; round < 4; ++round) {
            const auto a = static_cast<std::uint32_t>(random() % bodies);
            const auto b = static_cast<std::uint32_t>(random() % bodies);
            if (a == b) {
                continue;
            }
            const JointBox whole = random_joint_box(random, fixture.machine, 4);
            const PathLevers levers = fixture.levers(a, b, whole);
            const JointBox part = part_of(random, whole);
            const double motion =
                motion_by(fixture.machine, path_between(fixture.machine, a, b), levers, part.half)
                    .total_mm;
            const double from = fixture.distance_mm(a, b, part.centre);
            for (unsigned k = 0; k < 20; ++k) {
                const double to = fixture.distance_mm(a, b, somewhere_in(random, part));
                EXPECT_GE(to, from - motion - 1e-9) << "machine " << i;
                if (motion > 1e-6) {
                    ++moved;
                    tightest = std::max(tightest, (from - to) / motion);
                }
            }
        }
    }
    std::printf("%u positions; at most %.3f of the motion was used\n", moved, tightest);
    EXPECT_GT(moved, machines * 10 / 3);
    EXPECT_GT(tightest, 0.7) << "the motions are so wide that the test could not fail";
}

// Poses of a grid against those of whole kinematics, with a memo that earlier grids have filled.
TEST(BoxPoses, AreThoseOfTheKinematicsAtEveryPlaceOfAGrid) {
    Random random(printed_seed(20261143));
    double worst = 0;
    unsigned posed = 0;
    const unsigned machines = machine_count(300);
    for (unsigned i = 0; i < machines && !HasFailure(); ++i) {
        const Fixture fixture(random);
        BoxPoses poses(fixture.machine);
        const auto bodies = static_cast<std::uint32_t>(fixture.machine.bodies.size());
        for (unsigned round = 0; round < 8; ++round) {
            const auto a = static_cast<std::uint32_t>(random() % bodies);
            const auto b = static_cast<std::uint32_t>(random() % bodies);
            const JointBox whole = random_joint_box(random, fixture.machine);
            const JointBoxTask task = fixture.task(a, b, 0, whole);
            std::vector<JointBox> level{whole};
            std::uint32_t cut = 0;
            // 256 places of one joint are more than a half remembers: they share entries.
            const bool is_one_axis = round % 4 == 0;
            const unsigned cuts = is_one_axis ? 8 : random() % 8;
            auto axis = static_cast<std::uint32_t>(random() % fixture.machine.axes.size());
            for (unsigned depth = 0; depth < cuts; ++depth) {
                if (!is_one_axis) {
                    axis = static_cast<std::uint32_t>(random() % fixture.machine.axes.size());
                }
                cut |= 1U << axis;
                std::vector<JointBox> next;
                for (const JointBox& box : level) {
                    next.push_back(half_of(box, axis, false, whole));
                    next.push_back(half_of(box, axis, true, whole));
                }
                level = next;
            }
            poses.begin(task, whole, level[0], cut);
            for (const JointBox& box : level) {
                std::array<Pose, kBodiesMax> placed;
                place_bodies(fixture.machine, box.centre, placed);
                const Pose expected = relative_pose(placed[a], placed[b]);
                const Pose pose = poses.at(box.centre);
                ++posed;
                for (int k = 0; k < 3; ++k) {
                    worst = std::max(worst, std::fabs(pose.t[k] - expected.t[k]));
                    for (int n = 0; n < 3; ++n) {
                        worst = std::max(worst, 1e3 * std::fabs(pose.r[k][n] - expected.r[k][n]));
                    }
                }
            }
        }
    }
    std::printf("%u poses; at most %.3g mm apart\n", posed, worst);
    EXPECT_LT(worst, 1e-9);
    EXPECT_GT(posed, machines * 20);
}

/// Two links of 300 mm, folded so that the far end lies on both axes at the centre.
Fixture two_links(Random& random) {
    Fixture fixture(random);
    Machine& m = fixture.machine;
    m = Machine{};
    m.axes.resize(2);
    m.axes[0].kind = m.axes[1].kind = AxisKind::rotary;
    m.bodies.resize(3);
    m.bodies[0].at.t[2] = 3.05;  // a plate that the tip just clears
    m.bodies[1].joint = {0, {0, 1, 0}, {0, 0, 0}};
    m.bodies[2].parent = 1;
    m.bodies[2].joint = {1, {0, 1, 0}, {0, 0, 0}};
    fixture.meshes = {{"plate", box({-50, -50, 0}, {50, 50, 1})},
                      {"link", box({300, -1, -1}, {301, 1, 1})},
                      {"tip", box({-0.02F, -0.02F, -0.02F}, {0.02F, 0.02F, 0.02F})}};
    // The second axis stands 300 mm out on the first link; the tip, folded back, on the first axis.
    m.bodies[2].joint.pivot_mm = {300, 0, 0};
    fixture.trees.clear();
    fixture.extents.clear();
    for (const Mesh& mesh : fixture.meshes) {
        fixture.trees.emplace_back(mesh.triangles);
        fixture.extents.push_back(extent_of(mesh));
    }
    return fixture;
}

// Levers taken at the centre alone are wrong: turning the second joint moves the tip away from the
// first axis, which then moves it too.
TEST(JointPath, LeversGrowWithTheJointsBetween) {
    Random random(1);
    const Fixture fixture = two_links(random);
    JointBox box;
    box.half[0] = box.half[1] = 0.1;
    const double tip = fixture.extents[2].radius_mm;
    const double second_mm = 2 * (300 + tip) * std::sin(0.05);
    // At the centre the tip lies on the first axis: its lever there is the tip's own size.
    const double at_the_centre_mm = 2 * tip * std::sin(0.05) + second_mm;
    const double motion_mm = fixture.motion_mm(2, 0, box);
    EXPECT_GT(motion_mm, at_the_centre_mm + 2.9) << "3 mm are lost by levers at the centre alone";
    EXPECT_LT(motion_mm, at_the_centre_mm + 3.1);
}

// X and Y carry one body, Z the other: the way between them is one shift, no longer than the
// diagonal of the box. A rotary joint in between tears it in two.
TEST(JointPath, LinearJointsTogetherMoveNoFartherThanTheDiagonal) {
    Random random(1);
    Fixture fixture(random);
    Machine& m = fixture.machine;
    m = Machine{};
    m.axes.resize(4);
    for (Axis& axis : m.axes) {
        axis.kind = AxisKind::linear;
    }
    m.bodies.resize(4);
    m.bodies[0].joint = {0, {1, 0, 0}, {}};
    m.bodies[1].joint = {1, {0, 1, 0}, {}};
    m.bodies[1].parent = 0;
    m.bodies[2].joint = {2, {0, 0, 1}, {}};
    m.bodies[3].joint = {3, {0, 0, 1}, {}};
    m.bodies[3].parent = 2;
    fixture.extents.assign(4, extent_of({"cube", box({-1, -1, -1}, {1, 1, 1})}));
    JointBox box;
    box.half = {3, 4, 12, 0};
    EXPECT_NEAR(fixture.motion_mm(1, 3, box), 13, 1e-9);
    box.half[3] = 12;  // along the same direction: the lengths add up
    EXPECT_NEAR(fixture.motion_mm(1, 3, box), std::sqrt(25.0 + 24 * 24), 1e-9);
    m.axes[2].kind = AxisKind::rotary;
    box.half[2] = 0;
    EXPECT_NEAR(fixture.motion_mm(1, 3, box), 5.0 + 12.0, 1e-9);
    // Nothing that moves is lost where squares vanish.
    box.half = {0x1p-600, 0x1p-600, 0, 0};
    EXPECT_GE(fixture.motion_mm(1, 3, box), 0x1p-599);
}

TEST(JointBoxProver, WhatIsProvenHoldsAtEveryPositionTried) {
    Random random(printed_seed(20261141));
    unsigned proven = 0, spent = 0, split = 0;
    const unsigned machines = machine_count(200);
    for (unsigned i = 0; i < machines && !HasFailure(); ++i) {
        const Fixture fixture(random);
        auto engine = engine_over(fixture.meshes);
        ASSERT_TRUE(engine);
        auto prover = JointBoxProver::create(fixture.machine, 4, {.rounds = 8, .queries = 600});
        ASSERT_TRUE(prover);
        std::vector<JointBoxTask> tasks;
        const auto bodies = static_cast<std::uint32_t>(fixture.machine.bodies.size());
        for (unsigned k = 0; k < 4; ++k) {
            const auto a = static_cast<std::uint32_t>(random() % bodies);
            const auto b = static_cast<std::uint32_t>(random() % bodies);
            if (a != b) {
                tasks.push_back(fixture.task(a, b, between(random, 0, 5),
                                             random_joint_box(random, fixture.machine, 8)));
            }
        }
        std::vector<JointBoxResult> results(tasks.size());
        prover->prove(engine->engine(), tasks, results);
        for (std::size_t k = 0; k < tasks.size(); ++k) {
            const JointBoxTask& t = tasks[k];
            proven += results[k].proof == JointBoxProof::proven ? 1 : 0;
            spent += results[k].proof == JointBoxProof::budget_spent ? 1 : 0;
            split += results[k].queries > 1 ? 1 : 0;
            for (unsigned n = 0; results[k].proof == JointBoxProof::proven && n < 60; ++n) {
                EXPECT_GT(fixture.distance_mm(t.body_a, t.body_b, somewhere_in(random, t.box)),
                          t.margin_mm - 1e-9)
                    << "machine " << i;
            }
        }
    }
    std::printf("%u proven, %u not proven, %u split\n", proven, spent, split);
    EXPECT_GT(proven, machines / 2);
    EXPECT_GE(spent, machines / 10);
    EXPECT_GT(split, machines / 4);
}

// A thin wall between two positions that are both clear: the samples see nothing, the box does.
TEST(JointBoxProver, NothingTunnelsThroughAThinWall) {
    Machine m;
    m.axes.resize(1);
    m.bodies.resize(2);
    m.bodies[1].joint = {0, {1, 0, 0}, {}};
    const std::vector<Mesh> meshes{{"wall", box({0, -50, -50}, {0.1F, 50, 50})},
                                   {"ball", box({-1, -1, -1}, {1, 1, 1})}};
    const BodyExtent extents[2] = {extent_of(meshes[0]), extent_of(meshes[1])};
    auto engine = engine_over(meshes);
    auto prover = JointBoxProver::create(m, 1, {.rounds = 20, .queries = 5000});
    ASSERT_TRUE(engine && prover);
    JointBoxTask task;
    task.body_a = task.mesh_a = 1, task.body_b = task.mesh_b = 0;
    task.extent_a = &extents[1], task.extent_b = &extents[0];
    task.path = path_between(m, 1, 0);
    JointBoxResult result;
    const auto prove = [&](double centre, double half) {
        task.box.centre[0] = centre;
        task.box.half[0] = half;
        prover->prove(engine->engine(), {&task, 1}, {&result, 1});
        return result.proof;
    };
    EXPECT_EQ(prove(-5, 0), JointBoxProof::proven);
    EXPECT_EQ(prove(5, 0), JointBoxProof::proven);
    EXPECT_EQ(prove(0, 5), JointBoxProof::budget_spent);
    EXPECT_NEAR(result.open.centre[0], 0, 1.2) << "the box left open is where the wall is";
    EXPECT_EQ(prove(-3.5, 2.4), JointBoxProof::proven);
    EXPECT_EQ(prove(-3.5, 2.6), JointBoxProof::budget_spent);
}

}  // namespace
}  // namespace axg::test
