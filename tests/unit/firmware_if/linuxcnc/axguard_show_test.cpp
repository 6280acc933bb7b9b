// SPDX-License-Identifier: Apache-2.0
// Options of axguard-hal for status, metrics and black box: each with its value, and how many dumps
// they come to.
#include "firmware_if/linuxcnc/axguard_show.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace axg {
namespace {

struct Taken {
    axg_show show{};
    int taken = 0;  // options
};

Taken taken_of(std::vector<std::string> words) {
    std::vector<char*> given;
    static std::vector<std::string> kept;  // the options point into it
    kept = std::move(words);
    for (std::string& word : kept) {
        given.push_back(word.data());
    }
    Taken out;
    for (int i = 0; i < static_cast<int>(given.size()); ++i) {
        out.taken += axg_show_take(&out.show, static_cast<int>(given.size()), given.data(), &i);
    }
    return out;
}

TEST(LinuxCncShow, EachOptionTakesItsValueAndNoOtherIsTaken) {
    const Taken all = taken_of({"--status-socket", "s", "--simulation", "--metrics", "m",
                                "--state-dir", ".", "--black-boxes", "3", "machine.yaml"});
    EXPECT_EQ(all.taken, 4);
    EXPECT_STREQ(all.show.status_socket, "s");
    EXPECT_STREQ(all.show.metrics, "m");
    EXPECT_STREQ(all.show.state_dir, ".");
    EXPECT_STREQ(all.show.black_boxes, "3");
    EXPECT_EQ(taken_of({"--status-socket"}).taken, 0) << "without its value";
}

/// Dumps to keep; -1: refused.
int dumps_of(std::vector<std::string> words) {
    const Taken one = taken_of(std::move(words));
    std::uint32_t dumps = 7;
    return axg_show_dumps(&one.show, &dumps) ? static_cast<int>(dumps) : -1;
}

TEST(LinuxCncShow, DumpsNeedAFolder) {
    EXPECT_EQ(dumps_of({"--status-socket", "s"}), 0);
    EXPECT_EQ(dumps_of({"--state-dir", "."}), 8) << "as axguardd";
    for (const auto& [number, count] :
         {std::pair{"0", 0}, {"1000", 1000}, {"1001", -1}, {"-1", -1}, {"", -1}, {"3x", -1}}) {
        EXPECT_EQ(dumps_of({"--state-dir", ".", "--black-boxes", number}), count) << number;
    }
    EXPECT_EQ(dumps_of({"--black-boxes", "3"}), -1) << "where?";
    EXPECT_EQ(dumps_of({"--black-boxes", "0"}), 0);
}

}  // namespace
}  // namespace axg
