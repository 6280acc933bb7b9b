// SPDX-License-Identifier: Apache-2.0
// axguard verify on the shipped machines and programs. Runs axguard itself.
// ctest-labels: long
#include <gtest/gtest.h>

#include <string>
#include <utility>

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

// Heads that tilt: with the tip held, and into the table.
TEST(VerifyCommand, ASpindleThatTiltsIsProvenAndStopped) {
    Workshop shop;
    const std::string begin = "T1 M6\nG21 G90 G94\nG43 H1\n";
    (void)shop.write("tip.ngc", begin +
                                    "G0 X20 Z40\nM428\nG1 B-10 C30 F3000\nG1 X-20 Z30\n"
                                    "G1 B20 C-30\nM429\nM2\n");
    (void)shop.write("down.ngc", begin + "G0 Z60\nG0 B40 C30\nG0 Z-250\nM2\n");
    for (const auto& [name, offset] : {std::pair{"spindle-tilting", "G54 Z-200"},
                                       std::pair{"table-spindle-tilting", "G54 Z-150"}}) {
        const std::string options = " --json --work-offset \"" + std::string(offset) + '"';
        const std::string verify =
            "verify " + source_file("config/machines/" + std::string(name) + ".yaml") + ' ';
        EXPECT_EQ(shop.run(verify + "tip.ngc --override 30..150" + options), kExitClean)
            << name << shop.out << shop.err;
        EXPECT_EQ(Json::parse(shop.out).at("programs").at(0).at("runs").size(), 3U) << name;
    }
    const std::string verify =
        "verify " + source_file("config/machines/table-spindle-tilting.yaml") + ' ';
    EXPECT_EQ(shop.run(verify + "down.ngc --json --work-offset \"G54 Z-150\""), kExitCollision);
    const Json run = Json::parse(shop.out).at("programs").at(0).at("runs").at(0);
    EXPECT_EQ(run.at("stops").at(0).at("line"), 6) << run;
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

/// 150 % of a feed that the simulation cuts was called clear at 150 %.
TEST(VerifyCommand, AFeedThatIsCutIsSaid) {
    Workshop shop;
    (void)shop.write("fast.ngc", "G21 G94 G90\nG1 X20 F9000\nM2\n");
    const std::string verify = "verify " + kPaperMachine + " fast.ngc --override ";
    (void)shop.run(verify + "111 --json");
    EXPECT_FALSE(Json::parse(shop.out).contains("feeds_cut_at_mm_min")) << shop.out;
    (void)shop.run(verify + "150 --json");
    EXPECT_EQ(Json::parse(shop.out).at("feeds_cut_at_mm_min"), 10000) << shop.out;
    EXPECT_NE(shop.err.find("feeds above 10000 mm/min ran at that speed, not higher"),
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
