// SPDX-License-Identifier: Apache-2.0
// The command as people and scripts meet it: exit codes, messages, files, JSON. Runs the program
// itself.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

const std::string kMachine = test::kPaperMachine;
const std::string kPrograms = test::source_file("hil_replay/programs/");

class SimulateCommand : public testing::Test {
  protected:
    int run(const std::string& arguments) { return shop.run("simulate " + arguments); }
    std::string write(const std::string& text) { return shop.write("part.ngc", text); }

    test::Workshop shop;
    const std::string trace = shop.file("trace.log");
    const std::string &out = shop.out, &err = shop.err;
};

TEST_F(SimulateCommand, WritesTheTraceAndSaysHowHardTheAxesWork) {
    ASSERT_EQ(run(kMachine + " " + write("G0 X10\nM2\n") + " -o " + trace), kExitClean) << err;
    EXPECT_TRUE(std::filesystem::exists(trace));
    EXPECT_NE(out.find("s of program"), std::string::npos) << out;
    EXPECT_EQ(err, "");
    // The lines of the program lie beside it, and no temporary file.
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(shop.file(""))) {
        const std::string name = entry.path().filename().string();
        if (name.find("trace") != std::string::npos) {
            files.insert(name);
        }
    }
    EXPECT_EQ(files, (std::set<std::string>{"trace.log", "trace.log.lines"}));
}

TEST_F(SimulateCommand, AFaultyProgramIsExit3WithAllFaultsAndNoTrace) {
    const std::string part = write("G87\nG0 X1\n#1=\nX9999\n");
    EXPECT_EQ(run(kMachine + " " + part + " -o " + trace), kExitInput);
    EXPECT_NE(err.find(part + ":1: G87: not supported"), std::string::npos) << err;
    EXPECT_NE(err.find(part + ":3: #: expected a number"), std::string::npos) << err;
    EXPECT_NE(err.find(part + ":4: X: out of travel: goes to 9999 mm"), std::string::npos) << err;
    EXPECT_FALSE(std::filesystem::exists(trace));
    EXPECT_EQ(run(kMachine + " " + part + " -o " + trace + " --max-errors 1"), kExitInput);
    EXPECT_NE(err.find("reading stopped after 1 fault"), std::string::npos) << err;
}

// The same program and machine but for the section: refused, or read as the section says.
TEST_F(SimulateCommand, TheMachineFileSaysWhatAProgramMeans) {
    const std::string paper = test::content_of(kMachine);
    const std::size_t at = paper.find("program: {");
    const auto machine_with = [&](const std::string& section) {
        const std::string rest = paper.substr(paper.find('\n', at) + 1);
        return shop.write("machine.yaml", paper.substr(0, at) + section + "\n" + rest);
    };
    const std::string part = write("G90\nG0 X1\nC-200\nG28 Z0\nM2\n");
    EXPECT_EQ(run(machine_with("") + " " + part + " -o " + trace), kExitInput);
    EXPECT_NE(err.find(part + ":2: X: no G20 or G21 before this length"), std::string::npos) << err;
    EXPECT_NE(err.find(part + ":3: C: the machine file has no program.rotary.C"), std::string::npos)
        << err;
    EXPECT_NE(err.find(part + ":4: G28: its stored position is unknown; state program.g28.Z"),
              std::string::npos)
        << err;
    const std::string inch = machine_with(
        "program: {start_unit: inch, rotary: {C: short}, g28: {Z: 40}, startup_code: G64}");
    ASSERT_EQ(run(inch + " " + part + " -o " + trace), kExitClean) << err;
    const std::string read_as = "read as: start-up code G64; starts in inch; C short; G28 Z40\n";
    EXPECT_NE(out.find(part + ": " + read_as), std::string::npos) << out;
    EXPECT_NE(test::content_of(trace + ".lines").find("\nread_as " + read_as), std::string::npos);
    EXPECT_EQ(run(machine_with("") + " " + part + " -o " + trace + " --rotary short"), kExitInput);
    EXPECT_EQ(err.find("program.rotary"), std::string::npos) << err;
    EXPECT_EQ(run(machine_with("program: {rotary: {A: short, Q: short}, g28: {B: 1}}") + " " +
                  part + " -o " + trace),
              kExitInput);
    EXPECT_NE(err.find("program.rotary.A: invalid value (found an axis with ends"),
              std::string::npos)
        << err;
    EXPECT_NE(err.find("program.rotary.Q: unknown key"), std::string::npos) << err;
}

TEST_F(SimulateCommand, AProofStatesWhatItIsOf) {
    const std::string part = write("G0 X10\nM2\n");
    ASSERT_EQ(run(kMachine + " " + part + " -o " + trace), kExitClean) << err;
    ASSERT_EQ(shop.run("replay " + kMachine + " " + trace + " --mode contact"), kExitClean) << err;
    EXPECT_NE(out.find("(proven)\n  of " + part + ", read as: starts in mm\n"), std::string::npos)
        << out;
    std::filesystem::remove(trace + ".lines");
    ASSERT_EQ(shop.run("replay " + kMachine + " " + trace + " --mode contact"), kExitClean) << err;
    EXPECT_NE(out.find("(proven)\n  of this trace, whatever program made it\n"), std::string::npos)
        << out;
}

