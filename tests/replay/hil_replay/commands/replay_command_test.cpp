// SPDX-License-Identifier: Apache-2.0
// `axguard replay --mode contact` as people and scripts meet it: exit codes, words, tables, frames.
// Runs the program itself. The other mode: stoppable_command_test.cpp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/guard_frames.hpp"
#include "firmware_if/protocol/handshake.hpp"
#include "tests/support/board_fixture.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

using namespace std::string_literals;

constexpr const char* kStart = "T1 M6\nG0 X20 Y5 Z40\n";

class ReplayCommand : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        shop = std::make_unique<test::Workshop>();
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            return;
        }
        ASSERT_EQ(shop->run("simulate " + test::kPaperMachine + " " + test::kDemoProgram +
                            " -o demo.log"),
                  kExitClean)
            << shop->err;
        (void)shop->write("brief.ngc", std::string(kStart) + "G1 A-10 C30 F3000\nM2\n");
        ASSERT_EQ(shop->run("simulate " + test::kPaperMachine + " brief.ngc -o brief.log"),
                  kExitClean)
            << shop->err;
    }
    static void TearDownTestSuite() { shop.reset(); }
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }
    static int replay(const std::string& arguments) {
        return shop->run("replay " + test::kPaperMachine + " --mode contact " + arguments);
    }
    static std::unique_ptr<test::Workshop> shop;
};

std::unique_ptr<test::Workshop> ReplayCommand::shop;

// The block's target, by hand: the stop lies between it and the block before.
TEST_F(ReplayCommand, AStopNamesItsProgramLineAndBlock) {
    EXPECT_EQ(replay("demo.log --json=lines.json"), kExitCollision) << shop->err;
    const auto document = test::Json::parse(test::content_of(shop->file("lines.json")));
    const auto& stop = document["stops"][0];
    std::istringstream program(test::content_of(test::kDemoProgram));
    std::string block;
    for (std::uint32_t i = 0; i < stop["program_line"].get<std::uint32_t>(); ++i) {
        std::getline(program, block);
    }
    EXPECT_EQ(stop["program_block"], block);
    EXPECT_EQ(document["program"], test::kDemoProgram);
    EXPECT_NE(shop->out.find(fmt::format("\n  {}:{}: {}\n", test::kDemoProgram,
                                         stop["program_line"].get<std::uint32_t>(), block)),
              std::string::npos)
        << shop->out;
    EXPECT_NE(block.find(" Y107.2108 "), std::string::npos) << block;
    EXPECT_LT(stop["axes"]["Y_mm"].get<double>(), 107.2108);
    EXPECT_GT(stop["axes"]["Y_mm"].get<double>(), 106.7);
}

TEST_F(ReplayCommand, WithoutProgramLinesAStopLosesNothingElse) {
    EXPECT_EQ(replay("demo.log"), kExitCollision);
    const std::string with = shop->out.substr(shop->out.find("STOP at"));
    std::filesystem::copy_file(shop->file("demo.log"), shop->file("bare.log"));
    EXPECT_EQ(replay("bare.log"), kExitCollision);
    EXPECT_EQ(shop->err, "");
    std::string bare = shop->out.substr(shop->out.find("STOP at"));
    EXPECT_EQ(bare.find(".ngc:"), std::string::npos);
    const std::size_t begin = with.find('\n'), end = with.find('\n', begin + 1);
    EXPECT_EQ(bare, with.substr(0, begin) + with.substr(end));
    (void)shop->write("bare.log.lines", "nonsense\n");
    EXPECT_EQ(replay("bare.log"), kExitCollision);
    EXPECT_NE(shop->err.find("bare.log.lines: no program lines"), std::string::npos) << shop->err;
    EXPECT_EQ(shop->out.substr(shop->out.find("STOP at")), bare);
    EXPECT_EQ(replay("bare.log --lines demo.log.lines"), kExitCollision);
    EXPECT_EQ(shop->out.substr(shop->out.find("STOP at")), with);
}

