// SPDX-License-Identifier: Apache-2.0
// axguard inspect on traces worked out by hand, packed and not, and on one of a known program. Runs
// the program itself; real logs: tests/replay/firmware_if/receiver/can_data_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

class InspectCommand : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }

    /// Exit code; both outputs are kept, and the document of --json.
    int run(const std::string& arguments, const std::string& command = "inspect") {
        const int code = shop.run(command + " " + arguments + " --json");
        document = test::Json::accept(shop.out) ? test::Json::parse(shop.out) : test::Json();
        return code;
    }

    /// 100 frames every 10 ms, of which two are 3 ms early and late, then a pause of 90 ms.
    static std::string regular() {
        std::string text;
        for (int i = 0; i < 100; ++i) {
            const int us = 10'000 * i +
                           (i == 30   ? -3000
                            : i == 60 ? 3000
                                      : 0) +
                           (i > 80 ? 80'000 : 0);
            char line[64];
            std::snprintf(line, sizeof line, "(1.%06d) can0 123#%s\n", us % 1'000'000,
                          i % 2 == 0 ? "00" : "0011");
            text += us < 1'000'000 ? line : "";
        }
        return text;
    }

    test::Workshop shop;
    test::Json document;
};

TEST_F(InspectCommand, PeriodsJitterAndGapsAreThoseOfTheFrames) {
    ASSERT_EQ(run(shop.write("a.log", regular())), kExitClean) << shop.err;
    const auto& id = document["ids"][0];
    EXPECT_EQ(document["ids"].size(), 1U);
    EXPECT_EQ(id["id"], 0x123);
    EXPECT_EQ(id["frames"], 92);  // the last eight are beyond the second
    EXPECT_EQ(id["bytes_min"], 1);
    EXPECT_EQ(id["bytes_max"], 2);
    EXPECT_EQ(id["period_us_median"], 10'000);
    EXPECT_EQ(id["period_us_p1"], 7'000) << "two of 91: before sample 30, after sample 60";
    EXPECT_EQ(id["period_us_p99"], 90'000) << "of 91 no more than 99 % are below it";
    EXPECT_EQ(id["longest_us"], 90'000);
    EXPECT_EQ(id["longest_at_us"], 1'800'000);
    EXPECT_EQ(id["gaps"], 1);
    EXPECT_NEAR(id["per_second"].get<double>(), 91 / 0.99, 1e-9);
    EXPECT_NE(shop.err.find("the longest from 0.800000 s"), std::string::npos) << shop.err;
}

TEST_F(InspectCommand, KindsOfFramesAreToldApart) {
    const std::string trace = shop.write("b.log",
                                         "(1.000000) can0 123#00\n(1.000100) can0 00000123#00\n"
                                         "(1.000200) can0 123##1AABB\n(1.000300) can0 123#R\n"
                                         "(1.000400) can0 20000080#0000000000000000\n");
    ASSERT_EQ(run(trace), kExitClean) << shop.err;
    std::vector<std::string> names;
    for (const auto& id : document["ids"]) {
        names.push_back(id["name"].get<std::string>());
    }
    EXPECT_EQ(names,
              (std::vector<std::string>{"123", "123 fd", "123 remote", "00000123", "error"}));
    EXPECT_NE(shop.err.find("once, at 0.000400 s"), std::string::npos) << shop.err;
}

TEST_F(InspectCommand, AMachineFileDecodesTheAxes) {
    const std::string program =
        shop.write("p.ngc", "G1 F600 X10 Y-5\nG0 C300\nG4 P0.1\nG1 X-2 Z1 A-20\nM2\n");
    const std::string trace = shop.file("p.log");
    ASSERT_EQ(
        run(test::kPaperMachine + " " + program + " -o " + trace + " --sample-us 2000", "simulate"),
        kExitClean)
        << shop.err;
    ASSERT_EQ(run(trace + " --machine " + test::kPaperMachine), kExitClean) << shop.err;
    const auto& machine = document["machine"];
    EXPECT_NE(shop.err.find("sample period 2000 us"), std::string::npos) << "taken from the trace";
    EXPECT_EQ(machine["samples_lost"], 0);
    EXPECT_TRUE(machine["receiver_faults"].empty()) << machine["receiver_faults"];
    EXPECT_EQ(machine["tools"], test::Json::array({1}));
    const auto axis = [&](std::size_t i) { return machine["axes"][i]; };
    EXPECT_NEAR(axis(0)["least"].get<double>(), -2, 1e-3);
    EXPECT_NEAR(axis(0)["most"].get<double>(), 10, 1e-3);
    EXPECT_NEAR(axis(0)["last"].get<double>(), -2, 1e-3);
    EXPECT_NEAR(axis(1)["least"].get<double>(), -5, 1e-3);
    EXPECT_NEAR(axis(2)["most"].get<double>(), 1, 1e-3);
    EXPECT_NEAR(axis(3)["least"].get<double>(), -20, 1e-3);
    EXPECT_NEAR(axis(4)["last"].get<double>(), 300, 1e-3);
    EXPECT_LE(axis(0)["fastest_per_min"], 600 * 1.01);
    EXPECT_GE(axis(0)["fastest_per_min"], 300) << "of 600 mm/min along X and Y";
    // A sample that is missing is counted.
    std::string text = test::content_of(trace);
    const std::size_t at = text.find(" 181#", text.size() / 2);
    const std::size_t begin = text.rfind('\n', at) + 1;
    text.erase(begin, text.find('\n', at) + 1 - begin);
    ASSERT_EQ(run(shop.write("lost.log", text) + " --machine " + test::kPaperMachine), kExitClean)
        << shop.err;
    EXPECT_EQ(document["machine"]["samples_lost"], 1);
    EXPECT_FALSE(document["machine"]["receiver_faults"].empty());
}

TEST_F(InspectCommand, ATraceOfAnotherBusHasNoSnapshots) {
    ASSERT_EQ(run(shop.write("a.log", regular()) + " --machine " + test::kPaperMachine), kExitClean)
        << shop.err;
    EXPECT_EQ(document["machine"]["snapshots"], 0);
    EXPECT_NE(shop.err.find("no axis frames of this machine"), std::string::npos) << shop.err;
}

TEST_F(InspectCommand, PackedTracesAreReadAsTheyAre) {
    const std::string plain = shop.write("a.log", regular());
    ASSERT_EQ(std::system(("gzip -k " + plain).c_str()), 0);
    ASSERT_EQ(run(plain), kExitClean);
    const test::Json of_plain = document["ids"];
    const int code = run(plain + ".gz");
    if (shop.err.find("built without zlib") != std::string::npos) {
        GTEST_SKIP() << shop.err;
    }
    EXPECT_EQ(code, kExitClean) << shop.err;
    EXPECT_EQ(document["ids"], of_plain);
    // Half of it is no trace: nobody may take it for a short one.
    const std::string whole = test::content_of(plain + ".gz");
    EXPECT_EQ(run(shop.write("cut.log.gz", whole.substr(0, whole.size() / 2))), kExitCan);
    EXPECT_NE(shop.err.find("cannot be unpacked to its end: damaged or truncated"),
              std::string::npos)
        << shop.err;
    std::string damaged = whole;
    damaged[whole.size() / 2] = static_cast<char>(damaged[whole.size() / 2] ^ 0x55);
    EXPECT_EQ(run(shop.write("bad.log.gz", damaged)), kExitCan) << shop.err;
}

// Members one behind the other are one file (RFC 1952); anything else behind them is a damage.
TEST_F(InspectCommand, PackedMembersAreReadToTheLastByte) {
    const std::string whole = regular();
    (void)shop.write("a.log", whole);
    const std::size_t half = whole.find('\n', whole.size() / 2) + 1;
    const std::string line = "cd '" + shop.file("") + "' && (head -c " + std::to_string(half) +
                             " a.log | gzip; tail -c +" + std::to_string(half + 1) +
                             " a.log | gzip) > two.gz";
    ASSERT_EQ(std::system(line.c_str()), 0);
    const int code = run("two.gz");
    if (shop.err.find("built without zlib") != std::string::npos) {
        GTEST_SKIP() << shop.err;
    }
    EXPECT_EQ(code, kExitClean) << shop.err;
    EXPECT_EQ(document["frames"], std::count(whole.begin(), whole.end(), '\n'));
    const std::string two = test::content_of(shop.file("two.gz"));
    for (const char* const behind : {"rubbish behind it", "(1.0) can0 123#00\n", "x"}) {
        EXPECT_EQ(run(shop.write("b.gz", two + behind)), kExitCan) << behind;
        EXPECT_NE(shop.err.find("b.gz:"), std::string::npos) << shop.err;
        EXPECT_EQ(document["valid"], false);
    }
    EXPECT_EQ(run(shop.write("b.gz", two + "rubbish behind it")), kExitCan);
    EXPECT_NE(shop.err.find("trailing bytes after the gzip data"), std::string::npos) << shop.err;
}

// A trace is opened several times, with a machine four times; a pipe gives its bytes once.
TEST_F(InspectCommand, ReadsPipesFromTheirFirstByte) {
    ASSERT_EQ(run(shop.write("a.log", regular())), kExitClean) << shop.err;
    const auto wanted = document["ids"];
    const std::string machine = shop.write("m.yaml", test::kSmallMachine);
    ASSERT_EQ(shop.run_program("/bin/gzip", "-k a.log"), 0) << shop.err;
    for (const std::string& input :
         {std::string("- < a.log"), std::string("/dev/stdin < a.log"), std::string("- < a.log.gz"),
          std::string("<(cat a.log)"), std::string("<(cat a.log.gz)"),
          "<(cat a.log) --machine " + machine, "- < <(cat a.log) --machine " + machine}) {
        const std::string script =
            std::string("exec '") + AXG_PROGRAM + "' inspect " + input + " --json\n";
        EXPECT_EQ(shop.run_program("/bin/bash", shop.write("s.sh", script)), kExitClean)
            << input << shop.err;
        document = test::Json::parse(shop.out);
        EXPECT_EQ(document["ids"], wanted) << input;
    }
    const std::string script = std::string("printf 'rubbish' | '") + AXG_PROGRAM + "' inspect -\n";
    EXPECT_EQ(shop.run_program("/bin/bash", shop.write("s.sh", script)), kExitCan);
    EXPECT_NE(shop.err.find("-:1: invalid file (found \"rubbish\""), std::string::npos) << shop.err;
}

TEST_F(InspectCommand, WhatIsNoTraceSaysSo) {
    EXPECT_EQ(run("none.log"), kExitInput);
    EXPECT_NE(shop.err.find("cannot be opened"), std::string::npos);
    EXPECT_EQ(run(shop.write("c.log", "garbage\n")), kExitCan);
    EXPECT_NE(shop.err.find("expected a candump log or a Vector ASC file"), std::string::npos);
    const std::string mixed = shop.write("d.log", "(1.000000) can0 123#00\nrubbish\n");
    EXPECT_EQ(run(mixed), kExitCan);
    EXPECT_EQ(document["valid"], false);
    EXPECT_EQ(document["fault"],
              mixed +
                  ":2: time: invalid value (found \"rubbish\", expected a line that begins with "
                  "(seconds.fraction)). Pass over such lines with --lenient.");
    EXPECT_NE(shop.err.find("THE TRACE IS TRUNCATED"), std::string::npos) << shop.err;
    EXPECT_EQ(run(mixed + " --lenient"), kExitClean);
    EXPECT_EQ(document["valid"], true);
    EXPECT_EQ(document["lines_skipped"], 1);
    EXPECT_EQ(document["first_skipped"].get<std::string>().find(mixed + ":2: "), 0U);
    EXPECT_EQ(run(shop.file("c.log")), kExitCan);
    EXPECT_EQ(document["valid"], false) << "a file without any frame";
}

}  // namespace
}  // namespace axg
