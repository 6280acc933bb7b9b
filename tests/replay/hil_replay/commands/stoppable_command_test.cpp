// SPDX-License-Identifier: Apache-2.0
// `axguard replay` in its default mode: the permit goes before the contact, a clean program keeps
// it, and what is written down says why. Runs the program itself.
// ctest-labels: long
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <sstream>

#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/hints_frame.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/permit_reader.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

class StoppableCommand : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shop = std::make_unique<test::Workshop>();
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            return;
        }
        for (const auto& [program, trace] :
             {std::pair{test::kDemoProgram, "demo.log"}, {test::kCleanProgram, "clean.log"}}) {
            ASSERT_EQ(shop->run("simulate " + test::kPaperMachine + " " + program + " -o " + trace),
                      kExitClean)
                << shop->err;
        }
    }
    static void TearDownTestSuite() { shop.reset(); }
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }
    // The deadline is not the point here: a shared machine may be late.
    static int replay(const std::string& arguments, const std::string& machine = "") {
        return shop->run("replay " + (machine.empty() ? test::kPaperMachine : machine) +
                         " --deadline-us 10000000 " + arguments);
    }
    static test::Json document(const std::string& name) {
        return test::Json::parse(test::content_of(shop->file(name)));
    }
    static std::unique_ptr<test::Workshop> shop;
};

std::unique_ptr<test::Workshop> StoppableCommand::shop;

TEST_F(StoppableCommand, TheCleanProgramKeepsItsPermit) {
    EXPECT_EQ(replay("clean.log --details --json=clean.json"), kExitClean)
        << shop->out << shop->err;
    const auto all = document("clean.json");
    EXPECT_EQ(all["mode"], "stoppable");
    EXPECT_EQ(all["stop_count"], 0);
    // The four hashes take three repetitions, 30 samples, before the first permit.
    EXPECT_GE(all["permits"].get<long>() + 3 + 30 + GuardLimits{}.snapshots_min,
              all["samples"].get<long>());
    EXPECT_NEAR(all["proofs"]["horizon_ms"].get<double>(), 5.05, 1e-9);
    EXPECT_GE(all["proofs"]["queries"]["median"].get<long>(), 8) << "one a pair at least";
    EXPECT_LE(all["proofs"]["queries"]["p99"], all["proofs"]["queries"]["max"]);
    EXPECT_LE(all["proofs"]["stages"]["max"].get<long>(), 3);
    EXPECT_EQ(all["proofs"]["plan"]["stages"].size(), 3U);
    EXPECT_EQ(all["proofs"]["plan"]["stages"][2]["queries"], 512);
    EXPECT_NE(shop->out.find("plan: 3 stages, 544 queries after the first; lists: 192 node pairs"),
              std::string::npos)
        << shop->out;
}

// The contact is at a known sample; the permit goes before it, while the bodies are still apart.
TEST_F(StoppableCommand, ThePermitGoesWhileTheBodiesAreStillApart) {
    EXPECT_EQ(replay("demo.log --json=stop.json"), kExitCollision) << shop->err;
    EXPECT_NE(shop->out.find(": predicted, cutter-c"), std::string::npos) << shop->out;
    EXPECT_EQ(replay("demo.log --mode contact --json=contact.json"), kExitCollision);
    const auto stop = document("stop.json")["stops"].at(0);
    const auto contact = document("contact.json")["stops"].at(0);
    EXPECT_EQ(stop["reason"], "predicted");
    EXPECT_EQ(stop["pair"], contact["pair"]);
    EXPECT_LT(stop["time_us"], contact["time_us"]);
    const auto& nearest = stop["pairs"].at(0);
    EXPECT_EQ(nearest["pair"], "cutter-c");
    EXPECT_GT(nearest["clearance_mm"].get<double>(), 0);
    EXPECT_EQ(nearest["touching"], 0);
    ASSERT_FALSE(stop["escapes"].empty());
    EXPECT_GT(stop["escapes"][0]["clearance_mm"], nearest["clearance_mm"]);
    EXPECT_TRUE(contact["escapes"].empty()) << "out of a contact nothing is proven";
}

