// SPDX-License-Identifier: Apache-2.0
// Axes from the names of files, as people name them.
#include "config/init/guess_roles.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace axg {
namespace {

/// The axis of each file's part, T of the tool; -: rides on another.
std::string roles_of(const std::vector<std::string>& files) {
    std::string out;
    const std::vector<RoleGuess> roles = guess_roles(files);
    for (std::uint32_t i = 0; i < files.size(); ++i) {
        for (const RoleGuess& role : roles) {
            if (role.file == i) {
                out += role.is_tool ? "T" : role.axis.empty() ? "-" : role.axis;
            }
        }
    }
    return out;
}

TEST(GuessRoles, AnAxisIsNamedInManyWays) {
    EXPECT_EQ(roles_of({"Base.stl", "Xaxis.stl", "Yaxis.stl", "Zaxis.stl", "Baxis.stl"}), "-XYZB");
    EXPECT_EQ(roles_of({"XAxis.stl", "axisY.stl", "Axis_Z.stl", "a-axis.stl", "CPlate.stl"}),
              "XYZAC");
    EXPECT_EQ(roles_of({"relaxis.stl", "x.stl"}), "-X") << "a longer word is no axis";
}

// All of one machine: the letter behind each name is no axis.
TEST(GuessRoles, AWordThatMostFilesShareNamesTheMachine) {
    EXPECT_EQ(roles_of({"frame_b.stl", "saddle_b.stl", "table_b.stl", "b_axis_b.stl",
                        "c_axis_b.stl", "headstock_b.stl"}),
              "-YXBCZ");
    EXPECT_EQ(roles_of({"mill-base.stl", "mill-x.stl", "mill-y.stl", "cutter.stl"}), "-XYT");
    EXPECT_EQ(roles_of({"left_x.stl", "right_x.stl", "top_x.stl", "bed.stl"}), "X---")
        << "the rest tells nothing apart";
    EXPECT_EQ(roles_of({"frame_b.stl", "table_b.stl", "y.stl", "z.stl"}), "B-YZ")
        << "half of them are no majority";
}

TEST(GuessRoles, GermanNamesPutThePartAtTheEnd) {
    EXPECT_EQ(roles_of({"Maschinenbett.stl", "Kreuztisch.stl", "Fr\xc3\xa4stisch.stl",
                        "Schwenkwippe.stl", "Drehtisch.stl", "Spindelkopf.stl"}),
              "-YXACZ");
    EXPECT_EQ(
        roles_of({"St\xc3\xa4nder.stl", "YSchlitten.stl", "X-Schlitten.stl", "Fr\xc3\xa4ser.stl"}),
        "-YXT")
        << "a letter is plainer";
    EXPECT_EQ(guess_roles({"St\xc3\xa4nder.stl", "x.stl"})[0].name, "Staender");
    EXPECT_EQ(roles_of({"kopfplatte.stl", "x.stl"}), "-X") << "a plate, not a head";
}

// Whole inside, the smallest of several, and never on the tool or on another guess.
TEST(GuessRoles, ABodyWithoutAKnownNameRidesOnWhatEnclosesIt) {
    const std::vector<std::string> files{"bed.stl", "head.stl", "lamp.stl", "motor.stl",
                                         "pump.stl"};
    const std::vector<Box> boxes{{{0, 0, 0}, {100, 100, 100}},
                                 {{10, 10, 50}, {30, 30, 90}},
                                 {{10, 10, 80}, {20, 20, 91}},
                                 {{10, 10, 60}, {20, 20, 90}},
                                 {{90, 90, 90}, {110, 110, 110}}};
    std::vector<RoleGuess> roles = guess_roles(files);
    ride_in_boxes(roles, boxes);
    const auto parent_of = [&roles](const std::string& name) {
        for (const RoleGuess& role : roles) {
            if (role.name == name) {
                return role.parent == kNoParent ? std::string("-") : roles[role.parent].name;
            }
        }
        return std::string("?");
    };
    EXPECT_EQ(parent_of("motor"), "head");
    EXPECT_EQ(parent_of("lamp"), "bed") << "1 mm above the head";
    EXPECT_EQ(parent_of("pump"), "-");
    EXPECT_EQ(parent_of("head"), "-");
}

}  // namespace
}  // namespace axg
