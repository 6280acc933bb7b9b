// SPDX-License-Identifier: Apache-2.0
// axguard verify on the shipped machines and programs. Runs axguard itself.
// ctest-labels: long
#include <gtest/gtest.h>

#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"
#include "tests/support/screen.hpp"

namespace axg::test {
namespace {

TEST(VerifyCommand, AProgramThatCollidesEndsWithItsContact) {
    Workshop shop;
    EXPECT_EQ(
        shop.run("verify " + kPaperMachine + " " + kDemoProgram + " --report page.html --json"),
        kExitCollision)
        << shop.err;
    EXPECT_LE(lines_of(shop.err).size(), kScreenLines) << shop.err;
    EXPECT_LT(shop.err.find("CONTACT"), shop.err.find("STOP")) << shop.err;
    EXPECT_NE(shop.err.find("read as"), std::string::npos) << shop.err;
    EXPECT_NE(content_of(shop.file("page.html")).find("<html"), std::string::npos);
    const Json run = Json::parse(shop.out).at("programs").at(0).at("runs").at(0);
    EXPECT_EQ(run.at("exit_code"), 10);
    EXPECT_EQ(run.at("contacts").at(0).at("pair"), "cutter-c");
    EXPECT_EQ(run.at("nearest").at(0).at("clearance_mm"), 0);
    // The guard withdraws the permit before the contact.
    EXPECT_LT(run.at("stops").at(0).at("time_s").get<double>(),
              run.at("contacts").at(0).at("time_s").get<double>());
}

TEST(VerifyCommand, AVerdictIsThatOfSimulateAndReplay) {
    Workshop shop;
    for (const std::string& program : {kCleanProgram, kDemoProgram}) {
        ASSERT_EQ(
            shop.run("simulate " + kPaperMachine + " " + program + " --rapid-cap off -o t.log"),
            kExitClean)
            << shop.err;
        const int replayed = shop.run("replay " + kPaperMachine + " t.log --keep-going --json");
        const Json replay = Json::parse(shop.out);
        EXPECT_EQ(shop.run("verify " + kPaperMachine + " " + program + " --json"), replayed);
        const Json run = Json::parse(shop.out).at("programs").at(0).at("runs").at(0);
        EXPECT_EQ(run.at("samples"), replay.at("samples"));
        EXPECT_EQ(run.at("permits"), replay.at("permits"));
        EXPECT_EQ(run.at("stop_count"), replay.at("stop_count"));
    }
}

TEST(VerifyCommand, AnOverrideChangesFeedsAndNotRapids) {
    Workshop shop;
    (void)shop.write("feed.ngc", "G21 G94 G90\nG1 X20 F600\nM2\n");
    (void)shop.write("rapid.ngc", "G21 G90\nG0 X20\nM2\n");
    (void)shop.run("verify " + kPaperMachine + " feed.ngc rapid.ngc --override 50..100 --json");
    const Json programs = Json::parse(shop.out).at("programs");
    const auto seconds = [&](std::size_t program, std::size_t run) {
        return programs.at(program).at("runs").at(run).at("program_s").get<double>();
    };
    EXPECT_NEAR(seconds(0, 0) - seconds(0, 1), 2, 0.1) << "20 mm at 300 and at 600 mm/min";
    EXPECT_EQ(seconds(1, 0), seconds(1, 1));
    EXPECT_NE(shop.err.find("at 50 and 100 % of the feeds (not proven between them)"),
              std::string::npos)
        << shop.err;
}

TEST(VerifyCommand, SeveralProgramsMakeATableAndTheLargestCode) {
    Workshop shop;
    (void)shop.write("bad.ngc", "G0 X9999\nM2\n");
    (void)shop.write("short.ngc", "G21 G90\nG0 X1\nM2\n");
    EXPECT_EQ(shop.run("verify " + kPaperMachine + " short.ngc bad.ngc"), kExitInput) << shop.err;
    EXPECT_NE(shop.out.find("short.ngc "), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("NOT VERIFIED"), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("1 of 2 programs clear at 100 % of the feeds"), std::string::npos)
        << shop.out;
}

TEST(VerifyCommand, WrongWordsAreRefusedBeforeTheWork) {
    Workshop shop;
    (void)shop.write("p.ngc", "G21\nM2\n");
    const std::string verify = "verify " + kPaperMachine + " p.ngc ";
    EXPECT_EQ(shop.run(verify + "--override 20..150"), kExitUsage);
    EXPECT_NE(shop.err.find("--override: invalid value (found \"20..150\""), std::string::npos)
        << shop.err;
    EXPECT_EQ(shop.run(verify + "p.ngc --report r.html"), kExitUsage);
    EXPECT_EQ(shop.run(verify + "--report p.ngc"), kExitUsage) << "it would destroy the program";
    EXPECT_EQ(shop.run("verify p.ngc " + kPaperMachine), kExitUsage);
    EXPECT_EQ(content_of(shop.file("p.ngc")), "G21\nM2\n");
}

}  // namespace
}  // namespace axg::test
