// SPDX-License-Identifier: Apache-2.0
// Faults in how a machine file is written: keys, YAML forms, numbers.
// Each test breaks one thing of a sound file and expects every word of the answer, its line
// included.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

TEST(MachineFaultsKeys, UnknownKeyIsNamedWithTheKnownOnes) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2",
                             "colour: red\n"
                             "first_tool: 2")),
              "m:21: colour: unknown key (expected one of version, name, deadline_us, engine, "
              "program_speed_mm_min, axes, bodies, tools, first_tool, pairs, exclusions, can, "
              "guard, output_line, capacities, cycle, program).\n");
}

// Nobody reads a quarter of a megabyte of faults: the first by their lines, and how many more.
TEST(MachineFaultsKeys, FaultsBeyondTwentyAreCounted) {
    std::string text(kSmallMachine);
    for (int i = 0; i < 5000; ++i) {
        text += "key" + std::to_string(i) + ": 1\n";
    }
    const std::string got = faults_of(text);
    EXPECT_EQ(std::count(got.begin(), got.end(), '\n'), 21);
    EXPECT_NE(got.find("key19: "), std::string::npos);
    EXPECT_EQ(got.find("key20: "), std::string::npos);
    EXPECT_TRUE(got.ends_with("m: 4980 more faults. Correct the faults above first.\n"))
        << got.substr(got.size() - 200);
}

TEST(MachineFaultsKeys, MisspeltKeyGetsTheNearestOne) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "travel_mm:", "travel_nm:")),
              "m:4: axes.X.travel_nm: unknown key (expected one of kind, slot, travel_mm, "
              "speed_mm_min, acceleration_mm_s2, jerk_mm_s3, stopping_mm_s2, stopping_most_mm_s2, "
              "position_error_mm, "
              "following_error_mm, skew_mm). Did you mean \"travel_mm\"?\n");
}

TEST(MachineFaultsKeys, KeyInTheWrongCaseGetsTheNearestOne) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities:", "Capacities:")),
              "m:34: Capacities: unknown key (expected one of version, name, deadline_us, engine, "
              "program_speed_mm_min, axes, bodies, tools, first_tool, pairs, exclusions, can, "
              "guard, output_line, capacities, cycle, program). Did you mean \"capacities\"?\n");
}

TEST(MachineFaultsKeys, LookAlikeKeyIsSpelledOut) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "n\320\260me: small")),
              "m:2: n\320\260me: unknown key with the character U+0430, which is not ASCII "
              "(expected one of version, name, deadline_us, engine, program_speed_mm_min, axes, "
              "bodies, tools, first_tool, pairs, exclusions, can, guard, output_line, capacities, "
              "cycle, program). Did you mean \"name\"?\n");
}

TEST(MachineFaultsKeys, RepeatedKeyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2",
                             "first_tool: 2\n"
                             "first_tool: 1")),
              "m:22: first_tool: invalid value (found the same key twice, expected each key once). "
              "Remove one of the two.\n");
}

TEST(MachineFaultsKeys, RepeatedNestedKeyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "unit: inch", "unit: inch, unit: mm")),
              "m:12: bodies[1].mesh.unit: invalid value (found the same key twice, expected each "
              "key once). Remove one of the two.\n");
}

TEST(MachineFaultsKeys, MissingKeyIsNamed) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small\n", "")),
              "m:1: name: missing required key (expected a text).\n");
}

TEST(MachineFaultsKeys, MissingNestedKeyIsNamed) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, ", unit: inch", "")),
        "m:12: bodies.slide.mesh.unit: missing required key (expected one of mm, inch, m, um).\n");
}

TEST(MachineFaultsKeys, KeyWithoutValueIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2", "first_tool:")),
              "m:21: first_tool: invalid value (found nothing, expected an integer). Set a value "
              "or remove the key.\n");
}

TEST(MachineFaultsKeys, MergeKeyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities: {", "capacities: {<<: {rechecks: 2}, ")),
              "m:34: capacities: invalid value (found a merge key (<<), expected the keys "
              "themselves). Merge keys are not supported.\n");
}

TEST(MachineFaultsKeys, ListAsKeyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities: {", "capacities: {[1]: 2, ")),
              "m:34: capacities: invalid value (found a key that is not a word, expected a key of "
              "the machine file).\n");
}

TEST(MachineFaultsKeys, KeyOfTheOtherAxisKindIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "travel_deg: [-110, 30]", "travel_mm: [-110, 30]")),
        "m:6: axes.A.travel_mm: unknown key (expected one of kind, slot, travel_deg, "
        "speed_deg_s, acceleration_deg_s2, jerk_deg_s3, stopping_deg_s2, stopping_most_deg_s2, "
        "position_error_deg, "
        "following_error_deg). Did you mean \"travel_deg\"?\n");
}

TEST(MachineFaultsForms, AliasAndAnchorAreRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "sample_us: 1000\n",
                       "sample_us: &t 1000\n"
                       "  frozen_samples: *t\n")),
        "m:30: can.sample_us: invalid value (found an anchor (&), expected a plain value). Anchors "
        "and aliases are not supported.\nm:31: can.frozen_samples: invalid value (found an alias "
        "(*), expected the value itself). Anchors and aliases are not supported.\n");
}

TEST(MachineFaultsForms, TagIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: !!str small")),
              "m:2: name: invalid value (found a tag \"tag:yaml.org,2002:str\", expected a plain "
              "value). Tags are not supported.\n");
}

TEST(MachineFaultsForms, BareTagIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: ! small")),
              "m:2: name: invalid value (found a tag \"!\", expected a plain value). Tags are not "
              "supported.\n");
}

