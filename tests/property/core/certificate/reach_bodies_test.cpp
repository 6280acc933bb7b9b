// SPDX-License-Identifier: Apache-2.0
// The box that a page draws around a body's reach is a bound: at random positions in random joint
// boxes no point of the surface leaves it; and it is no larger than it has to be where the body
// moves in a straight line.
#include "core/certificate/reach_bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "core/machine/kinematics.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/count.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

enum : std::uint32_t { kPlate = 3, kCutterBody = 5 };  // motion_test_machine

Pose turned(double angle, Vec3d shift) {
    const double c = std::cos(angle), s = std::sin(angle);
    Pose pose;
    pose.r[0][0] = c;
    pose.r[0][1] = -s;
    pose.r[1][0] = s;
    pose.r[1][1] = c;
    pose.t[0] = shift.x;
    pose.t[1] = shift.y;
    pose.t[2] = shift.z;
    return pose;
}

/// How far a point is outside of the box, 0: it is inside.
double outside_mm(const ReachBody& reach, Vec3d point) {
    const Vec3d p = apply(inverse(reach.placed), point);
    return std::max({0.0, reach.low_mm.x - p.x, p.x - reach.high_mm.x, reach.low_mm.y - p.y,
                     p.y - reach.high_mm.y, reach.low_mm.z - p.z, p.z - reach.high_mm.z});
}

TEST(ReachBody, NoPointOfTheSurfaceLeavesItsBox) {
    std::mt19937_64 random(printed_seed(29'112'602));
    const auto in = [&random](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const Machine m = motion_test_machine();
    const Mesh mesh{"body", box({-80, -20, -30}, {90, 60, 15})};
    const std::uint64_t tries = count_from_environment(2000);
    double used = 0;  // the largest share of the bound that was needed
    for (std::uint64_t k = 0; k < tries; ++k) {
        const std::uint32_t body = k % 2 == 0 ? kPlate : kCutterBody;
        const Pose at = turned(in(-3, 3), {in(-50, 50), in(-50, 50), in(-50, 50)});
        JointBox joints;
        for (std::uint32_t i = 0; i < m.axes.size(); ++i) {
            const bool is_linear = m.axes[i].kind == AxisKind::linear;
            joints.centre[i] = is_linear ? in(-200, 200) : in(-2, 2);
            joints.half[i] = is_linear ? in(0, 30) : in(0, k % 5 == 0 ? 2 : 0.2);
        }
        const ReachBody reach = reach_body(m, body, at, extent_of(mesh), joints);
        for (int step = 0; step < 20; ++step) {
            std::array<double, kAxesMax> position{};
            for (std::uint32_t i = 0; i < m.axes.size(); ++i) {
                const double share = step % 2 == 0 ? (in(-1, 1) < 0 ? -1 : 1) : in(-1, 1);
                position[i] = joints.centre[i] + share * joints.half[i];
            }
            std::array<Pose, kBodiesMax> moved;
            move_bodies(m, position, moved);
            const Pose there = compose(moved[body], at);
            for (const Triangle& triangle : mesh.triangles) {
                const Vec3d from = apply(reach.placed, widen(triangle.a));
                const Vec3d to = apply(there, widen(triangle.a));
                const Vec3d gone = to - from;
                used = std::max(used, std::sqrt(dot(gone, gone)) / reach.moves_mm);
                ASSERT_LE(std::sqrt(dot(gone, gone)), reach.moves_mm + 1e-9);
                ASSERT_LE(outside_mm(reach, to), 1e-9) << "body " << body << ", case " << k;
            }
        }
    }
    std::printf("at most %.3f of the bound was used\n", used);
    EXPECT_GT(used, 0.7) << "a bound that is far too wide shows nothing";
}

// Of a body in a straight line it is what the joint moves.
TEST(ReachBody, OfOneLinearJointItIsItsHalfWidth) {
    const Machine m = motion_test_machine();
    const Mesh mesh{"body", box({-1, -2, -3}, {4, 5, 6})};
    JointBox joints;
    joints.half[2] = 7;
    const ReachBody reach = reach_body(m, kCutterBody, {}, extent_of(mesh), joints);
    EXPECT_NEAR(reach.moves_mm, 7, 1e-9);
    EXPECT_NEAR(reach.low_mm.z, -10, 1e-9);
    EXPECT_NEAR(reach.high_mm.x, 11, 1e-9);
}

}  // namespace
}  // namespace axg::test
