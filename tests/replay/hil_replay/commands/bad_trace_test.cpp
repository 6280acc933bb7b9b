// SPDX-License-Identifier: Apache-2.0
// Traces with lines that are no frames: a report must not read as if the whole were judged. Runs
// the program itself.
#include <gtest/gtest.h>

#include <sstream>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

class BadTrace : public testing::Test {
  protected:
    void SetUp() override {
        (void)shop.write("p.ngc", "T1 M6\nG0 X20 Y5 Z40\nG1 A-10 C30 F3000\nM2\n");
        ASSERT_EQ(shop.run("simulate " + kPaperMachine + " p.ngc -o good.log"), kExitClean)
            << shop.err;
        good = content_of(shop.file("good.log"));
    }
    /// A trace with this behind its line `number`, counted from 1.
    [[nodiscard]] std::string with(std::size_t number, const std::string& text) const {
        std::size_t at = 0;
        for (std::size_t i = 0; i < number; ++i) {
            at = good.find('\n', at) + 1;
        }
        return shop.write("bad.log", good.substr(0, at) + text + good.substr(at));
    }
    int replay(const std::string& arguments) {
        const int code = shop.run("replay " + kPaperMachine + " " + arguments + " --json=j");
        const std::string text = content_of(shop.file("j"));
        document = Json::accept(text) ? Json::parse(text) : Json();
        return code;
    }

    Workshop shop;
    std::string good;
    Json document;
};

// Samples before the bad line are all proven; those behind it are not known.
TEST_F(BadTrace, IsNeverSummedUpAsProven) {
    for (const char* const mode : {"stoppable", "contact"}) {
        const std::string bad = with(400, "garbage\n");
        EXPECT_EQ(replay(bad + " --mode " + mode), kExitCan) << shop.err;
        EXPECT_EQ(shop.out.find("no stop"), std::string::npos) << shop.out;
        const std::string last = "\nTHE TRACE IS TRUNCATED: the rest is not proven\n  " + bad +
                                 ":401: time: invalid value (found \"garbage\"";
        EXPECT_NE(shop.out.find(last), std::string::npos) << shop.out;
        EXPECT_EQ(document["valid"], false);
        EXPECT_EQ(document["fault"].get<std::string>().find(bad + ":401: "), 0U);
    }
    EXPECT_EQ(replay("good.log"), kExitClean) << shop.err;
    EXPECT_NE(shop.out.find("no stop"), std::string::npos) << shop.out;
    EXPECT_EQ(document["valid"], true);
    EXPECT_EQ(document["lines_skipped"], 0);
    EXPECT_FALSE(document.contains("fault"));
}

TEST_F(BadTrace, LenientSaysHowManyLinesAndWhichFirst) {
    const std::string bad = with(400, "garbage\n" + std::string(70'000, 'x') + "\n   \nmore\n");
    EXPECT_EQ(replay(bad + " --lenient"), kExitClean) << shop.err << shop.out;
    EXPECT_NE(shop.out.find("\n3 lines skipped, the first: " + bad + ":401: "), std::string::npos)
        << shop.out;
    EXPECT_EQ(document["valid"], true);
    EXPECT_EQ(document["lines_skipped"], 3);
    EXPECT_EQ(document["first_skipped"].get<std::string>().find(bad + ":401: "), 0U);
    Json whole = document;
    EXPECT_EQ(replay("good.log"), kExitClean);
    EXPECT_EQ(whole["samples"], document["samples"]) << "nothing behind the long line is lost";
}

TEST_F(BadTrace, WithoutAFrameIsInvalidInJsonToo) {
    EXPECT_EQ(replay(shop.write("bad.log", "hello\n")), kExitCan);
    EXPECT_EQ(document["valid"], false);
    EXPECT_NE(document["fault"].get<std::string>().find("bad.log:1: invalid file (found \"hello\""),
              std::string::npos)
        << document["fault"].dump();
    EXPECT_EQ(replay("none.log"), kExitInput);
    EXPECT_EQ(document["valid"], false);
}

// Every SYNC twice, 90 us apart: the period is that of the counter, and the receiver judges.
TEST_F(BadTrace, DoubledSyncsDoNotChangeThePeriod) {
    std::istringstream lines(good);
    std::string line, text;
    while (std::getline(lines, line)) {
        text += line + "\n";
        if (line.find(" 080#") != std::string::npos) {
            std::string again = line;
            again.replace(again.find(')') - 3, 3, "090");
            text += again + "\n";
        }
    }
    (void)replay(shop.write("bad.log", text));
    EXPECT_EQ(shop.err.find("sample period"), std::string::npos) << shop.err;
}

}  // namespace
}  // namespace axg::test