// As a recorded trace comes: without a table of lines, but the program is known.
TEST_F(ReplayCommand, ARecordedTraceIsMatchedWithItsProgram) {
    EXPECT_EQ(replay("demo.log"), kExitCollision);
    const std::string with = shop->out.substr(shop->out.find("STOP at"));
    std::filesystem::copy_file(shop->file("demo.log"), shop->file("recorded.log"));
    EXPECT_EQ(replay("recorded.log --program " + test::kDemoProgram), kExitCollision);
    EXPECT_EQ(shop->out.substr(shop->out.find("STOP at")), with);
    EXPECT_NE(shop->err.find(" of 40074 samples are on its path"), std::string::npos) << shop->err;

    // Another program, or another zero point, names no line of the stop and says so.
    for (const std::string& wrong : {"--program brief.ngc"s, "--program " + test::kDemoProgram +
                                                                 " --work-offset 'G54 X30 Y30'"}) {
        EXPECT_EQ(replay("recorded.log " + wrong), kExitCollision);
        EXPECT_EQ(shop->out.find(".ngc:"), std::string::npos) << shop->out;
        EXPECT_NE(shop->err.find(" samples are on its path. Check --work-offset"),
                  std::string::npos)
            << shop->err;
    }
    EXPECT_EQ(replay("recorded.log --program none.ngc"), kExitInput) << shop->err;
    EXPECT_EQ(replay("recorded.log --program ''"), kExitUsage) << shop->err;
    (void)shop->write("bad.ngc", "G1 X20\nM2\n");  // no F
    EXPECT_EQ(replay("recorded.log --program bad.ngc"), kExitCollision) << "the stop says more";
    EXPECT_NE(shop->err.find("no program lines: the program was rejected, started from the trace's "
                             "first sample. Where the program starts elsewhere, pass --start."),
              std::string::npos)
        << shop->err;
    EXPECT_EQ(replay("brief.log --program bad.ngc"), kExitInput);
    EXPECT_EQ(replay("brief.log --program bad.ngc --max-lines 5"), kExitInput);
    EXPECT_EQ(replay("recorded.log --work-offset 'G54 X30'"), kExitUsage);
    EXPECT_NE(shop->err.find("Pass it with --program."), std::string::npos) << shop->err;
    EXPECT_EQ(replay("recorded.log --lines demo.log.lines --program " + test::kDemoProgram),
              kExitUsage);
}

TEST_F(ReplayCommand, ACollisionIsExit10WithPairTrianglesTimeAndAxes) {
    EXPECT_EQ(replay("demo.log --details"), kExitCollision) << shop->err;
    EXPECT_NE(shop->out.find(": contact, cutter-c"), std::string::npos) << shop->out;
    EXPECT_NE(shop->out.find("pairs of triangles touch: "), std::string::npos) << shop->out;
    EXPECT_NE(shop->out.find("\nSTOP at "), std::string::npos);
    for (const char* const word : {"AVG", "MIN", "MAX", "p99", "sum of averages", " deg", " mm"}) {
        EXPECT_NE(shop->out.find(word), std::string::npos) << word;
    }
}

TEST_F(ReplayCommand, ACleanTraceIsExit0) {
    EXPECT_EQ(replay("brief.log --deadline-us 1000000"), kExitClean) << shop->err;
    EXPECT_EQ(shop->out.find("STOP"), std::string::npos) << shop->out;
}

/// The trace, with the board's hash of each of the first parts after its first frame.
std::string with_hashes(const std::string& trace, const ConfigurationHashes& hashes, int parts) {
    const std::size_t line = trace.find('\n') + 1;
    const std::string stamp = trace.substr(0, trace.find(')') + 1);
    std::string said;
    for (std::uint8_t part = 0; part < parts; ++part) {
        const CanFrame frame = encode_hash(0x582, {part, hashes.of.at(part)}, 0);
        std::string bytes;
        for (std::size_t i = 0; i < frame.length_bytes; ++i) {
            bytes += fmt::format("{:02X}", frame.data[i]);
        }
        said += stamp + " can0 582#" + bytes + "\n";
    }
    return trace.substr(0, line) + said + trace.substr(line);
}