TEST_F(SimulateCommand, WhatIsIgnoredIsEchoedInWordsAndJson) {
    const std::string part = write("M428 (tcp)\nG0 X1\nM2\n");
    ASSERT_EQ(run(kMachine + " " + part + " -o " + trace + " --ignore m428,M429 --json"),
              kExitClean)
        << err;
    EXPECT_NE(err.find(part + ":1: M428: ignored (--ignore): M428 (tcp)"), std::string::npos);
    EXPECT_NE(err.find("joint positions"), std::string::npos);
    const auto document = test::Json::parse(out);
    EXPECT_EQ(document["reading"]["ignored"][0]["line"], 1);
    EXPECT_EQ(document["reading"]["ignored"][0]["word"], "M428");
    EXPECT_GT(document["motion"]["samples"], 10);
    EXPECT_EQ(document["motion"]["axes"].size(), 5U);
}

TEST_F(SimulateCommand, BadOptionsAreExit2AndOutsidePositionsExit3) {
    const std::string part = write("G0 X1\nM2\n");
    const std::string base = kMachine + " " + part + " -o " + trace + " ";
    EXPECT_EQ(run(kMachine + " " + part), kExitUsage) << "no -o";
    EXPECT_EQ(run(base + "--sample-us 150"), kExitUsage);
    EXPECT_EQ(run(base + "--sample-us 50"), kExitUsage);
    EXPECT_EQ(run(base + "--tool 3"), kExitUsage);
    EXPECT_EQ(run(base + "--tool 1=99999"), kExitUsage);
    EXPECT_EQ(run(base + "--work-offset 'G60 X1'"), kExitUsage);
    EXPECT_EQ(run(base + "--work-offset 'G54 Q1'"), kExitUsage);
    EXPECT_EQ(run(base + "--start Q1"), kExitUsage);
    EXPECT_EQ(run(base + "--start X9999"), kExitInput);
    EXPECT_EQ(run(kMachine + " " + shop.file("none.ngc") + " -o " + trace), kExitInput);
    EXPECT_EQ(run(shop.file("none.yaml") + " " + part + " -o " + trace), kExitInput);
    EXPECT_EQ(run(shop.file("none.yaml") + " " + part + " -o " + trace), kExitInput);
    EXPECT_NE(err.find("none.yaml:1: invalid file (found No such file or directory, expected a "
                       "file that can be opened). Check the name."),
              std::string::npos)
        << err;
    EXPECT_EQ(err.find("repair"), std::string::npos) << err;
    EXPECT_EQ(run(kMachine + " " + part + " -o " + shop.file("no/such/folder.log")), kExitUsage)
        << "a result that cannot be written";
    EXPECT_TRUE(err.starts_with("--output: " + shop.file("no/such/folder.log: "))) << err;
    EXPECT_FALSE(std::filesystem::exists(trace));
    EXPECT_EQ(run(base + "--start 'X5 C 720' --work-offset 'G54 X1' --work-offset 'G55 Y1' "
                         "--tool 7=1 --tool 8=1 --sample-us 100 --fd --axis-by-axis"),
              kExitClean)
        << err;
}

// Found before a byte is written, and while it is written where the moves alone do not show it.
TEST_F(SimulateCommand, ProgramsThatRunAwayAreRefusedByTheirLine) {
    const std::string base = kMachine + " ";
    const auto expect_refused = [&](const std::string& program, const std::string& options,
                                    const std::string& message) {
        const std::string part = write(program);
        EXPECT_EQ(run(base + part + " -o " + trace + " " + options), kExitInput) << program;
        EXPECT_NE(err.find(part + message), std::string::npos) << program << err;
        EXPECT_FALSE(std::filesystem::exists(trace)) << program;
        EXPECT_EQ(shop.run("drive " + kMachine + " " + part + " " + options), kExitInput);
        EXPECT_NE(err.find(message.substr(message.rfind(": "))), std::string::npos) << err;
    };
    expect_refused("G0 X1\nG4 P86400\nM2\n", "",
                   ":2: program: takes more than 10000000 samples; check G4 and F, or raise the "
                   "limit with --max-samples N");
    expect_refused("G0 X1\nG1 X9 F0.001\nM2\n", "", ":2: program: takes more than 10000000");
    expect_refused("o1 while [1]\nM3\no1 endwhile\n", "--max-lines 5000",
                   ":3: program: more than 5000 lines were run");
    expect_refused("o1 repeat [1000000000]\nG4 P0\no1 endrepeat\n", "--max-moves 5000",
                   ":2: program: longer than 5000 moves");
    expect_refused("G0 X1\nG0 X0\nM2\n", "--max-samples 60", ":1: program: takes more than 60");
    EXPECT_EQ(run(base + write("G0 X1\nG0 X0\nM2\n") + " -o " + trace + " --max-samples 1000"),
              kExitClean)
        << err;
    EXPECT_EQ(run(base + write("o1 repeat [9]\nG4 P0\no1 endrepeat\nM2\n") + " -o " + trace +
                  " --max-moves 9"),
              kExitClean)
        << err;
}

TEST_F(SimulateCommand, TheExamplesRun) {
    for (const char* const name : {"paper-trunnion-demo", "paper-trunnion-clean"}) {
        EXPECT_EQ(run(kMachine + " " + kPrograms + name + ".ngc -o " + trace), kExitClean)
            << name << err;
    }
    EXPECT_EQ(run("--help"), kExitClean);
    EXPECT_EQ(out.substr(0, 8), "Example:");
}

}  // namespace
}  // namespace axg
