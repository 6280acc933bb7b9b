// SPDX-License-Identifier: Apache-2.0
// What axguard verify prints about its programs, and the words of --override.
#include "hil_replay/commands/verify_report.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware_if/cli/exit_codes.hpp"
#include "hil_replay/page/run_page.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/screen.hpp"

namespace axg::test {
namespace {

VerifyEvent event(const std::string& what, std::uint16_t tool, double clearance_mm) {
    return {.what = what,
            .time_s = 1.5,
            .line = 12,
            .block = "G1 X10 Y20 Z30 A40 C50 (a comment that goes on and on) F1000",
            .tool = tool,
            .clearance_mm = clearance_mm};
}

/// More of everything than a screen has lines for.
VerifiedProgram crowded_program(const std::string& file) {
    VerifiedProgram program{.file = file, .read_as = "read as: starts in mm", .exit_code = 10};
    for (const int percent : {30, 100, 150}) {
        VerifyRun run{.override_percent = percent, .exit_code = kExitCollision};
        for (std::uint16_t i = 0; i < 40; ++i) {
            run.contacts.push_back(event("cutter-c", i, 0));
            run.stops.push_back(event("predicted, cutter-c", i, 0));
            run.nearest.push_back(event("cutter-c", i, percent + i));
        }
        run.stop_count = 40;
        program.runs.push_back(run);
    }
    return program;
}

VerifyReport report_of(std::vector<VerifiedProgram> programs) {
    return {.machine = "mill",
            .version = "1.0",
            .overrides = {30, 100, 150},
            .not_obeyed = "",
            .programs = std::move(programs)};
}

TEST(VerifyOverrides, AreOneValueOrBothEndsAndHundredBetween) {
    EXPECT_EQ(read_overrides("100"), std::vector({100}));
    EXPECT_EQ(read_overrides("30"), std::vector({30}));
    EXPECT_EQ(read_overrides("150"), std::vector({150}));
    EXPECT_EQ(read_overrides("30..150"), std::vector({30, 100, 150}));
    EXPECT_EQ(read_overrides("30..100"), std::vector({30, 100}));
    EXPECT_EQ(read_overrides("110..150"), std::vector({110, 150}));
    EXPECT_EQ(read_overrides("80..80"), std::vector({80}));
    for (const char* const word : {"29", "151", "", "x", "100%", "150..30", "30..", "..150",
                                   "30-150", "30..151", "1e2", "30..100..150"}) {
        EXPECT_TRUE(read_overrides(word).empty()) << word;
    }
}

TEST(VerifyReport, OneProgramFitsOnAScreenWithContactsFirst) {
    const VerifyReport report = report_of({crowded_program("part.ngc")});
    const std::string text = printed_text(
        [&](std::FILE* words) { print_program(report, report.programs.front(), words); });
    const std::vector<std::string> lines = lines_of(text);
    EXPECT_LE(lines.size(), kScreenLines) << text;
    EXPECT_LE(widest(lines), kScreenColumns) << text;
    EXPECT_LT(text.find("CONTACT"), text.find("STOP"));
    EXPECT_LT(text.find("STOP"), text.find("nearest"));
    EXPECT_NE(text.find("nearest tool 0: 30.000 mm, cutter-c, at 30 %"), std::string::npos) << text;
    EXPECT_NE(text.find("and 115 more"), std::string::npos) << text;
    EXPECT_NE(text.find("0 of 1 programs clear at 30, 100 and 150 % of the feeds (not proven "
                        "between them); G0 at axis speed"),
              std::string::npos)
        << text;
}

TEST(VerifyReport, ARowHasTheEndOfALongNameAndTheLineOfTheFirstContact) {
    VerifiedProgram program =
        crowded_program("/a/very/long/folder/of/programs/of/a/shop/part-17.ngc");
    program.runs.resize(1);
    const std::string text =
        printed_text([&](std::FILE* words) { print_table_row(program, words); });
    EXPECT_LE(widest(lines_of(text)), kScreenColumns) << text;
    EXPECT_NE(text.find("shop/part-17.ngc"), std::string::npos) << text;
    EXPECT_NE(text.find("CONTACT"), std::string::npos) << text;
    EXPECT_NE(text.find("line 12"), std::string::npos) << text;
}

TEST(VerifyReport, TheLargestCodeIsTheCodeOfAll) {
    VerifiedProgram unread{.file = "unread.ngc", .exit_code = kExitInput};
    VerifiedProgram clear{.file = "clear.ngc"};
    EXPECT_EQ(report_of({clear}).exit_code(), kExitClean);
    EXPECT_EQ(report_of({clear, unread}).exit_code(), kExitInput);
    EXPECT_EQ(report_of({crowded_program("p.ngc"), unread}).exit_code(), kExitCollision);
}

TEST(VerifyReport, TheDocumentHasEveryRun) {
    VerifiedProgram program = crowded_program("part.ngc");
    program.runs.front().nearest.front().clearance_mm = HUGE_VAL;
    const Json document = Json::parse(describe_verify(report_of({program})));
    EXPECT_EQ(document.at("command"), "verify");
    EXPECT_EQ(document.at("version"), "1.0");
    EXPECT_EQ(document.at("exit_code"), 10);
    const Json& run = document.at("programs").at(0).at("runs").at(0);
    EXPECT_EQ(run.at("override"), 30);
    EXPECT_EQ(run.at("contacts").at(0).at("line"), 12);
    EXPECT_TRUE(run.at("nearest").at(0).at("clearance_mm").is_null());
    EXPECT_EQ(run.at("nearest").at(1).at("clearance_mm"), 31);
}

}  // namespace
}  // namespace axg::test
