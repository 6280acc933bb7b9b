// SPDX-License-Identifier: Apache-2.0
// axguardd admit and run on an interface that is not there: the verdict is written down, says so,
// and nobody is let in; what may be waived, and what not.
// ctest-labels: long
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "firmware_if/axguardd/run_command.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

namespace fs = std::filesystem;

class Admit : public testing::Test {
  protected:
    int admit(const std::vector<std::string>& more, const std::string& state_dir = ".") {
        std::vector<std::string> words{"admit",
                                       test::kPaperMachine,
                                       "--bus",
                                       "nocan9",
                                       "--state-dir",
                                       shop.file(state_dir),
                                       "--seconds",
                                       "0.05",
                                       "--engine",
                                       "cpu",
                                       "--priority",
                                       "0",
                                       "--json=" + shop.file("said.json")};
        words.insert(words.end(), more.begin(), more.end());
        return run_axguardd(words);
    }
    static test::Json read(const std::string& path) {
        return test::Json::parse(test::content_of(path));
    }
    [[nodiscard]] std::string verdict_path() const { return shop.file("nocan9.admission.json"); }
    static test::Json check(const test::Json& verdict, const std::string& name) {
        for (const auto& one : verdict["checks"]) {
            if (one["check"] == name) {
                return one;
            }
        }
        return {};
    }

    test::Workshop shop;
};

TEST_F(Admit, TheVerdictIsStoredWithWhoseItIs) {
    EXPECT_EQ(admit({}), kExitUnfit);
    const test::Json verdict = read(verdict_path());
    EXPECT_EQ(verdict, read(shop.file("said.json")));
    EXPECT_FALSE(verdict["fit"].get<bool>());
    EXPECT_FALSE(verdict["admitted"].get<bool>());
    EXPECT_EQ(check(verdict, "system")["found"], "nocan9: no such interface");
    EXPECT_TRUE(check(verdict, "known_answer")["passed"].get<bool>());
    EXPECT_EQ(verdict["checks"].size(), 6U);
    EXPECT_EQ(verdict["machine"], "paper-trunnion");
    EXPECT_EQ(verdict["configuration_sha256"].get<std::string>().size(), 64U);
    EXPECT_EQ(verdict["bus"], "nocan9");
    for (const char* const key : {"version", "host", "kernel", "date", "verdict"}) {
        EXPECT_NE(verdict[key], "") << key;
    }
    const test::Json& cycles = verdict["figures"]["cycles"];
    EXPECT_EQ(cycles["count"], 128);
    EXPECT_GT(cycles["proven_count"], 10) << "of the positions of this machine many are clear";
    EXPECT_LT(cycles["proven_count"], 120) << "and many are not: those take the whole budget";
    EXPECT_GT(cycles["queries_max"], 400) << "of 512: no cycle would be much longer";
    EXPECT_GE(cycles["longest_us"], cycles["proven_us"]);
    EXPECT_GT(cycles["fill_us"], 0) << "the CPU's longest cycle is constructed";
    EXPECT_NE(cycles["plan"].get<std::string>().find(" node pairs"), std::string::npos);
    EXPECT_EQ(verdict["figures"]["wake_ups"]["count"], 50);
}

TEST_F(Admit, InContactModeTheSampledPosesAreQueried) {
    EXPECT_EQ(admit({"--mode", "contact"}), kExitUnfit);
    const test::Json cycles = read(verdict_path())["figures"]["cycles"];
    EXPECT_EQ(cycles["queries_max"], 0);
    EXPECT_GT(cycles["proven_count"], 10);
    EXPECT_GT(cycles["proven_us"], 0);
    EXPECT_EQ(cycles["plan"], "") << "no box is proven";
}

TEST_F(Admit, AnOldVerdictDoesNotOutliveAStart) {
    std::ofstream(verdict_path()) << "{\"fit\": true}";
    EXPECT_EQ(run_axguardd({"run", test::kPaperMachine, "--bus", "nocan9", "--state-dir",
                            shop.file("."), "--engine", "cpu"}),
              kExitCan)
        << "there is no such interface";
    EXPECT_FALSE(fs::exists(verdict_path()));
}

// As where the folder may be read and not written: what says "fit" there is of another start.
TEST_F(Admit, AnOldVerdictThatCannotBeRemovedEndsTheStart) {
    fs::create_directory(verdict_path());
    EXPECT_EQ(run_axguardd({"run", test::kPaperMachine, "--bus", "nocan9", "--state-dir",
                            shop.file("."), "--engine", "cpu"}),
              kExitInput);
    EXPECT_FALSE(fs::exists(shop.file("nocan9.latch"))) << "it went on";
    EXPECT_EQ(admit({}), kExitInput);
}

TEST_F(Admit, ABusIsTheNameOfAnInterface) {
    for (const char* const name : {"../nocan9", "a/b", "", "..", "sixteen-letters-", "can 0"}) {
        EXPECT_EQ(run_axguardd({"run", test::kPaperMachine, "--bus", name, "--state-dir",
                                shop.file("."), "--engine", "cpu"}),
                  kExitUsage)
            << name;
    }
    EXPECT_EQ(run_axguardd({"run", test::kPaperMachine, "--bus", "fifteen-letters", "--state-dir",
                            shop.file("."), "--engine", "cpu"}),
              kExitCan)
        << "a name that an interface could have";
}

TEST_F(Admit, AFolderThatCannotBeWrittenToIsNoVerdict) {
    EXPECT_EQ(admit({}, "missing"), kExitInput);
}

TEST_F(Admit, AWrongResultIsWaivedByNobody) {
    const std::vector<std::string> run{"run", test::kPaperMachine, "--bus", "nocan9",
                                       "--admit-unfit"};
    for (const char* const name : {"known_answer", "everything", ""}) {
        std::vector<std::string> words = run;
        words.emplace_back(name);
        EXPECT_EQ(run_axguardd(words), kExitUsage) << name;
    }
}

}  // namespace
}  // namespace axg
