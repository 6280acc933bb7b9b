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

}  // namespace
}  // namespace axg