// A trace may begin after board and guard were compared: what it has is compared, and counted.
TEST_F(ReplayCommand, HashesOfTheTraceAreComparedAndTheOthersTaken) {
    const LoadedMachine loaded = test::load_paper_machine();
    ConfigurationHashes hashes = configuration_hashes(loaded.machine, loaded.meshes);
    const std::string trace = test::content_of(shop->file("brief.log"));
    for (const int parts : {0, 3, 4}) {
        (void)shop->write("hashes.log", with_hashes(trace, hashes, parts));
        EXPECT_EQ(replay("hashes.log"), kExitClean) << shop->err;
        const std::string words = fmt::format("hashes: the trace contains {} of 4;", parts);
        EXPECT_EQ(shop->out.find(words) != std::string::npos, parts != 4) << shop->out;
        EXPECT_EQ(replay("hashes.log --json"), kExitClean) << shop->err;
        EXPECT_EQ(test::Json::parse(shop->out)["hashes_compared"], parts);
    }
    hashes.of[2] += 1;
    (void)shop->write("hashes.log", with_hashes(trace, hashes, 4));
    EXPECT_EQ(replay("hashes.log"), kExitCan) << "another machine";
    EXPECT_NE(shop->out.find("refused"), std::string::npos) << shop->out;
}

TEST_F(ReplayCommand, WithoutHashesInTheFileNothingIsSaidOfThem) {
    (void)shop->write("none.yaml", test::with(test::content_of(test::kPaperMachine),
                                              "hashes: required", "hashes: none"));
    EXPECT_EQ(shop->run("replay none.yaml --mesh-root " + test::source_file("config/machines") +
                        " --mode contact brief.log --json"),
              kExitClean)
        << shop->err;
    EXPECT_FALSE(test::Json::parse(shop->out).contains("hashes_compared"));
}

// simulate may be told another kind of frame and another period than the machine file says; the
// trace shows both.
TEST_F(ReplayCommand, FlexibleFramesAndAnotherPeriodAreTakenFromTheTrace) {
    ASSERT_EQ(shop->run("simulate " + test::kPaperMachine + " " + test::kDemoProgram +
                        " -o fd.log --fd --sample-us 500"),
              kExitClean)
        << shop->err;
    EXPECT_EQ(replay("fd.log"), kExitCollision) << shop->err;
    EXPECT_NE(shop->err.find("using fd"), std::string::npos) << shop->err;
    EXPECT_NE(shop->err.find("using 500"), std::string::npos) << shop->err;
    EXPECT_NE(shop->out.find(": contact, cutter-c"), std::string::npos) << shop->out;
}

TEST_F(ReplayCommand, ADeadlineNoProcessorKeepsIsCountedAndInRealTimeExit11) {
    EXPECT_EQ(replay("brief.log --deadline-us 1"), kExitClean) << shop->err;
    EXPECT_EQ(shop->out.find("deadline 1 us: 0 of"), std::string::npos) << shop->out;
    EXPECT_NE(shop->out.find("counted, not judged"), std::string::npos) << shop->out;
    EXPECT_EQ(replay("demo.log --deadline-us 1"), kExitCollision);
    EXPECT_EQ(replay("brief.log --deadline-us 1 --realtime --json"), kExitDeadline) << shop->err;
    EXPECT_EQ(test::Json::parse(shop->out)["permits"], 0) << "late is late";
}

