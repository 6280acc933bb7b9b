// SPDX-License-Identifier: Apache-2.0
// Words of a command line that mean nothing, and what the program answers. Runs the programs
// themselves.
#include <gtest/gtest.h>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

TEST(OptionValues, NanAndNegativeCountsAreRefused) {
    Workshop shop;
    (void)shop.write("p.ngc", "G0 X1\nM2\n");
    ASSERT_EQ(shop.run("simulate " + kPaperMachine + " p.ngc -o t.log"), kExitClean) << shop.err;
    const std::string replay = "replay " + kPaperMachine + " t.log ";
    for (const char* const options :
         {"--arm-at nan", "--arm-at -nan", "--csv a.csv --within nan", "--arm-at inf"}) {
        EXPECT_EQ(shop.run(replay + options), kExitUsage) << options;
    }
    const std::string drive = "drive " + kPaperMachine + " p.ngc ";
    for (const char* const options : {"--seed -1", "--seed=-1", "--seed x"}) {
        EXPECT_EQ(shop.run(drive + options), kExitUsage) << options;
    }
    EXPECT_EQ(shop.run("check " + kPaperMachine + " --sms -1"), kExitUsage);
    EXPECT_EQ(shop.run("simulate " + kPaperMachine + " p.ngc -o a.log --blend-mm nan"), kExitUsage);
    EXPECT_EQ(shop.run("simulate " + kPaperMachine + " p.ngc -o a.log --max-moves -1"), kExitUsage);
    EXPECT_EQ(shop.run(drive + "--seed 7"), kExitClean) << shop.err;
    EXPECT_EQ(shop.run(replay + "--arm-at 0"), kExitClean) << shop.err;
}

TEST(OptionValues, AFaultGivenTwiceIsRefused) {
    Workshop shop;
    (void)shop.write("p.ngc", "G0 X1\nM2\n");
    const std::string drive = "drive " + kPaperMachine + " p.ngc --faults ";
    EXPECT_EQ(shop.run(drive + "killed=1,killed=2"), kExitUsage);
    EXPECT_NE(shop.err.find("--faults: killed: given twice."), std::string::npos) << shop.err;
    EXPECT_EQ(shop.run(drive + "lost=0,late=0"), kExitClean) << shop.err;
}

TEST(CommandWords, HelpNamesACommandAndVHasTheVersion) {
    Workshop shop;
    EXPECT_EQ(shop.run("replay --help"), kExitClean);
    const std::string help = shop.out;
    EXPECT_EQ(shop.run("help replay"), kExitClean);
    EXPECT_EQ(shop.out, help);
    EXPECT_EQ(shop.run("help"), kExitClean);
    EXPECT_NE(shop.out.find("axguard help COMMAND"), std::string::npos) << shop.out;
    EXPECT_EQ(shop.run("help replya"), kExitUsage);
    EXPECT_NE(shop.err.find("Did you mean replay?"), std::string::npos) << shop.err;
    EXPECT_EQ(shop.run("--version"), kExitClean);
    const std::string version = shop.out;
    EXPECT_EQ(shop.run("-V"), kExitClean);
    EXPECT_EQ(shop.out, version);
}

TEST(CommandWords, AnUnknownOptionIsAnsweredWithTheNearest) {
    Workshop shop;
    EXPECT_EQ(shop.run("simulate m.yaml p.ngc --outptu=t.log"), kExitUsage);
    EXPECT_NE(shop.err.find("--outptu: unknown option. Did you mean --output?"), std::string::npos)
        << shop.err;
    EXPECT_NE(shop.err.find("axguard help simulate"), std::string::npos) << shop.err;
    EXPECT_EQ(shop.run("replay m.yaml t.log --xylophone"), kExitUsage);
    EXPECT_NE(shop.err.find("--xylophone: unknown option.\n"), std::string::npos) << shop.err;
    EXPECT_EQ(shop.run_program(AXG_BINARY_DIR "/axguardd", "rnu m.yaml"), kExitUsage);
    EXPECT_NE(shop.err.find("Did you mean run?"), std::string::npos) << shop.err;
}

TEST(CommandWords, SwappedFilesAreNamed) {
    Workshop shop;
    (void)shop.write("p.NGC", "G0 X1\nM2\n");
    EXPECT_EQ(shop.run("simulate p.NGC " + kPaperMachine + " -o t.log"), kExitUsage);
    EXPECT_NE(shop.err.find("MACHINE: p.NGC: is a G-code program by its name."), std::string::npos)
        << shop.err;
    EXPECT_NE(shop.err.find("is the machine file: swap the two."), std::string::npos) << shop.err;
    EXPECT_EQ(shop.run("replay t.log p.NGC"), kExitUsage);
    EXPECT_NE(shop.err.find("MACHINE: t.log: is a trace by its name. The machine file comes first"),
              std::string::npos)
        << shop.err;
    EXPECT_EQ(shop.run("replay m.yaml m.axg"), kExitUsage);
    EXPECT_NE(shop.err.find("TRACE: m.axg: is a machine file by its name."), std::string::npos)
        << shop.err;
}

TEST(CommandWords, AFaultIsADocumentToo) {
    Workshop shop;
    EXPECT_EQ(shop.run("check no.yaml --json"), kExitInput);
    const Json fault = Json::parse(shop.out);
    EXPECT_EQ(fault.at("program"), "axguard");
    EXPECT_EQ(fault.at("command"), "check");
    EXPECT_NE(fault.at("version"), "");
    EXPECT_EQ(fault.at("exit_code"), 3);
    EXPECT_EQ(shop.run("check no.yaml --json --xylophone"), kExitUsage);
    EXPECT_NE(Json::parse(shop.out).at("fault").get<std::string>().find("--xylophone: unknown"),
              std::string::npos);
    // Only an older document is replaced: the command may not know yet that it reads the file.
    (void)shop.write("old.json", "{\"exit_code\": 0}\n");
    EXPECT_EQ(shop.run("check no.yaml --json=old.json"), kExitInput);
    EXPECT_EQ(Json::parse_file(shop.file("old.json")).at("exit_code"), 3);
    (void)shop.write("body.stl", "solid\n");
    EXPECT_EQ(shop.run("check no.yaml --json=body.stl"), kExitInput);
    EXPECT_EQ(content_of(shop.file("body.stl")), "solid\n");
}

TEST(CommandWords, AnInterruptedDriveStatesHowFarItCame) {
    Workshop shop;
    (void)shop.write("p.ngc", "G21\nG4 P4000\nM2\n");
    const std::string drive = "-s INT 3 '" AXG_PROGRAM "' drive " + kPaperMachine + " p.ngc";
    EXPECT_EQ(shop.run_program("timeout", drive), 124) << shop.err;
    EXPECT_NE(shop.err.find("interrupted: no stop until "), std::string::npos) << shop.err;
}

}  // namespace
}  // namespace axg::test