// A board that may change its acceleration at once gets farther: less is proven, nothing more.
TEST_F(StoppableCommand, APromiseThatIsNotMadeStopsEarlier) {
    std::string text = test::content_of(test::kPaperMachine);
    text.replace(text.find("free_jerk: limited"), 18, "free_jerk: any");
    const std::string machine =
        shop->write("any.yaml", text) + " --mesh-root " + test::source_file("config/machines");
    EXPECT_EQ(replay("demo.log --json=any.json", machine), kExitCollision) << shop->err;
    EXPECT_EQ(replay("demo.log --json=limited.json"), kExitCollision);
    EXPECT_LT(document("any.json")["stops"][0]["time_us"],
              document("limited.json")["stops"][0]["time_us"]);
}

TEST_F(StoppableCommand, TheTableSaysWhichPairAndWhatItTookAndIsTheSameTwice) {
    ASSERT_EQ(replay("demo.log --csv one.csv --json=one.json"), kExitCollision);
    ASSERT_EQ(replay("demo.log --csv two.csv"), kExitCollision);
    const std::string table = test::content_of(shop->file("one.csv"));
    EXPECT_EQ(table, test::content_of(shop->file("two.csv")));
    EXPECT_EQ(table.substr(0, table.find(",cutter-x_mm")),
              "sample,latched_us,arrived_us,X_mm,Y_mm,Z_mm,A_deg,C_deg,tool,permit,reason,"
              "not_proven,pair,questions,stages");
    std::istringstream lines(table);
    std::string line, last;
    long permits = 0, samples = -1;
    while (std::getline(lines, line)) {
        ++samples;
        permits += line.find(",1,none,0,,") != std::string::npos ? 1 : 0;
        last = line;
    }
    const auto all = document("one.json");
    EXPECT_EQ(samples, all["samples"].get<long>());
    EXPECT_EQ(permits, all["permits"].get<long>());
    EXPECT_NE(last.find(",0,predicted,1,cutter-c,"), std::string::npos) << last;
}

// Of a board that sends no session yet, the trace is judged as if it did.
TEST_F(StoppableCommand, ATraceWithoutSessionsIsJudgedAsWithThem) {
    std::istringstream lines(test::content_of(shop->file("demo.log")));
    std::string silent, line;
    std::size_t left_out = 0;
    while (std::getline(lines, line)) {
        const bool is_session = line.find(" 583#") != std::string::npos;
        left_out += is_session ? 1 : 0;
        silent += is_session ? "" : line + "\n";
    }
    EXPECT_GT(left_out, 100U);
    (void)shop->write("silent.log", silent);
    ASSERT_EQ(replay("demo.log --csv with.csv"), kExitCollision);
    ASSERT_EQ(replay("silent.log --csv without.csv"), kExitCollision);
    EXPECT_NE(shop->err.find("no session frame 0x583"), std::string::npos) << shop->err;
    EXPECT_EQ(test::content_of(shop->file("with.csv")),
              test::content_of(shop->file("without.csv")));
}

