// SPDX-License-Identifier: Apache-2.0
// The command as people and scripts meet it: exit codes, messages, files, JSON. Runs the program
// itself.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hil_replay/commands.hpp"

namespace axg {
namespace {

const std::string kMachine = std::string(AXG_SOURCE_DIR) + "/config/machines/paper-trunnion.yaml";
const std::string kPrograms = std::string(AXG_SOURCE_DIR) + "/hil_replay/programs/";

class SimulateCommand : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
        std::filesystem::remove_all(folder);
        std::filesystem::create_directories(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    /// Exit code; both outputs are kept.
    int run(const std::string& arguments) {
        const std::string line = std::string(AXG_PROGRAM) + " simulate " + arguments + " >" +
                                 folder + "/out 2>" + folder + "/err";
        const int status = std::system(line.c_str());
        out = content_of(folder + "/out");
        err = content_of(folder + "/err");
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    static std::string content_of(const std::string& path) {
        std::ifstream file(path, std::ios::binary);
        std::stringstream text;
        text << file.rdbuf();
        return text.str();
    }

    std::string write(const std::string& text) {
        const std::string path = folder + "/part.ngc";
        std::ofstream(path) << text;
        return path;
    }

    const std::string folder = testing::TempDir() + "axg_simulate_" + std::to_string(::getpid());
    const std::string trace = folder + "/trace.log";
    std::string out, err;
};

TEST_F(SimulateCommand, WritesTheTraceAndSaysHowHardTheAxesWork) {
    ASSERT_EQ(run(kMachine + " " + write("G0 X10\nM2\n") + " -o " + trace), kExitClean) << err;
    EXPECT_TRUE(std::filesystem::exists(trace));
    EXPECT_NE(out.find("s of program"), std::string::npos) << out;
    EXPECT_EQ(err, "");
    // No temporary file is left beside it.
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        files += entry.path().filename().string().find("trace") != std::string::npos ? 1 : 0;
    }
    EXPECT_EQ(files, 1U);
}

TEST_F(SimulateCommand, AFaultyProgramIsExit3WithAllFaultsAndNoTrace) {
    const std::string part = write("G87\nG0 X1\n#1=\nX9999\n");
    EXPECT_EQ(run(kMachine + " " + part + " -o " + trace), kExitInput);
    EXPECT_NE(err.find(part + ":1: G87: not supported"), std::string::npos) << err;
    EXPECT_NE(err.find(part + ":3: #: wanted a number"), std::string::npos) << err;
    EXPECT_NE(err.find(part + ":4: X: out of travel: goes to 9999 mm"), std::string::npos) << err;
    EXPECT_FALSE(std::filesystem::exists(trace));
    EXPECT_EQ(run(kMachine + " " + part + " -o " + trace + " --max-errors 1"), kExitInput);
    EXPECT_NE(err.find("reading stopped after 1 fault"), std::string::npos) << err;
}

TEST_F(SimulateCommand, WhatIsIgnoredIsEchoedInWordsAndJson) {
    const std::string part = write("M428 (tcp)\nG0 X1\nM2\n");
    ASSERT_EQ(run(kMachine + " " + part + " -o " + trace + " --ignore m428,M429 --json"),
              kExitClean)
        << err;
    EXPECT_NE(err.find(part + ":1: M428: ignored, as asked: M428 (tcp)"), std::string::npos);
    EXPECT_NE(err.find("joint positions"), std::string::npos);
    const auto document = nlohmann::json::parse(out);
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
    EXPECT_EQ(run(kMachine + " " + folder + "/none.ngc -o " + trace), kExitInput);
    EXPECT_EQ(run(folder + "/none.yaml " + part + " -o " + trace), kExitInput);
    EXPECT_EQ(run(kMachine + " " + part + " -o " + folder + "/no/such/folder.log"), kExitInput);
    EXPECT_FALSE(std::filesystem::exists(trace));
    EXPECT_EQ(run(base + "--start 'X5 C 720' --work-offset 'G54 X1' --work-offset 'G55 Y1' "
                         "--tool 7=1 --tool 8=1 --sample-us 100 --fd --axis-by-axis"),
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