TEST_F(ReplayCommand, ATraceThatCannotBeJudgedIsExit12) {
    const std::string whole = test::content_of(shop->file("brief.log"));
    const std::size_t middle = whole.find('\n', whole.size() / 2) + 1;
    (void)shop->write("dropped.log", whole.substr(0, middle) +
                                         "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total "
                                         "drops 3)\n" +
                                         whole.substr(middle));
    EXPECT_EQ(replay("dropped.log"), kExitCan);
    EXPECT_NE(shop->err.find("dropped.log:"), std::string::npos) << shop->err;
    EXPECT_NE(shop->err.find("DROPCOUNT"), std::string::npos) << shop->err;

    (void)shop->write("empty.log", "");
    EXPECT_EQ(replay("empty.log"), kExitCan);
    EXPECT_NE(shop->err.find("empty.log: the trace is empty"), std::string::npos) << shop->err;
    (void)shop->write("prose.log", "this is no trace\n");
    EXPECT_EQ(replay("prose.log"), kExitCan);
    EXPECT_NE(shop->err.find("prose.log:1: invalid file (found "), std::string::npos) << shop->err;
    (void)shop->write("cut.log", whole.substr(0, middle) + "(0000000001.");
    EXPECT_EQ(replay("cut.log"), kExitCan);

    std::string other = whole;  // another board's ids: no sample is ever complete
    for (std::size_t at = 0; (at = other.find(" 181#", at)) != std::string::npos; ++at) {
        other.replace(at, 5, " 191#");
    }
    (void)shop->write("ids.log", other);
    EXPECT_EQ(replay("ids.log"), kExitCan);
    EXPECT_NE((shop->out + shop->err).find("Compare the ids"), std::string::npos) << shop->out;

    (void)shop->write("few.log", whole.substr(0, whole.find('\n') + 1));
    EXPECT_EQ(replay("few.log"), kExitCan) << "one SYNC is no sample";
}

TEST_F(ReplayCommand, ATraceOfAnotherMachineNeverPasses) {
    const std::string other = test::source_file("config/machines/spindle-tilting.yaml");
    EXPECT_EQ(shop->run("replay " + other + " demo.log"), kExitCan) << shop->out;
    EXPECT_NE(shop->out.find("input, "), std::string::npos) << "says which fault";
}

TEST_F(ReplayCommand, WhatIsNotThereIsExit3AndWhatIsNoOptionExit2) {
    EXPECT_EQ(replay("nowhere.log"), kExitInput);
    EXPECT_NE(shop->err.find("nowhere.log: "), std::string::npos) << shop->err;
    EXPECT_EQ(shop->run("replay nowhere.yaml brief.log"), kExitInput);
    EXPECT_EQ(replay(""), kExitUsage);
    EXPECT_EQ(replay("brief.log --deadline-us 0"), kExitUsage);
    EXPECT_EQ(replay("brief.log --deadline-us -5"), kExitUsage);
    EXPECT_EQ(replay("brief.log --engine gpu"), kExitUsage);
    EXPECT_EQ(replay("brief.log --within 0"), kExitUsage);
    EXPECT_EQ(shop->run("replay " + test::kPaperMachine + " brief.log --mode sometimes"),
              kExitUsage);
    EXPECT_EQ(replay("brief.log --engine cuda"), kExitGpu);
    EXPECT_EQ(replay("brief.log --csv no/such/folder.csv"), kExitUsage);
}

TEST_F(ReplayCommand, TheTableIsTheSameBytesTwiceAndHasALineASample) {
    EXPECT_EQ(replay("brief.log --deadline-us 1000000 --csv one.csv --json=one.json"), kExitClean);
    EXPECT_EQ(replay("brief.log --deadline-us 1000000 --csv two.csv"), kExitClean);
    const std::string table = test::content_of(shop->file("one.csv"));
    EXPECT_EQ(table, test::content_of(shop->file("two.csv")));
    EXPECT_EQ(table.substr(0, table.find('\n')),
              "sample,latched_us,arrived_us,X_mm,Y_mm,Z_mm,A_deg,C_deg,tool,permit,reason,"
              "not_proven,cutter-x_mm,cutter-y_mm,cutter-a_mm,cutter-c_mm,z-x_mm,z-y_mm,z-a_mm,"
              "z-c_mm");
    const auto document = test::Json::parse(test::content_of(shop->file("one.json")));
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), document["samples"].get<long>() + 1);
}

