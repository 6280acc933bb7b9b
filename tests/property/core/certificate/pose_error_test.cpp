// SPDX-License-Identifier: Apache-2.0
// What stated errors cost is a bound: a machine whose pivots, directions and places are off by up
// to them, at random positions, brings no two points nearer than that. Left out one kind at a time,
// it is none.
#include "core/certificate/pose_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/base/sincos.hpp"
#include "core/machine/kinematics.hpp"
#include "tests/support/containment_fixture.hpp"
#include "tests/support/count.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

enum : std::uint32_t { kTurnedPlate = 3, kFallingCutter = 5 };  // motion_test_machine

double length_of(Vec3d v) {
    return std::sqrt(dot(v, v));
}
Vec3d unit_along(Vec3d v) {
    return (1 / length_of(v)) * v;
}

class PoseError : public testing::Test {
  protected:
    double in(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    }
    /// Of this length, or where `is_less` up to it.
    Vec3d any(double most, bool is_less) {
        const Vec3d way = unit_along({in(-1, 1), in(-1, 1), in(-1, 1)});
        return (is_less ? in(0, most) : most) * way;
    }

    /// States random errors for every body.
    void state() {
        for (Body& body : m.bodies) {
            body.place_error_mm = in(0, 0.2);
            body.joint.pivot_error_mm = in(0, 0.5);
            body.joint.direction_error_rad = in(0, 2e-3);
        }
    }
    /// A machine that is off by up to them.
    void make_true() {
        truth = m;
        for (std::uint32_t i = 0; i < m.bodies.size(); ++i) {
            const bool is_less = in(0, 1) < 0.3;
            Joint& joint = truth.bodies[i].joint;
            joint.pivot_mm = joint.pivot_mm + any(joint.pivot_error_mm, is_less);
            const Vec3d across = unit_along(cross(joint.direction, any(1, false)));
            joint.direction =
                unit_along(joint.direction + std::tan(joint.direction_error_rad * 0.999) * across);
            moved_by[i] = any(m.bodies[i].place_error_mm, is_less);
        }
    }
    std::array<Pose, kBodiesMax> truly_moved(const std::array<double, kAxesMax>& position) const {
        std::array<Pose, kBodiesMax> out;
        for (std::uint32_t i = 0; i < truth.bodies.size(); ++i) {
            const Body& body = truth.bodies[i];
            Pose own;
            if (body.joint.axis != kNoIndex) {
                own = joint_motion(truth.axes[body.joint.axis], body.joint,
                                   position[body.joint.axis]);
            }
            own.t[0] += moved_by[i].x;
            own.t[1] += moved_by[i].y;
            own.t[2] += moved_by[i].z;
            out[i] = body.parent == kNoIndex ? own : compose(out[body.parent], own);
        }
        return out;
    }
    double bound() const {
        return pose_error_mm(m, {.a = kTurnedPlate, .b = kFallingCutter}, kNoIndex,
                             extent_of(plate), extent_of(cutter), error_range(m));
    }
    /// The most that the two machines differ in a distance of two corners, over random positions.
    double difference_mm(int positions) {
        double most = 0;
        for (int k = 0; k < positions; ++k) {
            std::array<double, kAxesMax> position{};
            for (std::uint32_t i = 0; i < m.axes.size(); ++i) {
                const Axis& axis = m.axes[i];
                const double low = axis.unlimited ? -kPi : axis.min,
                             high = axis.unlimited ? kPi : axis.max;
                position[i] = in(0, 1) < 0.5 ? (in(0, 1) < 0.5 ? low : high) : in(low, high);
            }
            std::array<Pose, kBodiesMax> stated;
            move_bodies(m, position, stated);
            const std::array<Pose, kBodiesMax> real = truly_moved(position);
            for (const Triangle& a : plate.triangles) {
                for (const Triangle& b : cutter.triangles) {
                    const auto apart = [&](const std::array<Pose, kBodiesMax>& moved) {
                        return length_of(apply(moved[kTurnedPlate], widen(a.a)) -
                                         apply(moved[kFallingCutter], widen(b.a)));
                    };
                    most = std::max(most, std::fabs(apart(stated) - apart(real)));
                }
            }
        }
        return most;
    }

