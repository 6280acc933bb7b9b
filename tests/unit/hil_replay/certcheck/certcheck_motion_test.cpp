// SPDX-License-Identifier: Apache-2.0
// What joints can do within a box, against random positions in it; and how far an axis goes on,
// against stops that are integrated.
#include <gtest/gtest.h>

#include <random>

#include "hil_replay/certcheck/linkage.hpp"
#include "hil_replay/certcheck/stop_reach.hpp"

namespace axg::certcheck {
namespace {

Surface surface_of(const std::vector<Triangle>& triangles) {
    Surface surface{"", BoxTree(triangles)};
    for (const Triangle& triangle : triangles) {
        for (std::size_t i = 0; i < 9; i += 3) {
            const Vector corner{{triangle[i], triangle[i + 1], triangle[i + 2]}};
            surface.radius = std::max(surface.radius, length(corner).high);
        }
    }
    return surface;
}

/// Two chains of up to three joints of any kind from one body, and a triangle at each end.
Model any_machine(std::mt19937& random) {
    std::uniform_real_distribution<double> number(-1, 1);
    Model model{};
    model.bodies.push_back({"base", -1, -1, {}, {}, 0});
    for (int side = 0; side < 2; ++side) {
        int parent = 0;
        const int joints = std::uniform_int_distribution<int>(side, 3)(random);
        for (int i = 0; i < joints; ++i) {
            const bool is_rotary = number(random) > 0;
            const Vector along{{number(random), number(random), number(random)}};
            model.axes.push_back({"", is_rotary, is_rotary ? 0x1p-24 : 0x1p-16, 1, 1, 1, 1, 0, 1});
            const auto far = [&] { return 100 * number(random); };
            model.bodies.push_back({"",
                                    parent,
                                    static_cast<int>(model.axes.size()) - 1,
                                    (1 / length(along)) * along,
                                    {{far(), far(), far()}},
                                    1});
            parent = static_cast<int>(model.bodies.size()) - 1;
        }
        std::vector<Triangle> triangles(3);
        for (Triangle& triangle : triangles) {
            for (float& value : triangle) {
                value = static_cast<float>(60 * number(random) + 50 * side);
            }
        }
        model.surfaces.push_back(surface_of(triangles));
        if (side == 0) {
            model.tasks.push_back({});
        }
        model.tasks[0].body[side] = parent;
        model.tasks[0].surface[side] = static_cast<std::uint32_t>(side);
    }
    return model;
}

double distance(const Linkage& linkage, const std::array<Triangle, 2>& triangles) {
    std::array<Vector, 2> at;
    for (std::size_t side = 0; side < 2; ++side) {
        const Triangle& t = triangles[side];
        at[side] = placed(linkage.pose(side), {{t[0], t[1], t[2]}});
    }
    return length(at[0] - at[1]).low;
}

// Two points of the surfaces come nearer by at most the motion; some use most of it.
TEST(CertcheckMotion, NoPositionOfTheBoxComesNearer) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(-1, 1);
    double used = 0;
    for (int machine = 0; machine < 1500; ++machine) {
        const Model model = any_machine(random);
        Linkage linkage(model, model.tasks[0]);
        std::vector<double> centre, half, position(model.axes.size());
        for (const Axis& axis : model.axes) {
            centre.push_back(std::round((axis.is_rotary ? 3 : 50) * number(random) / axis.unit));
            half.push_back(
                std::round((axis.is_rotary ? 1 : 20) * std::pow(number(random), 2) / axis.unit));
        }
        const std::array triangles{model.surfaces[0].tree.triangles()[0],
                                   model.surfaces[1].tree.triangles()[0]};
        linkage.place(centre);
        const double motion = linkage.motion(half);
        const double before = distance(linkage, triangles);
        for (int i = 0; i < 60; ++i) {
            for (std::size_t axis = 0; axis < position.size(); ++axis) {
                const double part = i < 30 ? number(random) : (number(random) > 0 ? 1 : -1);
                position[axis] = centre[axis] + part * half[axis];
            }
            linkage.place(position);
            const double lost = before - distance(linkage, triangles);
            EXPECT_LE(lost, motion + 1e-9) << machine;
            used = motion > 1 ? std::max(used, lost / motion) : used;
        }
    }
    EXPECT_GT(used, 0.95);
}

TEST(CertcheckMotion, AJointThatBothBodiesHaveMovesNothing) {
    std::mt19937 random(2);
    Model model = any_machine(random);
    model.axes.push_back({"", true, 0x1p-24, 1, 1, 1, 1, 0, 1});
    model.bodies[0].axis = static_cast<int>(model.axes.size()) - 1;
    model.bodies[0].direction = {{0, 0, 1}};
    Linkage linkage(model, model.tasks[0]);
    std::vector<double> at(model.axes.size());
    std::vector<double> half(model.axes.size());
    half.back() = 0x1p24;
    linkage.place(at);
    EXPECT_LT(linkage.motion(half), 1e-9);
}

/// The way of a stop from speed x and acceleration b: jerk, then the stopping deceleration.
double way_of_stop(const Axis& axis, double x, double b) {
    constexpr double kStep = 1e-5;
    double way = 0, most = 0;
    for (double speed = x; speed > 0 || b > 0;) {
        way += speed * kStep;
        speed += b * kStep;
        b = std::max(b - axis.jerk * kStep, -axis.stopping);
        most = std::max(most, way);
    }
    return most;
}

TEST(CertcheckReach, NoStopGoesFurtherAndSomeUseIt) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(0, 1);
    for (const bool has_free_jerk : {false, true}) {
        double used = 0;
        for (int i = 0; i < 200; ++i) {
            Model model{};
            model.has_free_jerk = has_free_jerk;
            const Axis axis{"",
                            false,
                            0x1p-16,
                            20 + 200 * number(random),
                            500 + 2000 * number(random),
                            5000 + 50000 * number(random),
                            500 + 3000 * number(random),
                            0,
                            1};
            const int byte = std::uniform_int_distribution<int>(1, 255)(random);
            const double reach = static_cast<double>(stop_reach(model, axis, 0, byte)) * axis.unit;
            const double top = byte * axis.speed / 255;
            for (int k = 0; k < 20; ++k) {
                const double x = k < 2 ? top : top * number(random);
                // The speed stays within its limit while the acceleration falls by the jerk.
                const double limit = has_free_jerk ? top : axis.speed;
                const double most =
                    std::min(axis.acceleration, std::sqrt(2 * axis.jerk * (limit - x)));
                const double b = k % 2 == 0 ? most : most * number(random);
                const double way = way_of_stop(axis, x, b);
                EXPECT_LE(way, reach + 1e-2) << byte;
                used = std::max(used, way / reach);
            }
        }
        EXPECT_GT(used, 0.95);
    }
}

TEST(CertcheckReach, CountsTheErrorOfFollowing) {
    Model model{};
    const Axis axis{"", false, 0x1p-16, 100, 1000, 20000, 2000, 0, 1};
    EXPECT_EQ(stop_reach(model, axis, 0, 0), 0);
    EXPECT_GT(stop_reach(model, axis, 1, 0), 0);  // 2 sqrt(2 a f) of speed
    EXPECT_GT(stop_reach(model, axis, 655, 100), stop_reach(model, axis, 0, 100));
    model.turns_round = true;
    EXPECT_GT(stop_reach(model, axis, 0, 0), 0);
    for (int byte = 1; byte < 256; ++byte) {
        EXPECT_GE(stop_reach(model, axis, 65, byte), stop_reach(model, axis, 65, byte - 1));
    }
}

}  // namespace
}  // namespace axg::certcheck
