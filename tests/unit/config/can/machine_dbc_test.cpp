// SPDX-License-Identifier: Apache-2.0
// format: dbc: which signals of a DBC file become axes and states, and every word of each refusal.
#include <gtest/gtest.h>

#include "firmware_if/protocol/axis_frames.hpp"
#include "tests/support/dbc_text.hpp"

namespace axg::test {
namespace {

TEST(MachineDbc, AxesAndStatesAreTheSignalsOfTheFile) {
    Machine machine;
    ASSERT_EQ(faults_with_file(dbc_machine(), kBoardDbc, machine), "");
    EXPECT_EQ(check_layout(machine), LayoutStatus::ok) << to_text(check_layout(machine));
    EXPECT_EQ(machine.can.format, CanFormat::signals);
    ASSERT_EQ(machine.can.signals.size(), 8U);
    const CanSignal& x = machine.can.signals[0];
    EXPECT_EQ(x.id, 385U);
    EXPECT_EQ(x.role, SignalRole::position);
    EXPECT_EQ(x.axis, 0U);
    EXPECT_EQ(x.factor, 0.0001);
    EXPECT_EQ(x.frame_bytes, 8);
    const CanSignal& a = machine.can.signals[1];
    EXPECT_EQ(a.axis, 1U);
    EXPECT_EQ(a.type, SignalType::float32);
    EXPECT_EQ(a.order, ByteOrder::big);
    EXPECT_NEAR(a.factor, 57.29577951308232, 1e-12);
    EXPECT_EQ(machine.can.signals[3].role, SignalRole::tool);
    EXPECT_EQ(machine.can.signals[4].role, SignalRole::moving);
    EXPECT_EQ(machine.can.signals[4].mark, 1U);
    EXPECT_EQ(machine.can.signals[5].mark, 2U);
    EXPECT_EQ(machine.can.signals[6].role, SignalRole::homed);
    EXPECT_EQ(machine.can.signals[7].role, SignalRole::counter);
    EXPECT_EQ(machine.can.signals[7].mark, 15U) << "0..14, as the range says";
}

TEST(MachineDbc, EveryRefusalNamesBothPlaces) {
    struct Case {
        const char *from, *to, *said;
    };
    for (
        const Case& c : {
            Case{"X: Linear.X", "X: X",
                 "m:32: can.axes.X: got \"X\", wanted a message and a signal of the file, as "
                 "Message.Signal\n"},
            Case{"X: Linear.X", "X: Linea.X",
                 "m:32: can.axes.X: got \"Linea\", wanted \"Linear\"? a message of board.dbc: "
                 "Linear, "
                 "Tilt, Pages, Extended\n"},
            Case{"X: Linear.X", "X: Linear.Y",
                 "m:32: can.axes.X: got \"Y\" (board.dbc:12), wanted a signal of Linear: X, Count, "
                 "State, Tool, Homed\n"},
            Case{"X: Linear.X", "X: Pages.Deep",
                 "m:32: can.axes.X: got a signal of extended multiplexing (board.dbc:27), wanted "
                 "another signal: this one cannot be read; docs/reference/protocol.md says which "
                 "can\n"},
            Case{"X: Linear.X", "X: Extended.E",
                 "m:32: can.axes.X: got a signal of a 29-bit identifier, or identifier 0 "
                 "(board.dbc:30), wanted another signal: this one cannot be read; "
                 "docs/reference/protocol.md says which can\n"},
            Case{"X: Linear.X", "X: Tilt.C",
                 "m:32: can.axes.X: got the unit \"\" (board.dbc:21), wanted the unit stated here, "
                 "as "
                 "{signal: Tilt.C, unit: mm}\n"
                 "m:34: can.axes.C: got bits that can.axes.X holds in the same frame "
                 "(board.dbc:21), wanted bits of its own for each\n"},
            Case{"X: Linear.X", "X: Tilt.A", "m:32: can.axes.X: got \"rad\" for a rotary axis"},
            Case{"X: Linear.X", "X: {signal: Linear.X, unit: um}",
                 "m:32: can.axes.X.unit: got \"um\", and in the DBC file \"mm\" (board.dbc:13), "
                 "wanted one unit: the file's, or the file corrected\n"},
            Case{"X: Linear.X", "X: {signal: Linear.X, unit: cm}",
                 "m:32: can.axes.X.unit: got \"cm\", wanted mm, inch, m or um\n"},
            Case{"X: Linear.X", "Y: Linear.X",
                 "m:31: can.axes: got no signal for axis X, wanted exactly one signal for each "
                 "axis\n"
                 "m:32: can.axes.Y: got \"Y\", wanted the name of an axis of this file: X, A, C\n"},
            Case{
                "unit: deg}", "unit: mm}",
                "m:34: can.axes.C: got \"mm\" for a rotary axis (board.dbc:21), wanted deg, rad or "
                "turn\n"},
            Case{"file: board.dbc", "file: nothing.dbc",
                 "m:30: can.file: got \"nothing.dbc\": nothing, wanted a file\n"},
            Case{"homed: Linear.Homed", "homed: Tilt.A",
                 "m:39: can.status.homed: got a floating-point signal (board.dbc:20), wanted an "
                 "integer signal, whose raw value says yes or no\n"},
            Case{
                "[Linear.Count]", "[Pages.Page]",
                "m:40: can.counters[0]: got Pages (board.dbc:23), wanted a message that carries an "
                "axis, or a state\n"},
            Case{"[Linear.Count]", "[Linear.X]",
                 "m:40: can.counters[0]: got a counter of 32 bits (board.dbc:13), wanted an "
                 "unsigned "
                 "integer of at most 8 bits\n"},
            Case{"[Linear.Count]", "[Linear.Count, Linear.State]",
                 "m:40: can.counters[1]: got a second counter of Linear, wanted one counter for "
                 "each "
                 "message\n"},
            Case{"  file: board.dbc\n", "  file: board.dbc\n  ids: {axes: [0x181]}\n",
                 "m:31: can.ids.axes: got ids of axis frames with format: dbc, wanted no such key "
                 "here: each signal has its own id\n"},
            Case{"  file: board.dbc\n", "  file: board.dbc\n  ids: {permit: 0x181}\n",
                 "m:33: can.signals: got"},
        }) {
        const std::string said = c.said;
        const std::string faults = faults_with_file(with(dbc_machine(), c.from, c.to), kBoardDbc);
        if (said.ends_with('\n')) {
            EXPECT_EQ(faults, said);
        } else {
            EXPECT_FALSE(faults.empty()) << said;
        }
    }
}

TEST(MachineDbc, FaultsOfTheFileStandAtItsOwnLines) {
    EXPECT_EQ(faults_with_file(dbc_machine(), with(kBoardDbc, "Linear: 8", "Linear 8")),
              "board.dbc:12: BO_: got \"8\", wanted \":\"\n");
}

TEST(MachineDbc, BitsAndRangeMustSayTheWholeTravel) {
    EXPECT_EQ(faults_with_file(dbc_machine(), with(kBoardDbc, "0|32@1- (0.0001,0) [-300|300]",
                                                   "0|16@1- (0.0001,0) [0|0]")),
              "m:32: can.axes.X: got bits that reach from -3.2768 to 3.2767 (board.dbc:13), wanted "
              "the axis' whole travel, -300 to 300\n");
    EXPECT_EQ(
        faults_with_file(dbc_machine(), with(kBoardDbc, "[-300|300]", "[-300|250]")),
        "m:32: can.axes.X: got a range from -300 to 250 (board.dbc:13), wanted the axis' whole "
        "travel, -300 to 300\n");
    EXPECT_EQ(
        faults_with_file(dbc_machine(), with(kBoardDbc, "0|32@1- (0.0001", "40|32@1- (0.0001")),
        "m:32: can.axes.X: got a signal of bits outside the message's 8 bytes (board.dbc:13), "
        "wanted another signal: this one cannot be read; docs/reference/protocol.md says which "
        "can\n");
    EXPECT_EQ(
        faults_with_file(dbc_machine(), with(kBoardDbc, "0|32@1- (0.0001,0) [-300|300]",
                                             "0|54@1- (0.0001,0) [-300|300]")),
        "m:32: can.axes.X: got a signal of 54 bits (1 to 53 are read) (board.dbc:13), wanted "
        "another signal: this one cannot be read; docs/reference/protocol.md says which can\n");
}

TEST(MachineDbc, NoFloatForAnEndlessAxis) {
    EXPECT_EQ(faults_with_file(dbc_machine(), std::string{kBoardDbc} + "SIG_VALTYPE_ 386 C : 1;\n"),
              "m:34: can.axes.C: got a floating-point signal for an endless axis (board.dbc:21), "
              "wanted an integer signal: a float loses resolution with every turn\n");
}

TEST(MachineDbc, PagesOfOneMessageCarryAnAxisEach) {
    Machine machine;
    std::string text = with(dbc_machine(), "X: Linear.X", "X: Pages.P0");
    text = with(text, "A: Tilt.A", "A: Pages.P1");
    ASSERT_EQ(faults_with_file(text, kBoardDbc, machine), "");
    EXPECT_EQ(check_layout(machine), LayoutStatus::ok);
    EXPECT_EQ(machine.can.signals[0].selector.length_bits, 8);
    EXPECT_EQ(machine.can.signals[0].selector.value, 0U);
    EXPECT_EQ(machine.can.signals[1].selector.value, 1U);
    EXPECT_EQ(
        faults_with_file(with(text, "A: Pages.P1", "A: {signal: Pages.Page, unit: deg}"), kBoardDbc)
            .find("m:33: can.axes.A: got"),
        0U)
        << "multiplexed and not, in one message";
}

TEST(MachineDbc, WithoutTheFormatItsKeysAreFaults) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "  format: classical\n",
                       "  format: classical\n  file: board.dbc\n")),
        "m:30: can.file: got file without format: dbc, wanted format: dbc as well, or no such "
        "key\n");
    Machine machine;
    const auto faults = parse_machine(dbc_machine(), "m", machine);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_EQ(faults[0].got, "\"board.dbc\": no files here");
}

}  // namespace
}  // namespace axg::test