    std::mt19937_64 random{printed_seed(1'122'601)};
    Machine m = motion_test_machine(), truth = m;
    std::array<Vec3d, kBodiesMax> moved_by{};
    const Mesh plate{"plate", box({-80, -20, -30}, {90, 60, 15})};
    const Mesh cutter{"cutter", box({-5, -5, -60}, {5, 5, 0})};
};

TEST_F(PoseError, NoTwoPointsComeNearerThanItsBound) {
    const std::uint64_t machines = count_from_environment(2000);
    double used = 0;
    for (std::uint64_t k = 0; k < machines; ++k) {
        state();
        make_true();
        const double bound_mm = bound(), seen_mm = difference_mm(10);
        ASSERT_LE(seen_mm, bound_mm) << "machine " << k;
        used = std::max(used, seen_mm / bound_mm);
    }
    std::printf("at most %.3f of the bound was used\n", used);
    EXPECT_GT(used, 0.3) << "a bound that is far too wide shows nothing";
}

/// Each kind of error alone; a bound that leaves it out, or that takes a turn's error once, is
/// broken.
TEST_F(PoseError, EachKindIsNeeded) {
    double Joint::*const joints[] = {&Joint::pivot_error_mm, &Joint::direction_error_rad};
    for (double Joint::*const kind : joints) {
        for (Body& body : m.bodies) {
            body.joint.*kind = kind == joints[0] ? 0.5 : 2e-3;
        }
        make_true();
        const double whole_mm = bound();
        double seen_mm = 0;
        for (int k = 0; k < 20; ++k) {
            make_true();
            seen_mm = std::max(seen_mm, difference_mm(20));
        }
        EXPECT_LE(seen_mm, whole_mm);
        for (Body& body : m.bodies) {
            body.joint.*kind = 0;
        }
        EXPECT_GT(seen_mm, bound());
    }
    for (Body& body : m.bodies) {
        body.place_error_mm = 0.2;
    }
    make_true();
    const double seen_mm = difference_mm(50), whole_mm = bound();
    EXPECT_LE(seen_mm, whole_mm);
    for (Body& body : m.bodies) {
        body.place_error_mm = 0;
    }
    EXPECT_GT(seen_mm, bound());
}

/// The error of a pivot counts twice: after half a turn the body is off by twice as much.
TEST_F(PoseError, AHalfTurnDoublesThePivotsError) {
    for (Body& body : m.bodies) {
        const bool is_rotary =
            body.joint.axis != kNoIndex && m.axes[body.joint.axis].kind == AxisKind::rotary;
        body.joint.pivot_error_mm = is_rotary ? 0.5 : 0;
    }
    double once_mm = 0, seen_mm = 0;
    for (const Body& body : m.bodies) {
        once_mm += body.joint.pivot_error_mm;
    }
    for (int k = 0; k < 200; ++k) {
        make_true();
        seen_mm = std::max(seen_mm, difference_mm(20));
    }
    EXPECT_GT(seen_mm, once_mm);
    EXPECT_LE(seen_mm, bound());
}

/// What two bodies have in common does not change their distance.
TEST_F(PoseError, CommonCarriersCostNothing) {
    state();
    const std::uint32_t parent = m.bodies[kTurnedPlate].parent;
    ASSERT_NE(parent, kNoIndex);
    m.bodies[kTurnedPlate].place_error_mm = m.bodies[parent].place_error_mm = 0;
    m.bodies[kTurnedPlate].joint.pivot_error_mm = m.bodies[kTurnedPlate].joint.direction_error_rad =
        0;
    EXPECT_EQ(pose_error_mm(m, {.a = parent, .b = kTurnedPlate}, kNoIndex, extent_of(plate),
                            extent_of(plate), error_range(m)),
              0);
    m.bodies[parent].place_error_mm = 0.25;  // what it carries is where it is, its surface is not
    EXPECT_NEAR(pose_error_mm(m, {.a = parent, .b = kTurnedPlate}, kNoIndex, extent_of(plate),
                              extent_of(plate), error_range(m)),
                0.25, 1e-9);
}

}  // namespace
}  // namespace axg::test