TEST_F(ReplayCommand, TheTableAndTheReportTellOfTheSameStop) {
    ASSERT_EQ(replay("demo.log --keep-going --csv all.csv --json=all.json"), kExitCollision);
    const auto document = test::Json::parse(test::content_of(shop->file("all.json")));
    std::istringstream table(test::content_of(shop->file("all.csv")));
    std::string line;
    std::getline(table, line);
    long contacts = 0, permits = 0, samples = 0;
    while (std::getline(table, line)) {
        ++samples;
        contacts += line.find(",contact,") != std::string::npos ? 1 : 0;
        permits += line.find(",1,none,0,") != std::string::npos ? 1 : 0;
    }
    EXPECT_EQ(samples, document["samples"].get<long>());
    EXPECT_EQ(permits, document["permits"].get<long>());
    EXPECT_GT(contacts, 10);
    long told = 0;
    for (const auto& stop : document["stops"]) {
        EXPECT_EQ(stop["reason"], "contact");
        told += stop["samples"].get<long>();
    }
    EXPECT_EQ(told, contacts);
    ASSERT_EQ(replay("demo.log --json=first.json"), kExitCollision);
    const auto first = test::Json::parse(test::content_of(shop->file("first.json")));
    EXPECT_EQ(first["stops"].size(), 1U);
    EXPECT_EQ(first["stops"][0]["time_us"], document["stops"][0]["time_us"]);
}

TEST_F(ReplayCommand, JsonHasTheKeysThatOtherProgramsRead) {
    ASSERT_EQ(replay("demo.log --json"), kExitCollision) << shop->err;
    const auto document = test::Json::parse(shop->out);
    for (const char* const key :
         {"trace", "machine", "mode", "engine", "lanes", "frames", "samples", "samples_lost",
          "permits", "deadline_us", "overruns", "receiver_faults", "pairs", "cycle", "slowest",
          "stops", "stop_count"}) {
        EXPECT_TRUE(document.contains(key)) << key;
    }
    EXPECT_EQ(document["pairs"].size(), 8U);
    for (const char* const key : {"count", "avg_us", "min_us", "max_us", "p99_us"}) {
        EXPECT_TRUE(document["cycle"].contains(key)) << key;
        EXPECT_TRUE(document["pairs"]["cutter-c"].contains(key)) << key;
    }
    const auto& stop = document["stops"].at(0);
    EXPECT_EQ(stop["pair"], "cutter-c");
    EXPECT_EQ(stop["axes"].size(), 5U);
    const auto& nearest = stop["pairs"].at(0);
    EXPECT_EQ(nearest["pair"], "cutter-c");
    EXPECT_EQ(nearest["clearance_mm"], 0);
    EXPECT_GT(nearest["touching"], 0);
    EXPECT_FALSE(nearest["triangles"].empty());
}

TEST_F(ReplayCommand, TheFramesAroundTheStopAreThoseOnRecord) {
    ASSERT_EQ(replay("demo.log --frames-out sent.log"), kExitCollision) << shop->err;
    const std::string sent = test::content_of(shop->file("sent.log"));
    std::size_t from = sent.size();  // the last 18 lines
    for (int lines = 0; from > 0 && lines < 19; --from) {
        lines += sent[from - 1] == '\n' ? 1 : 0;
        if (lines == 19) {
            break;
        }
    }
    const std::string record = test::source_file("tests/replay/golden/demo_stop.log");
    EXPECT_EQ(sent.substr(from), test::content_of(record))
        << "if program, meshes or motion were meant to change: tail -n 18 of --frames-out";
}

