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
    EXPECT_EQ(make_frame_set(machine).axis_count, machine.axes.size());
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
    for (const Case& c : {
             Case{"X: Linear.X", "X: X",
                  "m:32: can.axes.X: invalid value (found \"X\", expected a message and a signal "
                  "of the file, such as Message.Signal).\n"},
             Case{"X: Linear.X", "X: Linea.X",
                  "m:32: can.axes.X: invalid value (found \"Linea\", expected a message of "
                  "board.dbc: Linear, Tilt, Pages, Extended). Did you mean \"Linear\"?\n"},
             Case{"X: Linear.X", "X: Linear.Y",
                  "m:32: can.axes.X: invalid value (found \"Y\" (board.dbc:12), expected a signal "
                  "of Linear: X, Count, State, Tool, Homed).\n"},
             Case{"X: Linear.X", "X: Pages.Deep",
                  "m:32: can.axes.X: invalid value (found bits that reach from 0 to 255 "
                  "(board.dbc:27), expected the axis' whole travel, -300 to 300).\n"},
             Case{"X: Linear.X", "X: Tilt.C",
                  "m:32: can.axes.X: invalid value (found the unit \"\" (board.dbc:21), expected "
                  "the unit stated here, such as {signal: Tilt.C, unit: mm}).\nm:34: can.axes.C: "
                  "invalid value (found bits that can.axes.X uses in the same frame "
                  "(board.dbc:21), expected bits of its own for each).\n"},
             Case{"X: Linear.X", "X: Tilt.A",
                  "m:32: can.axes.X: invalid value (found \"rad\" for a rotary axis"},
             Case{"X: Linear.X", "X: {signal: Linear.X, unit: um}",
                  "m:32: can.axes.X.unit: invalid value (found \"um\", and in the DBC file \"mm\" "
                  "(board.dbc:13), expected the unit of the DBC file). Correct either file.\n"},
             Case{"X: Linear.X", "X: {signal: Linear.X, unit: cm}",
                  "m:32: can.axes.X.unit: invalid value (found \"cm\", expected mm, inch, m or "
                  "um).\n"},
             Case{"X: Linear.X", "Y: Linear.X",
                  "m:31: can.axes: invalid value (found no signal for axis X, expected exactly one "
                  "signal for each axis).\nm:32: can.axes.Y: invalid value (found \"Y\", expected "
                  "the name of an axis of this file: X, A, C).\n"},
             Case{"unit: deg}", "unit: mm}",
                  "m:34: can.axes.C: invalid value (found \"mm\" for a rotary axis (board.dbc:21), "
                  "expected deg, rad or turn).\n"},
             Case{"file: board.dbc", "file: nothing.dbc",
                  "m:30: can.file: invalid value (found \"nothing.dbc\": nothing, expected a "
                  "file).\n"},
             Case{"homed: Linear.Homed", "homed: Tilt.A",
                  "m:39: can.status.homed: invalid value (found a floating-point signal "
                  "(board.dbc:20), expected an integer signal whose raw value means yes or no).\n"},
             Case{"[Linear.Count]", "[Pages.Page]",
                  "m:40: can.counters[0]: invalid value (found Pages (board.dbc:23), expected a "
                  "message that carries an axis, or a state).\n"},
             Case{"[Linear.Count]", "[Linear.X]",
                  "m:40: can.counters[0]: invalid value (found a counter of 32 bits "
                  "(board.dbc:13), expected an unsigned integer of at most 8 bits).\n"},
             Case{"[Linear.Count]", "[Linear.Count, Linear.State]",
                  "m:40: can.counters[1]: invalid value (found a second counter of Linear, "
                  "expected one counter for each message).\n"},
             Case{"  file: board.dbc\n", "  file: board.dbc\n  ids: {axes: [0x181]}\n",
                  "m:31: can.ids.axes: invalid value (found ids of axis frames with format: dbc, "
                  "expected no such key). Each signal has its own id.\n"},
             Case{"  file: board.dbc\n", "  file: board.dbc\n  ids: {permit: 0x181}\n",
                  "m:33: can.signals: invalid value (found"},
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

// Bit 31 of a DBC identifier marks 29 bits: 129 of 11 bits is another message.
TEST(MachineDbc, IdentifiersOf29BitsAreOthersThanOf11) {
    const std::string both = with(kBoardDbc, "BO_ 385 Linear", "BO_ 129 Linear");
    const std::string text = with(dbc_machine(), "X: Linear.X", "X: Extended.E");
    Machine machine;
    ASSERT_EQ(faults_with_file(text, both, machine), "");
    EXPECT_EQ(machine.can.signals[0].id, 0x80000081U);
    EXPECT_EQ(machine.can.signals[3].id, 129U);
    const AxisFrameSet set = make_frame_set(machine);
    EXPECT_EQ(set.frame_count, 3U);
    // An identifier of ours has 11 bits, and none of 29 takes its place.
    const std::string sync = with(text, "  file: board.dbc\n",
                                  "  file: board.dbc\n"
                                  "  ids: {emergency: 0x081}\n");
    EXPECT_EQ(faults_with_file(sync, kBoardDbc), "");
    EXPECT_EQ(faults_with_file(sync, both)
                  .find("m:29: can.signals: invalid value (found an id "
                        "that is also the one of emergency"),
              0U)
        << faults_with_file(sync, both);
    EXPECT_EQ(faults_with_file(text, with(kBoardDbc, "2147483777", "2684354560")),
              "board.dbc:29: BO_: invalid value (found 2684354560, expected an identifier up to "
              "2047, or one of 29 bits with bit 31 set).\n");
    EXPECT_EQ(faults_with_file(text, with(kBoardDbc, "2147483777", "2147483648")),
              "m:32: can.axes.X: invalid value (found a signal of identifier 0 (board.dbc:30), "
              "expected another signal). See docs/reference/protocol.md.\n");
}

TEST(MachineDbc, FaultsOfTheFileStandAtItsOwnLines) {
    EXPECT_EQ(faults_with_file(dbc_machine(), with(kBoardDbc, "Linear: 8", "Linear 8")),
              "board.dbc:12: BO_: invalid value (found \"8\", expected \":\").\n");
}

TEST(MachineDbc, BitsAndRangeMustSayTheWholeTravel) {
    EXPECT_EQ(faults_with_file(dbc_machine(), with(kBoardDbc, "0|32@1- (0.0001,0) [-300|300]",
                                                   "0|16@1- (0.0001,0) [0|0]")),
              "m:32: can.axes.X: invalid value (found bits that reach from -3.2768 to 3.2767 "
              "(board.dbc:13), expected the axis' whole travel, -300 to 300).\n");
    EXPECT_EQ(faults_with_file(dbc_machine(), with(kBoardDbc, "[-300|300]", "[-300|250]")),
              "m:32: can.axes.X: invalid value (found a range from -300 to 250 (board.dbc:13), "
              "expected the axis' whole travel, -300 to 300).\n");
    EXPECT_EQ(
        faults_with_file(dbc_machine(), with(kBoardDbc, "0|32@1- (0.0001", "40|32@1- (0.0001")),
        "m:32: can.axes.X: invalid value (found a signal of bits outside the message's 8 bytes "
        "(board.dbc:13), expected another signal). See docs/reference/protocol.md.\n");
    EXPECT_EQ(faults_with_file(dbc_machine(), with(kBoardDbc, "0|32@1- (0.0001,0) [-300|300]",
                                                   "0|54@1- (0.0001,0) [-300|300]")),
              "m:32: can.axes.X: invalid value (found a signal of 54 bits (1 to 53 are read) "
              "(board.dbc:13), expected another signal). See docs/reference/protocol.md.\n");
}

TEST(MachineDbc, NoFloatForAnEndlessAxis) {
    EXPECT_EQ(
        faults_with_file(dbc_machine(), std::string{kBoardDbc} + "SIG_VALTYPE_ 386 C : 1;\n"),
        "m:34: can.axes.C: invalid value (found a floating-point signal for an endless axis "
        "(board.dbc:21), expected an integer signal). A float loses resolution with every turn.\n");
}

TEST(MachineDbc, PagesOfOneMessageCarryAnAxisEach) {
    Machine machine;
    std::string text = with(dbc_machine(), "X: Linear.X", "X: Pages.P0");
    text = with(text, "A: Tilt.A", "A: Pages.P1");
    ASSERT_EQ(faults_with_file(text, kBoardDbc, machine), "");
    EXPECT_EQ(make_frame_set(machine).axis_count, machine.axes.size());
    EXPECT_EQ(machine.can.signals[0].selector.levels[0].length_bits, 8);
    EXPECT_EQ(machine.can.signals[0].selector.ranges[0].least, 0U);
    EXPECT_EQ(machine.can.signals[1].selector.ranges[0].least, 1U);
    EXPECT_EQ(
        faults_with_file(with(text, "A: Pages.P1", "A: {signal: Pages.Page, unit: deg}"), kBoardDbc)
            .find("m:33: can.axes.A: invalid value (found"),
        0U)
        << "multiplexed and not, in one message";
}

// A frame of pages 0 to 2 and of page 1 would be of two sets of signals, and only one is read.
TEST(MachineDbc, PagesThatOverlapInPartAreRefused) {
    Machine machine;
    std::string text = with(dbc_machine(), "X: Linear.X", "X: Pages.P0");
    text = with(text, "A: Tilt.A", "A: Pages.P1");
    const auto faults = [&](const std::string& of_p0, const std::string& of_p1) {
        const std::string file = with(kBoardDbc, "P0 Page 0-0", "P0 Page " + of_p0);
        return faults_with_file(text, with(file, "P1 Page 1 - 1", "P1 Page " + of_p1), machine);
    };
    EXPECT_EQ(faults("0-0, 2-2", "1-1, 3-9"), "");
    EXPECT_EQ(make_frame_set(machine).frame_count, 4U);
    EXPECT_EQ(faults("0-0, 2-3", "1-1, 3-9"),
              "m:33: can.axes.A: invalid value (found pages of which some are those of can.axes.X "
              "(board.dbc:26), expected the same pages, or no page of it).\n");
    EXPECT_EQ(faults("0-1", "0-1")
                  .find("m:33: can.axes.A: invalid value (found bits that "
                        "can.axes.X uses in the same frame"),
              0U);
}

TEST(MachineDbc, WithoutTheFormatItsKeysAreFaults) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "  format: classical\n",
                             "  format: classical\n  file: board.dbc\n")),
              "m:30: can.file: invalid value (found file without format: dbc, expected format: "
              "dbc, or no such key).\n");
    Machine machine;
    const auto faults = parse_machine(dbc_machine(), "m", machine);
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_EQ(faults[0].got, "\"board.dbc\": no files here");
}

}  // namespace
}  // namespace axg::test
