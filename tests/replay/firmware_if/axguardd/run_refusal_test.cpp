// SPDX-License-Identifier: Apache-2.0
// axguardd run refuses a machine file whose frames can never show that the axes stand, before it
// opens anything, and says what to add.
#include <gtest/gtest.h>

#include <filesystem>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/drive_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

TEST(AxguarddRun, RefusesDrivesThatDoNotAllReportTheirSpeed) {
    for (const bool has_speeds : {false, true}) {
        const test::Workshop shop;
        const std::string file = shop.write(
            "drives.yaml",
            test::paper_machine_with_drives(test::content_of(test::kPaperMachine), has_speeds));
        testing::internal::CaptureStderr();
        const int code = run_axguardd(
            {"run", file, "--mesh-root",
             std::filesystem::path(test::kPaperMachine).parent_path().string(), "--bus", "nocan9",
             "--state-dir", shop.file("."), "--engine", "cpu", "--priority", "0"});
        const std::string said = testing::internal::GetCapturedStderr();
        EXPECT_EQ(code, has_speeds ? kExitCan : kExitInput) << said;
        EXPECT_EQ(std::filesystem::exists(shop.file("nocan9.latch")), has_speeds);
        const std::string words =
            "axguardd: " + file +
            ": can.drives: no stop can be confirmed without the velocity of every axis (missing: "
            "X, Y, Z, A, C). Map object 0x606C and add the key velocity.";
        EXPECT_EQ(said.find(words) != std::string::npos, !has_speeds) << said;
    }
}

}  // namespace
}  // namespace axg