// The library for boards between the trace's samples and the guard's frames.
TEST_F(ReplayCommand, ABoardThatReadsTheFramesEndsWithoutAPermit) {
    ASSERT_EQ(replay("demo.log --frames-out sent.log"), kExitCollision) << shop->err;
    test::BoardFixture fixture;
    (void)axg_board_power_up(&fixture.board, &fixture.options, 1, 0);
    (void)axg_board_arm(&fixture.board, EncoderOptions{}.nonce, 500'000);
    const auto board_frames = test::read_trace(shop->file("demo.log"));
    auto next = board_frames.begin();
    std::uint32_t number = 0;
    std::uint64_t permits = 0, refused = 0;
    for (const CanFrame& frame : test::read_trace(shop->file("sent.log"))) {
        for (; next != board_frames.end() && next->time_us <= frame.time_us; ++next) {
            if (next->id == 0x080) {
                ASSERT_TRUE(fixture.latch_at(number++, static_cast<std::uint64_t>(next->time_us)));
            }
        }
        axg_board_can_frame heard{};
        heard.id = frame.id;
        heard.length = frame.length_bytes;
        std::copy_n(frame.data.begin(), frame.length_bytes, heard.data);
        const bool was_stopped = fixture.board.phase == AXG_BOARD_STOPPED;
        const axg_board_heard what =
            axg_board_frame(&fixture.board, &heard, static_cast<std::uint64_t>(frame.time_us));
        permits += what == AXG_BOARD_HEARD_PERMIT ? 1 : 0;
        refused += what == AXG_BOARD_HEARD_REFUSED && !was_stopped ? 1 : 0;
    }
    EXPECT_GT(permits, 10'000U);
    EXPECT_EQ(refused, 1U) << "the first pair only begins the live counter";
    EXPECT_EQ(fixture.board.phase, AXG_BOARD_STOPPED);
    EXPECT_EQ(fixture.board.cause, AXG_BOARD_CAUSE_STOP_FRAME);
}

// What the deployed guard sends: a stop every period, until the board confirms it.
TEST_F(ReplayCommand, AGapIsExit10WithStopsAndNoFurtherPermit) {
    const std::string whole = test::content_of(shop->file("brief.log"));
    const std::size_t from = whole.find('\n', whole.size() / 2) + 1;
    const std::size_t to = whole.find('\n', from + 4000) + 1;  // some twenty samples
    (void)shop->write("gap.log", whole.substr(0, from) + whole.substr(to));
    EXPECT_EQ(replay("gap.log --frames-out gap_sent.log"), kExitCollision);
    EXPECT_NE(shop->out.find(": silence"), std::string::npos) << shop->out;
    const CanLayout layout;
    std::vector<std::int64_t> stops_us;
    for (const CanFrame& frame : test::read_trace(shop->file("gap_sent.log"))) {
        if (decode_stop(layout, frame) == GuardFrameStatus::ok) {
            stops_us.push_back(frame.time_us);
        }
        EXPECT_FALSE(!stops_us.empty() && frame.id == layout.permit_id &&
                     frame.data[0] != static_cast<std::uint8_t>(PermitWord::stop));
    }
    EXPECT_GE(stops_us.size(), 10U);
    for (std::size_t i = 1; i < stops_us.size(); ++i) {
        EXPECT_LE(stops_us[i] - stops_us[i - 1], layout.sample_us);
    }
    EXPECT_EQ(replay("gap.log --keep-going"), kExitCollision);
}

TEST_F(ReplayCommand, ATraceThatEndsInMotionSaysWhenTheGuardWouldHaveStopped) {
    const std::string whole = test::content_of(shop->file("brief.log"));
    const std::size_t to = whole.find('\n', whole.size() / 2) + 1;
    (void)shop->write("half.log", whole.substr(0, to));
    EXPECT_EQ(replay("half.log --deadline-us 1000000"), kExitClean) << shop->err;
    EXPECT_NE(shop->out.find("THE TRACE ENDS IN MOTION at"), std::string::npos) << shop->out;
    EXPECT_EQ(shop->out.find("no stop"), std::string::npos) << shop->out;
    EXPECT_EQ(replay("half.log --deadline-us 1000000 --json"), kExitClean);
    const auto ends = test::Json::parse(shop->out)["ends_in_motion"];
    EXPECT_GT(ends["stop_us"], ends["time_us"]);
    EXPECT_LT(ends["stop_us"], ends["time_us"].get<std::int64_t>() + 5000);
    EXPECT_TRUE(test::Json::parse(shop->out)["receiver_faults"].empty())
        << "what would follow is not the trace's";
    // One foreign frame much later: the stop is dated when the guard would have stopped.
    (void)shop->write("late.log", whole.substr(0, to) + "(0000000900.000000) can0 7AA#00\n");
    EXPECT_EQ(replay("late.log --deadline-us 1000000 --json"), kExitCollision);
    const auto stop = test::Json::parse(shop->out)["stops"][0];
    EXPECT_EQ(stop["time_us"], ends["stop_us"]);
}

TEST_F(ReplayCommand, TheGuardIsArmedWhenToldTo) {
    EXPECT_EQ(replay("brief.log --json"), kExitClean);
    const auto at_once = test::Json::parse(shop->out);
    const double later_s = at_once["armed_us"].get<double>() * 1e-6 + 0.5;
    EXPECT_EQ(replay(fmt::format("brief.log --json --arm-at {}", later_s)), kExitClean);
    const auto later = test::Json::parse(shop->out);
    EXPECT_GE(later["armed_us"].get<double>() * 1e-6, later_s);
    EXPECT_LT(later["permits"], at_once["permits"]);
}

// A machine that got no permit did not move, whatever was proven.
TEST_F(ReplayCommand, ATraceWithoutAPermitIsNotClear) {
    EXPECT_EQ(replay("brief.log --json --arm-at 100000"), kExitCollision);
    EXPECT_EQ(test::Json::parse(shop->out)["permits"], 0);
    EXPECT_EQ(replay("brief.log --arm-at 100000"), kExitCollision);
    EXPECT_NE(shop->out.find("never armed: --arm-at is after"), std::string::npos) << shop->out;
    EXPECT_EQ(shop->out.find("no stop"), std::string::npos) << shop->out;
    const std::string whole = test::content_of(shop->file("brief.log"));
    (void)shop->write("start.log", whole.substr(0, whole.find('\n', 1500) + 1));
    EXPECT_EQ(replay("start.log"), kExitCollision);
    EXPECT_NE(shop->out.find("never armed: it was not ready"), std::string::npos) << shop->out;
}

// Lateness that is judged ends with 11, the cycle that stopped the guard counted and listed.
TEST_F(ReplayCommand, ALateCycleThatStopsIsLate) {
    EXPECT_EQ(replay("brief.log --json --realtime --deadline-us 1"), kExitDeadline) << shop->out;
    const auto document = test::Json::parse(shop->out);
    EXPECT_GT(document["overruns"], 0);
    EXPECT_EQ(document["permits"], 0);
}

// The bus was heard all the while, by its own frames: the board was silent.
TEST_F(ReplayCommand, FramesOfAGuardTellTheTime) {
    const std::string whole = test::content_of(shop->file("brief.log"));
    const std::size_t to = whole.find('\n', whole.size() / 2) + 1;
    (void)shop->write("heard.log", whole.substr(0, to) + "(0000000900.000000) can0 702#05\n");
    EXPECT_EQ(replay("heard.log --json"), kExitCollision);
    const auto document = test::Json::parse(shop->out);
    EXPECT_EQ(document["guard_frames"], 1);
    EXPECT_LT(document["stops"][0]["time_us"], 900'000'000);
}

// Lost frames are the trace's fault, however the guard stops for them.
TEST_F(ReplayCommand, LostFramesAreAFaultOfTheTrace) {
    std::istringstream whole(test::content_of(shop->file("brief.log")));
    std::string line, kept;
    for (int samples = 0; std::getline(whole, line);) {
        const bool is_last_axis = line.find(" 281#") != std::string::npos;
        samples += is_last_axis ? 1 : 0;
        if (!is_last_axis || samples < 100 || samples % 3 != 0) {
            kept += line + "\n";
        }
    }
    (void)shop->write("lossy.log", kept);
    EXPECT_EQ(replay("lossy.log"), kExitCan) << shop->out;
}

TEST_F(ReplayCommand, AFaultBeforeTheFirstSampleShowsNoPositions) {
    const std::string whole = test::content_of(shop->file("brief.log"));
    const std::string bus_off = "(0000000000.900000) can0 20000040#0000000000000000\n";
    (void)shop->write("off.log", bus_off + whole);
    EXPECT_EQ(replay("off.log"), kExitCan);
    EXPECT_NE(shop->out.find("input, bus_off"), std::string::npos) << shop->out;
    EXPECT_NE(shop->out.find("no complete sample before it"), std::string::npos) << shop->out;
}

}  // namespace
}  // namespace axg