TEST_F(StoppableCommand, TheBoardIsToldOfAPredictedCollision) {
    ASSERT_EQ(replay("demo.log --frames-out sent.log"), kExitCollision);
    const CanLayout layout;
    test::PermitReader reader(layout);
    std::uint64_t runs = 0, emergencies = 0;
    bool stopped = false;
    for (const CanFrame& frame : test::read_trace(shop->file("sent.log"))) {
        const std::optional<Permit> permit = reader.on_frame(frame);
        stopped = stopped || decode_stop(layout, frame) == GuardFrameStatus::ok;
        const bool is_run = permit && permit->word == PermitWord::run;
        EXPECT_FALSE(stopped && is_run);
        runs += is_run ? 1 : 0;
        Emergency emergency;
        if (decode_emergency(layout, frame, emergency) == GuardFrameStatus::ok) {
            EXPECT_EQ(emergency.code, EmergencyCode::predicted_collision);
            EXPECT_EQ(emergency.pair, 3) << "cutter-c";
            ++emergencies;
        }
    }
    EXPECT_GT(runs, 10'000U);
    EXPECT_EQ(emergencies, 1U);
    EXPECT_TRUE(stopped);
}

/// The paper's machine with clearance levels, for the command line.
std::string with_clearance_levels(const test::Workshop& shop) {
    std::string text = test::content_of(test::kPaperMachine);
    for (std::size_t at = 0; (at = text.find("margin_mm: 0}", at)) != std::string::npos;) {
        text.replace(at, 13, "margin_mm: 0, slow_mm: 5, warn_mm: 20}");
    }
    return shop.write("levels.yaml", text) + " --mesh-root " + test::source_file("config/machines");
}

// Clearance levels are advisories beside the certificate: they change no permit, and what is
// written about them agrees.
TEST_F(StoppableCommand, ClearanceLevelsAreReportedAndChangeNoPermit) {
    const std::string machine = with_clearance_levels(*shop);
    for (const std::string mode : {"stoppable", "contact"}) {
        const std::string arguments = "demo.log --mode " + mode;
        ASSERT_EQ(replay(arguments + " --json=plain.json"), kExitCollision);
        ASSERT_EQ(
            replay(arguments + " --details --json=l.json --csv l.csv --frames-out l.log", machine),
            kExitCollision)
            << shop->err;
        EXPECT_NE(shop->out.find("worst of all"), std::string::npos) << shop->out;
        const auto plain = document("plain.json"), levels = document("l.json");
        for (const char* key : {"permits", "samples", "stop_count"}) {
            EXPECT_EQ(plain[key], levels[key]) << key;
        }
        EXPECT_EQ(plain["stops"][0]["time_us"], levels["stops"][0]["time_us"]);
        EXPECT_FALSE(plain.contains("levels"));
        const auto slow = levels["levels"]["slow"].get<long>();
        const auto warn = levels["levels"]["warn"].get<long>();
        EXPECT_GT(slow, 0);
        EXPECT_GT(warn, 0);
        EXPECT_GE(levels["pairs"]["cutter-c"]["slow"].get<long>(), 1);
        EXPECT_LE(levels["levels"]["queries"]["max"].get<long>(), 512);
        std::istringstream lines(test::content_of(shop->file("l.csv")));
        std::string line;
        std::getline(lines, line);
        EXPECT_NE(line.find(",level,level_pair,"), std::string::npos) << line;
        long slow_lines = 0, warn_lines = 0;
        while (std::getline(lines, line)) {
            slow_lines += line.find(",slow,") != std::string::npos ? 1 : 0;
            warn_lines += line.find(",warn,") != std::string::npos ? 1 : 0;
        }
        EXPECT_EQ(slow_lines, slow);
        EXPECT_EQ(warn_lines, warn);
        test::PermitReader reader{CanLayout{}};
        long slow_permits = 0, permits = 0, hints = 0;
        for (const CanFrame& frame : test::read_trace(shop->file("l.log"))) {
            const std::optional<Permit> permit = reader.on_frame(frame);
            const bool is_slow = permit && permit->word == PermitWord::slow;
            slow_permits += is_slow ? 1 : 0;
            permits += is_slow || (permit && permit->word == PermitWord::run);
            const bool is_hint = frame.id == CanLayout{}.hints_id;
            const std::size_t pair = is_hint ? frame.data[1] + 256U * frame.data[2] : kHintNone;
            hints += pair != kHintNone ? 1 : 0;
            EXPECT_TRUE(pair == kHintNone || pair < levels["pairs"].size());
        }
        EXPECT_EQ(permits, levels["permits"].get<long>());
        EXPECT_GT(hints, 0);
        EXPECT_GT(slow_permits, 0);
        EXPECT_LT(slow_permits, permits);
    }
}

TEST_F(StoppableCommand, CheckShowsTheClearanceLevels) {
    ASSERT_EQ(shop->run("check " + with_clearance_levels(*shop) + " --json=check.json"),
              kExitClean);
    EXPECT_NE(shop->out.find("slow within 5 mm more, warn within 20 mm more"), std::string::npos)
        << shop->out;
    EXPECT_EQ(document("check.json")["pairs"][0]["slow_mm"], 5);
    EXPECT_EQ(document("check.json")["pairs"][0]["warn_mm"], 20);
}

TEST_F(StoppableCommand, CheckShowsTheHorizonAndHowFarEachAxisGets) {
    ASSERT_EQ(shop->run("check " + test::kPaperMachine + " --json=check.json"), kExitClean);
    const auto guard = document("check.json")["guard"];
    EXPECT_NEAR(guard["horizon_ms"].get<double>(), 5.05, 1e-9);
    EXPECT_EQ(guard["promise"], "independent");
    EXPECT_EQ(guard["free_jerk"], "limited");
    ASSERT_EQ(guard["axes"].size(), 5U);
    for (const auto& axis : guard["axes"]) {
        EXPECT_GT(axis["reach_at_rest"].get<double>(), 0.001) << axis;
        EXPECT_LT(axis["reach_at_rest"].get<double>(), 1) << axis;
        EXPECT_GT(axis["reach_at_full_speed"].get<double>(), 10) << axis;
    }
}

}  // namespace
}  // namespace axg
