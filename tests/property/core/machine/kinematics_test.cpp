// SPDX-License-Identifier: Apache-2.0
// Each example machine's placements against its own closed form, written out here from the drawing
// of the machine and not from its file: 1e5 random poses each, to 1e-9 mm. Directions are entered
// as the closed forms have them; rotations by Eigen.
#include "core/machine/kinematics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>

#include "config/compiled/compiled_machine.hpp"
#include "tests/support/seed.hpp"

namespace {

using namespace axg;
using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr double kErrorMaxMm = 1e-9;
constexpr int kPoses = 100000;

using Positions = std::vector<double>;  // X Y Z and two rotary axes, in the file's order
/// Where a point, given in machine coordinates at the zero pose, is at q.
using ClosedForm = std::function<Vector3d(const Positions& q, const Vector3d& p)>;

struct Expectation {
    std::string body;
    ClosedForm form;
};

std::size_t body_index(const Machine& machine, const std::string& name) {
    for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
        if (machine.bodies[i].name == name) {
            return i;
        }
    }
    ADD_FAILURE() << "no body " << name;
    return 0;
}

void expect_closed_form(const std::string& file, const std::vector<Expectation>& expectations) {
    Machine machine;
    const auto faults =
        load_machine(std::string(AXG_SOURCE_DIR) + "/config/machines/" + file, machine);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]);
    ASSERT_EQ(machine.axes.size(), 5U);
    std::vector<std::size_t> index;
    for (const Expectation& e : expectations) {
        index.push_back(body_index(machine, e.body));
    }
    std::mt19937_64 random(axg::test::printed_seed(5));
    std::uniform_real_distribution<double> millimetres(-500, 500), turns(-20, 20);
    std::vector<Pose> placed(machine.bodies.size());
    double worst_mm = 0;
    for (int i = 0; i < kPoses; ++i) {
        Positions q;
        for (const Axis& axis : machine.axes) {
            q.push_back(axis.kind == AxisKind::linear ? millimetres(random) : turns(random));
        }
        const Vector3d p(millimetres(random), millimetres(random), millimetres(random));
        place_bodies(machine, q, placed);
        for (std::size_t k = 0; k < expectations.size(); ++k) {
            // The point in the mesh's frame, then where the engine's placement takes it.
            const Vec3d in_mesh =
                apply(inverse(machine.bodies[index[k]].at), {p.x(), p.y(), p.z()});
            const Vec3d got = apply(placed[index[k]], in_mesh);
            const Vector3d wanted = expectations[k].form(q, p);
            const double error = (Vector3d(got.x, got.y, got.z) - wanted).norm();
            ASSERT_LE(error, kErrorMaxMm) << expectations[k].body << ", pose " << i;
            worst_mm = std::fmax(worst_mm, error);
        }
    }
    std::printf("%s: worst of %d poses %.2g mm\n", file.c_str(), kPoses, worst_mm);
}

TEST(Kinematics, TableTiltingTrunnionMatchesItsClosedForm) {
    // ISO 841: the table carries the workpiece, so it moves against the command. C turns it about z
    // through the pivot, A tilts it about x through the pivot, then it shifts with the table.
    // Written with sines and cosines.
    const double pivot_z = -380;
    const auto plate = [pivot_z](const Positions& q, const Vector3d& p) -> Vector3d {
        const double a = -q[3], c = -q[4], z = p.z() - pivot_z;
        const double x1 = std::cos(c) * p.x() - std::sin(c) * p.y();
        const double y1 = std::sin(c) * p.x() + std::cos(c) * p.y();
        return {x1 - q[0], std::cos(a) * y1 - std::sin(a) * z - q[1],
                std::sin(a) * y1 + std::cos(a) * z + pivot_z};
    };
    const auto cradle = [plate](const Positions& q, const Vector3d& p) {
        return plate({q[0], q[1], q[2], q[3], 0}, p);
    };
    expect_closed_form("paper-trunnion.yaml",
                       {{"c", plate},
                        {"a", cradle},
                        {"x",
                         [](const Positions& q, const Vector3d& p) -> Vector3d {
                             return {p.x() - q[0], p.y() - q[1], p.z()};
                         }},
                        {"y",
                         [](const Positions& q, const Vector3d& p) -> Vector3d {
                             return {p.x(), p.y() - q[1], p.z()};
                         }},
                        {"z",
                         [](const Positions& q, const Vector3d& p) -> Vector3d {
                             return {p.x(), p.y(), p.z() + q[2]};
                         }},
                        {"cutter", [](const Positions& q, const Vector3d& p) -> Vector3d {
                             return {p.x(), p.y(), p.z() + q[2]};
                         }}});
}

TEST(Kinematics, SpindleTiltingForkMatchesItsClosedForm) {
    // The head turns: B about y, then C about z, both through the origin; then the ram carries it.
    const auto spindle = [](const Positions& q, const Vector3d& p) -> Vector3d {
        return AngleAxisd(q[4], Vector3d::UnitZ()) * (AngleAxisd(q[3], Vector3d::UnitY()) * p) +
               Vector3d(0, q[1], q[2]);
    };
    const auto fork = [spindle](const Positions& q, const Vector3d& p) {
        return spindle({q[0], q[1], q[2], 0, q[4]}, p);
    };
    expect_closed_form("spindle-tilting.yaml",
                       {{"cutter", spindle},
                        {"spindle", spindle},
                        {"fork", fork},
                        {"table",
                         [](const Positions& q, const Vector3d& p) -> Vector3d {
                             return {p.x() - q[0], p.y(), p.z()};
                         }},
                        {"portal", [](const Positions&, const Vector3d& p) { return p; }}});
}

TEST(Kinematics, TableAndSpindleTiltingMatchesItsClosedForm) {
    const auto head = [](const Positions& q, const Vector3d& p) -> Vector3d {
        return {std::cos(q[3]) * p.x() + std::sin(q[3]) * p.z(), p.y() + q[1],
                -std::sin(q[3]) * p.x() + std::cos(q[3]) * p.z() + q[2]};
    };
    const auto plate = [](const Positions& q, const Vector3d& p) -> Vector3d {
        return AngleAxisd(-q[4], Vector3d::UnitZ()) * p + Vector3d(-q[0], 0, 0);
    };
    expect_closed_form("table-spindle-tilting.yaml",
                       {{"cutter", head},
                        {"head", head},
                        {"plate", plate},
                        {"slide",
                         [](const Positions& q, const Vector3d& p) -> Vector3d {
                             return {p.x(), p.y() + q[1], p.z() + q[2]};
                         }},
                        {"bed", [](const Positions&, const Vector3d& p) { return p; }}});
}

TEST(Kinematics, RelativePoseTakesOneBodyIntoTheOthersFrame) {
    Pose a, b;
    a.t[0] = 3;
    b = joint_motion({.name = "C", .kind = AxisKind::rotary}, {.axis = 0, .direction = {0, 0, 1}},
                     std::acos(0.0));
    const Vec3d p = apply(relative_pose(a, b), {1, 0, 0});  // at (4, 0, 0) in the machine
    EXPECT_NEAR(p.x, 0, 1e-15);
    EXPECT_NEAR(p.y, -4, 1e-15);
}

}  // namespace
