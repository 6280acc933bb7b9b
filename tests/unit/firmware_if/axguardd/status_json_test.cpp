// SPDX-License-Identifier: Apache-2.0
// The line of the status socket: it is JSON with every key of docs/reference/axguardd.md, the
// longest one fits, and in words it says what a person needs; the exit code is that of the stop.
#include "firmware_if/axguardd/status_json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "firmware_if/axguardd/board_test_record.hpp"
#include "firmware_if/cli/exit_codes.hpp"
#include "firmware_if/live/status_line.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/motion_machine.hpp"
#include "tests/support/page_text.hpp"

namespace axg {
namespace {

constexpr std::int64_t kNowUs = 100'000'000;

class StatusLineTest : public testing::Test {
  protected:
    StatusLineTest() {
        machine.pairs = {{.a = 5, .b = 3}};
        view.phase = GuardPhase::armed;
        view.time_us = kNowUs - 3000;
        view.phase_us = kNowUs - 12'003'000;
        view.withheld = {.why = WithheldPermit::Why::nothing};
        view.stands = view.has_session = true;
        view.counters.snapshots = 1000;
        view.counters.permits = 990;
    }
    std::string text(const LiveView* shown) const {
        std::array<char, kStatusLineBytesMax> room{};
        const StatusLine line(machine, "m.yaml", "can0", "stoppable", std::string(64, 'a'),
                              board_test);
        return {room.data(), line.write(shown, why, kNowUs, room)};
    }
    test::Json json() const { return test::Json::parse(text(&view)); }
    StatusWords words() const {
        const auto read = words_of_status(text(&view));
        EXPECT_TRUE(read);
        return read.value_or(StatusWords{});
    }
    void stop(GuardFault cause, StopReason reason) {
        view.phase = GuardPhase::stopped;
        view.cause = cause;
        view.reason = reason;
        view.pair = 0;
    }

    /// With every part another figure.
    static PairWhy a_why() {
        PairWhy out;
        out.tool = 0;
        out.distances.need = {.margin_mm = 2,
                              .until_braking_mm = 1.25,
                              .braking_mm = 3.5,
                              .position_error_mm = 0.0125,
                              .speed_uncertainty_mm = 0.25,
                              .arithmetic_mm = 0.0005};
        out.distances.available_mm = 6.5;
        out.distances.within_mm = 50;
        out.distances.open = OpenPart{.needed_mm = 3, .available_mm = 2.75};
        return out;
    }

