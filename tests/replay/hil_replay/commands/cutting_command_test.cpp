// SPDX-License-Identifier: Apache-2.0
// Work is let pass, and no more than that: a pocket is milled without a stop, by drive and by
// replay; a shank that would enter the blank, and flutes that would enter the vice, stop both.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

struct Work {
    const char* name;
    const char* depth_mm;  // of Z; the blank's top is at -205 with this tool
    const char* right_mm;  // of X; the jaw begins at 40, the flutes reach 6 farther
    int exit_code;
    const char* pair;  // that stops it
};

class Milled : public testing::TestWithParam<Work> {
  protected:
    void SetUp() override {
        (void)shop_.write("mill.yaml",
                          content_of(AXG_SOURCE_DIR "/config/machines/vice-mill.yaml"));
        const std::string right = GetParam().right_mm;
        (void)shop_.write("work.ngc", "G21 G90\nG0 X-20 Y-10\nG0 Z-200\nG1 Z" +
                                          std::string(GetParam().depth_mm) + " F900\nX" + right +
                                          "\nY10\nX-20\nY-10\nG0 Z-150\nM2\n");
    }
    void expect(const std::string& command) {
        EXPECT_EQ(shop_.run(command), GetParam().exit_code) << shop_.out << shop_.err;
        const std::string pair = GetParam().pair;
        if (!pair.empty()) {
            EXPECT_NE(shop_.out.find("  " + pair + " "), std::string::npos) << shop_.out;
        }
    }
    Workshop shop_;
};

TEST_P(Milled, StopsForWhatMayNotTouchAlone) {
    expect("drive mill.yaml work.ngc --details");
    ASSERT_EQ(shop_.run("simulate mill.yaml work.ngc -o work.log"), 0) << shop_.err;
    expect("replay mill.yaml work.log --details");
}

INSTANTIATE_TEST_SUITE_P(Works, Milled,
                         testing::Values(Work{"Pocket", "-210", "20", 0, ""},
                                         Work{"ShankInTheBlank", "-236", "20", 10, "cutter-blank"},
                                         Work{"FlutesInTheVice", "-228", "40", 10, "cutter-vice"}),
                         [](const auto& work) { return std::string(work.param.name); });

}  // namespace
}  // namespace axg::test