TEST(MachineFaultsForms, SecondDocumentIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities:",
                             "---\n"
                             "capacities:")),
              "m:34: invalid file (found a second document, expected one document). Remove the --- "
              "or ... before it.\n");
}

TEST(MachineFaultsForms, DirectiveIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "version: 1\n",
                             "%YAML 1.2\n"
                             "---\n"
                             "version: 1\n")),
              "m:1: invalid file (found a directive (%), expected no line that starts with %). "
              "Directives are not supported.\n");
}

TEST(MachineFaultsForms, ControlCharacterIsRefusedAndEscaped) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: sm\033[2Jall")),
              "m:2: invalid file (found the control character \\x1b, expected visible text). "
              "Remove it.\n");
}

TEST(MachineFaultsForms, WritingDirectionCannotBeTurned) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: sm\342\200\256all")),
              "m:2: invalid file (found the control character \\u202e, expected visible text). "
              "Remove it.\n");
}

TEST(MachineFaultsForms, EscapedControlCharacterIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: \"sm\\x1b[2Jall\"")),
              "m:2: name: invalid value (found \"sm\\x1b[2Jall\", expected one line of text, not "
              "blank, at most 128 bytes).\n");
}

TEST(MachineFaultsForms, BrokenUtf8IsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: sm\377all")),
              "m:2: invalid file (found the byte \\xff which is not UTF-8, expected UTF-8 text). "
              "Save the file in that encoding.\n");
}

TEST(MachineFaultsForms, UnbalancedBracketIsReportedWithItsLine) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities: {", "capacities: {[")),
              "m:34: invalid file (found invalid YAML (illegal flow end), expected YAML). Check "
              "for a truncated file, and for a missing bracket, quote or indent here or above.\n");
}

TEST(MachineFaultsForms, ListInPlaceOfAMapIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine,
                       "capacities: {node_pairs: 8192, triangle_pairs: 65536, rechecks: 1024}",
                       "capacities: [1]")),
        "m:34: capacities: invalid value (found a list of 1, expected a map with the keys "
        "node_pairs, triangle_pairs, rechecks, batch).\n");
}

TEST(MachineFaultsForms, TextInPlaceOfAListIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "data_ids: [0x0181, 641]", "data_ids: 641")),
              "m:32: can.data_ids: invalid value (found \"641\", expected a list of 2, one for "
              "each frame of axis positions, such as [0x181, 0x281, 0x381]).\n");
}

TEST(MachineFaultsNumbers, NanIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: .nan")),
              "m:19: tools.1.length_mm: invalid value (found \".nan\", expected a number from 0 to "
              "100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, InfinityIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: .inf")),
              "m:19: tools.1.length_mm: invalid value (found \".inf\", expected a number from 0 to "
              "100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, OctalIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 050")),
              "m:19: tools.1.length_mm: invalid value (found \"050\", expected a number from 0 to "
              "100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, HexIsRefusedOutsideIdentifiers) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 0x32")),
              "m:19: tools.1.length_mm: invalid value (found \"0x32\", expected a number from 0 to "
              "100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, LeadingPlusIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: +50")),
              "m:19: tools.1.length_mm: invalid value (found \"+50\", expected a number from 0 to "
              "100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, UnitInAValueIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 50 mm")),
              "m:19: tools.1.length_mm: invalid value (found \"50 mm\", expected a number from 0 "
              "to 100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, LocaleCommaIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: \"50,5\"")),
              "m:19: tools.1.length_mm: invalid value (found \"50,5\" in quotes, expected a number "
              "from 0 to 100000, without quotes).\n");
}

TEST(MachineFaultsNumbers, UnderscoreIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 5_0")),
              "m:19: tools.1.length_mm: invalid value (found \"5_0\", expected a number from 0 to "
              "100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, QuotedNumberIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: \"50\"")),
              "m:19: tools.1.length_mm: invalid value (found \"50\" in quotes, expected a number "
              "from 0 to 100000, without quotes).\n");
}

TEST(MachineFaultsNumbers, BareFractionIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: .5")),
              "m:19: tools.1.length_mm: invalid value (found \".5\", expected a number from 0 to "
              "100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, HugeIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 1e999")),
              "m:19: tools.1.length_mm: invalid value (found \"1e999\", expected a number from 0 "
              "to 100000, such as 12, -0.5 or 1.5e-3). Use a decimal point and no unit.\n");
}

TEST(MachineFaultsNumbers, OutOfRangeIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 100000.1")),
              "m:19: tools.1.length_mm: invalid value (found \"100000.1\", expected a number from "
              "0 to 100000).\n");
}

TEST(MachineFaultsNumbers, FractionOfAWholeNumberIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "number: 1,", "number: 1.0,")),
              "m:19: tools[0].number: invalid value (found \"1.0\", expected an integer from 1 to "
              "65535, digits only).\n");
}

TEST(MachineFaultsNumbers, NegativeWholeNumberIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2", "first_tool: -2")),
              "m:21: first_tool: invalid value (found \"-2\", expected an integer from 0 to 65535, "
              "digits only).\n");
}

TEST(MachineFaultsNumbers, WordForASwitchIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "tool: true", "tool: yes")),
        "m:17: bodies.cutter.tool: invalid value (found \"yes\", expected one of false, true).\n");
}

TEST(MachineFaultsNumbers, TwoNumbersWhereThreeBelongAreRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "direction: [0, 0, 1]", "direction: [0, 1]")),
              "m:15: bodies.plate.direction: invalid value (found a list of 2, expected a list of "
              "3 numbers, such as [0, 0, 0]).\n");
}

}  // namespace
}  // namespace axg::test