    Machine machine = motion_test_machine();
    LiveView view;
    StatusWhy why;
    TestedBoard board_test;
};

TEST_F(StatusLineTest, SaysWhatTheGuardIsAndWhere) {
    const auto said = json();
    EXPECT_NE(said["axguardd"], "");
    EXPECT_EQ(said["bus"], "can0");
    EXPECT_EQ(said["machine"], "motion-test");
    EXPECT_EQ(said["mode"], "stoppable");
    EXPECT_EQ(said["configuration_sha256"], std::string(64, 'a'));
    EXPECT_EQ(said["age_ms"], 3);
    EXPECT_EQ(said["phase"], "armed");
    EXPECT_EQ(said["phase_ms"], 12'000);
    EXPECT_EQ(said["cause"], "none");
    EXPECT_TRUE(said["pair"].is_null());
    EXPECT_EQ(said["withheld"], "nothing");
    EXPECT_EQ(said["session"], true);
    EXPECT_EQ(said["stands"], true);
    EXPECT_EQ(said["permits"], 990);
    EXPECT_EQ(text(&view).find('\n'), text(&view).size() - 1) << "one line";
    EXPECT_EQ(said["hashes"], "required");
    view.compares_hashes = false;
    EXPECT_EQ(json()["hashes"], "none");
    EXPECT_NE(words().text.find("hashes are not compared"), std::string::npos);
    machine.can.format = CanFormat::signals;  // no counter, so no session
    EXPECT_TRUE(json()["session"].is_null());
}

TEST_F(StatusLineTest, OfAStopItNamesCauseReasonAndPair) {
    stop(GuardFault::verdict, StopReason::contact);
    const auto said = json();
    EXPECT_EQ(said["cause"], "verdict");
    EXPECT_EQ(said["reason"], "contact");
    EXPECT_EQ(said["pair"], test::Json::array({"cutter", "plate"}));
    EXPECT_EQ(said["confirmed"], false);
    view.is_confirmed = true;
    EXPECT_EQ(json()["confirmed"], true);
    view.phase = GuardPhase::selftest;  // after the reset
    EXPECT_EQ(json()["cause"], "none");
    EXPECT_EQ(json()["reason"], "none");
    EXPECT_TRUE(json()["pair"].is_null());
}

TEST_F(StatusLineTest, AnUnknownToolIsShownWithTheWayOut) {
    const std::string way =
        "tool 3 is not in m.yaml: add it under tools; load another tool to go on";
    stop(GuardFault::verdict, StopReason::tool);
    why.stop.account.unknown_tool = std::uint16_t{3};
    EXPECT_EQ(json()["unknown_tool"], 3);
    EXPECT_NE(words().text.find("  " + way + "\n"), std::string::npos) << words().text;
    EXPECT_EQ(words().ways_out, std::vector{way});
    why.stop.account.unknown_tool.reset();  // another one is loaded
    EXPECT_EQ(words().text.find("m.yaml"), std::string::npos) << words().text;
    EXPECT_TRUE(words().ways_out.empty());
}

TEST_F(StatusLineTest, AStopHasTheProvenJogAndTheProgramLine) {
    EXPECT_TRUE(json()["way_out"].is_null());
    EXPECT_TRUE(json()["program_line"].is_null());
    const std::string jog = "jog Z+ (1 mm: clearance at least 1.3000 mm) or X- or A+";
    why.stop.account.ways_out = jog;
    view.program_line = 12;
    EXPECT_TRUE(json()["way_out"].is_null()) << "it is not stopped";
    EXPECT_TRUE(json()["program_line"].is_null());
    stop(GuardFault::verdict, StopReason::predicted);
    EXPECT_EQ(json()["way_out"], jog);
    EXPECT_EQ(json()["program_line"], 12);
    EXPECT_EQ(json()["file"], "m.yaml");
    EXPECT_EQ(words().text.rfind(
                  "can0: stopped: verdict: predicted: cutter - plate, program line 12, for 12.0 s\n"
                  "  " +
                      jog + "\n",
                  0),
              0U)
        << words().text;
    EXPECT_EQ(words().ways_out, std::vector{jog});
}

// Number 0 is a spindle without a number of its own: what the guard checks there is shown.
TEST_F(StatusLineTest, ToolZeroIsShownWithTheToolThatIsGuarded) {
    EXPECT_TRUE(json()["tool"].is_null());
    EXPECT_EQ(words().text.find(", tool"), std::string::npos);
    why.tool = std::uint16_t{5};
    EXPECT_EQ(json()["tool"], 5);
    EXPECT_EQ(json()["guarded_tool"], 5);
    EXPECT_NE(words().text.find("session received, tool 5\n"), std::string::npos);
    why.tool = std::uint16_t{0};
    machine.first_tool = 1;
    EXPECT_EQ(json()["guarded_tool"], 1);
    EXPECT_NE(words().text.find(", tool 0 (guarded as first_tool, 1)\n"), std::string::npos);
    machine.first_tool = 0;
    EXPECT_TRUE(json()["guarded_tool"].is_null());
    EXPECT_NE(words().text.find(", tool 0 (empty)\n"), std::string::npos);
}

TEST_F(StatusLineTest, OfAWithheldPermitItNamesWhatIsNotProven) {
    view.phase = GuardPhase::selftest;
    view.withheld = {WithheldPermit::Why::not_proven, StopReason::predicted, 0};
    EXPECT_EQ(json()["withheld"], "not proven");
    EXPECT_EQ(json()["withheld_reason"], "predicted");
    EXPECT_EQ(json()["withheld_pair"], test::Json::array({"cutter", "plate"}));
    EXPECT_NE(words().text.find("no permit: not proven: predicted: cutter - plate\n"),
              std::string::npos)
        << words().text;
}

TEST_F(StatusLineTest, DistancesAreThereWhereTheyAreKnown) {
    const auto none = json();
    for (const char* const key : {"why", "withheld_why"}) {
        ASSERT_TRUE(none.contains(key));
        EXPECT_TRUE(none[key].is_null()) << key;
    }
    why.stop.why = a_why();
    EXPECT_TRUE(json()["why"].is_null()) << "it is not stopped";
    stop(GuardFault::verdict, StopReason::predicted);
    const auto has = json()["why"];
    EXPECT_EQ(has["needed_mm"], 7.013);
    EXPECT_EQ(has["available_mm"], 6.5);
    EXPECT_EQ(has["within_mm"], 50);
    EXPECT_EQ(has["until_braking_mm"], 1.25);
    EXPECT_EQ(has["braking_mm"], 3.5);
    EXPECT_EQ(has["position_error_mm"], 0.0125);
    EXPECT_EQ(has["speed_uncertainty_mm"], 0.25);
    EXPECT_EQ(has["margin_mm"], 2);
    EXPECT_EQ(has["arithmetic_mm"], 0.0005);
    EXPECT_TRUE(has["to_standstill_mm"].is_null());
    EXPECT_EQ(has["jog"], false);
    EXPECT_EQ(has["list_full"], false);
    EXPECT_EQ(has["tool"], machine.tools[0].number);
    EXPECT_EQ(has["open"], test::Json::object({{"needed_mm", 3.0}, {"available_mm", 2.75}}));
    EXPECT_TRUE(json()["withheld_why"].is_null());
    why.stop.why->is_whole = why.stop.why->is_jog = true;
    why.stop.why->tool = kNoIndex;
    why.stop.why->distances.open.reset();
    const auto whole = json()["why"];
    EXPECT_EQ(whole["to_standstill_mm"], 1.25);
    for (const char* const key : {"until_braking_mm", "braking_mm", "position_error_mm",
                                  "speed_uncertainty_mm", "tool", "open"}) {
        EXPECT_TRUE(whole[key].is_null()) << key;
    }
    EXPECT_EQ(whole["jog"], true);
}

TEST_F(StatusLineTest, DistancesInWordsAreThoseOfAReplay) {
    stop(GuardFault::verdict, StopReason::predicted);
    EXPECT_EQ(words().text.find("needs"), std::string::npos) << "not known";
    why.stop.why = a_why();
    EXPECT_NE(words().text.find(
                  "  cutter and plate could not be proven clear\n"
                  "  they are at least 6.5000 mm apart, the proof of a stop needs up to 7.0130 mm\n"
                  "  needs 7.0130 mm and has 6.5000 mm, tool 1\n"
                  "    motion until braking 1.2500, braking 3.5000, uncertainty of position "
                  "0.0125, of speed 0.2500, margin 2, arithmetic 0.0005 mm\n"
                  "    the first part left open needs 3.0000 mm and has 2.7500 mm\n"),
              std::string::npos)
        << words().text;
    why.stop.why->distances.available_mm = 50;
    EXPECT_NE(words().text.find("has at least 50.0000 mm"), std::string::npos);
    EXPECT_EQ(words().text.find("was full"), std::string::npos);
    why.stop.why->is_list_full = true;
    EXPECT_NE(words().text.find("    a list of the engine was full (cycle: in the machine file)\n"),
              std::string::npos);
    EXPECT_NE(words().text.find("\n  cutter and plate could not be proven clear within the time of "
                                "a cycle\n"),
              std::string::npos);
    EXPECT_EQ(json()["why"]["list_full"], true);
    why.stop.why->distances.available_mm = 0;
    EXPECT_NE(words().text.find("and has none"), std::string::npos);
    view.phase = GuardPhase::selftest;
    view.withheld = {WithheldPermit::Why::not_proven, StopReason::predicted, 0};
    why.withheld = a_why();
    why.withheld->is_jog = why.withheld->is_whole = true;
    EXPECT_NE(words().text.find("predicted: cutter - plate\n  cutter and plate could not"),
              std::string::npos)
        << words().text;
    EXPECT_NE(words().text.find("motion to standstill 1.2500, clearance to keep in this jog 2,"),
              std::string::npos);
}

TEST_F(StatusLineTest, BeforeTheFirstViewItSaysInit) {
    const auto said = test::Json::parse(text(nullptr));
    EXPECT_EQ(said["phase"], "init");
    const auto read = words_of_status(text(nullptr));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->exit_code, kExitDeadline) << "nobody knows what it does";
    EXPECT_EQ(read->text.substr(0, read->text.find('\n')),
              "can0: init: no update of the bus thread yet");
}

TEST_F(StatusLineTest, EveryKeyIsOnThePageAndNoOther) {
    const std::string page = test::page_of("reference/axguardd.md");
    const std::size_t begin = page.find("## State without root");
    ASSERT_NE(begin, std::string::npos);
    const std::string part = page.substr(begin, page.find("\n## ", begin) - begin);
    const auto said = json();
    for (const auto& [key, value] : said.items()) {
        EXPECT_NE(part.find('`' + key + '`'), std::string::npos) << key;
    }
}

TEST_F(StatusLineTest, TheLongestLineFits) {
    constexpr auto kMost = std::numeric_limits<std::uint64_t>::max();
    machine.name = std::string(5000, '\x01');  // six bytes each, escaped
    machine.bodies[5].name = machine.bodies[3].name = std::string(64, 'n');
    stop(GuardFault::second_guard, StopReason::left_limits);
    view.withheld = {WithheldPermit::Why::not_proven, StopReason::left_limits, 0};
    view.time_us = std::numeric_limits<std::int64_t>::min() / 2;
    why.stop.why = why.withheld = a_why();
    why.stop.account.unknown_tool = std::uint16_t{65535};
    why.stop.account.ways_out = std::string(450, 'j');
    view.program_line = std::numeric_limits<std::int32_t>::max();
    for (std::optional<PairWhy>* const most : {&why.stop.why, &why.withheld}) {
        (*most)->distances.need = {1e12, 1e12, 1e12, 1e12, 1e12, 1e12};
        (*most)->distances.available_mm = (*most)->distances.within_mm = kMarginMmMax;
        (*most)->distances.open = OpenPart{1e12, kMarginMmMax};
    }
    LiveCounters& counters = view.counters;
    for (std::uint64_t* const count :
         {&counters.snapshots, &counters.permits, &counters.slow, &counters.stops, &counters.late,
          &counters.refused, &counters.send_faults, &view.input.samples_lost, &view.frames_dropped,
          &counters.operator_acts, &counters.operator_refused, &counters.operator_ignored}) {
        *count = kMost;
    }
    EXPECT_EQ(json()["operator_ignored"], kMost);
    EXPECT_LT(text(&view).size(), kStatusLineBytesMax);
}

TEST_F(StatusLineTest, InWordsItSaysPhaseAndForHowLong) {
    EXPECT_EQ(words().text.substr(0, words().text.find('\n')), "can0: armed, for 12.0 s");
    EXPECT_NE(words().text.find("axes at rest, board session received\n"), std::string::npos);
    EXPECT_EQ(words().text.find("no permit"), std::string::npos);
    EXPECT_EQ(words().exit_code, kExitClean);
    view.stands = view.has_session = false;
    EXPECT_NE(words().text.find("axes not at rest, no board session\n"), std::string::npos);
    EXPECT_EQ(words().text.find("bus thread of the guard is blocked"), std::string::npos);
    view.time_us = kNowUs - 1'500'000;
    EXPECT_NE(words().text.find("no update for 1500 ms"), std::string::npos);
}

TEST_F(StatusLineTest, AHeldBusThreadIsLate) {
    view.time_us = kNowUs - 1'000'999;
    EXPECT_EQ(words().exit_code, kExitClean);
    view.time_us = kNowUs - 1'001'000;
    EXPECT_EQ(words().exit_code, kExitDeadline);
    stop(GuardFault::input, StopReason::none);
    EXPECT_EQ(words().exit_code, kExitCan) << "that of the stop";
}

TEST_F(StatusLineTest, SaysWhetherTheBoardWasTestedForThisConfiguration) {
    EXPECT_EQ(json()["board_test"]["record"], "none");
    EXPECT_TRUE(json()["board_test"]["serial"].is_null());
    EXPECT_NE(words().text.find("board test: no record\n"), std::string::npos) << words().text;
    board_test.serial = std::string(kSerialCharactersMax, '"');
    board_test.date = "2026-11-30T01:02:03Z";
    board_test.state = RecordState::this_configuration;
    EXPECT_EQ(json()["board_test"]["serial"], board_test.serial);
    EXPECT_NE(words().text.find("record for this configuration: serial \"\""), std::string::npos)
        << words().text;
    board_test.state = RecordState::another;
    board_test.differs = {"model", "limits"};
    EXPECT_EQ(json()["board_test"]["differs"][1], "limits");
    EXPECT_NE(words().text.find("record of another configuration (other model, limits): serial "),
              std::string::npos)
        << words().text;
}

TEST_F(StatusLineTest, TheExitCodeIsThatOfTheStop) {
    for (const auto& [cause, code] : {std::pair{GuardFault::verdict, kExitCollision},
                                      {GuardFault::latched, kExitCollision},
                                      {GuardFault::gap, kExitDeadline},
                                      {GuardFault::silence, kExitDeadline},
                                      {GuardFault::input, kExitCan},
                                      {GuardFault::second_guard, kExitCan},
                                      {GuardFault::foreign_stop, kExitCan},
                                      {GuardFault::refused, kExitUnfit}}) {
        stop(cause, cause == GuardFault::verdict ? StopReason::contact : StopReason::none);
        EXPECT_EQ(words().exit_code, code) << to_text(cause);
    }
    stop(GuardFault::verdict, StopReason::contact);
    EXPECT_EQ(words().text.substr(0, words().text.find(',')),
              "can0: stopped: verdict: contact: cutter - plate");
}

// Whatever answers under that name: a line that is cut, or another program's.
TEST_F(StatusLineTest, WhatIsNoStatusIsNotTaken) {
    const std::string whole = text(&view);
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
        EXPECT_FALSE(words_of_status(whole.substr(0, size))) << size;
    }
    for (const char* const other : {"", "[]", "null", "3", "{}", "{\"phase\":\"armed\"}",
                                    "{\"axguardd\":1,\"phase\":\"armed\"}", "\xFF\xFE", "{\"a\""}) {
        EXPECT_FALSE(words_of_status(other)) << other;
    }
}

// What this program does not know is nothing to go on by.
TEST_F(StatusLineTest, AKeyThatIsMissingOrOfAnotherTypeIsNoStatus) {
    const test::Json whole = json();
    ASSERT_TRUE(words_of_status(whole.dump()));
    for (const auto& [key, value] : whole.items()) {
        test::Json odd = whole;
        odd.erase(key);
        EXPECT_FALSE(words_of_status(odd.dump())) << "without " << key;
        odd.set(key, test::Json::object());
        EXPECT_FALSE(words_of_status(odd.dump())) << key;
    }
    for (const auto& [key, value] : {std::pair<const char*, test::Json>{"age_ms", 1e300},
                                     {"age_ms", -1},
                                     {"age_ms", 2.0},
                                     {"phase_ms", -5},
                                     {"snapshots", "many"},
                                     {"permits", -1},
                                     {"stands", nullptr},
                                     {"confirmed", 1},
                                     {"session", "yes"},
                                     {"pair", test::Json::array({1, 2})},
                                     {"withheld_pair", test::Json::array({"a"})},
                                     {"hashes", "some"},
                                     {"phase", "dancing"},
                                     {"phase", "Stopped"},
                                     {"cause", "boredom"},
                                     {"cause", ""}}) {
        test::Json odd = whole;
        odd.set(key, value);
        EXPECT_FALSE(words_of_status(odd.dump())) << key << ' ' << value;
    }
    stop(GuardFault::verdict, StopReason::predicted);
    why.stop.why = a_why();
    const test::Json with_why = json();
    ASSERT_TRUE(words_of_status(with_why.dump()));
    for (const auto& [key, value] : with_why["why"].items()) {
        test::Json odd = with_why, odd_why = with_why["why"];
        odd_why.erase(key);
        odd.set("why", odd_why);
        EXPECT_FALSE(words_of_status(odd.dump())) << "without " << key;
        odd_why.set(key, "\x1b[2J");
        odd.set("why", odd_why);
        EXPECT_FALSE(words_of_status(odd.dump())) << key;
    }
    test::Json newer = whole;
    newer.set("a key that is new", 1);
    EXPECT_TRUE(words_of_status(newer.dump()));
    stop(GuardFault::verdict, StopReason::contact);
    test::Json unknown = json();
    unknown.set("cause", "boredom");
    EXPECT_FALSE(words_of_status(unknown.dump()));
    unknown.set("cause", "none");
    const auto read = words_of_status(unknown.dump());
    ASSERT_TRUE(read);
    EXPECT_NE(read->exit_code, kExitClean);
}

TEST_F(StatusLineTest, NoCharacterOfItSteersATerminal) {
    stop(GuardFault::verdict, StopReason::contact);
    test::Json odd = json();
    const std::string steering = "\x1b]0;x\x07\x7f\xc2\x9b[J\xe2\x80\xae";
    for (const char* const key :
         {"axguardd", "bus", "machine", "file", "mode", "configuration_sha256", "reason",
          "withheld", "withheld_reason"}) {
        odd.set(key, steering);
    }
    odd.set("pair", test::Json::array({steering, steering}));
    odd.set("withheld_pair", odd["pair"]);
    const auto read = words_of_status(odd.dump());
    ASSERT_TRUE(read);
    for (const std::string& said : {read->text, read->json}) {
        for (const char c : said) {
            EXPECT_TRUE(c == '\n' || (c >= ' ' && c <= '~')) << static_cast<int>(c);
        }
    }
    EXPECT_EQ(test::Json::parse(read->json), odd);
}

}  // namespace
}  // namespace axg
