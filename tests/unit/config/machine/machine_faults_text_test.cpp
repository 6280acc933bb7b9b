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
              "m:21: colour: got an unknown key \"colour\", wanted one of the keys known "
              "here: version, name, deadline_us, engine, program_speed_mm_min, axes, bodies, "
              "tools, first_tool, pairs, exclusions, can, guard, output_line, capacities, cycle\n");
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
    EXPECT_TRUE(got.ends_with("m: got 4980 more faults, wanted the ones above repaired first\n"))
        << got.substr(got.size() - 200);
}

TEST(MachineFaultsKeys, MisspeltKeyGetsTheNearestOne) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "travel_mm:", "travel_nm:")),
        "m:4: axes.X.travel_nm: got an unknown key \"travel_nm\", wanted "
        "\"travel_mm\"? one of the keys known here: kind, slot, travel_mm, speed_mm_min, "
        "acceleration_mm_s2, jerk_mm_s3, stopping_mm_s2, position_error_mm, following_error_mm\n");
}

TEST(MachineFaultsKeys, KeyInTheWrongCaseGetsTheNearestOne) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities:", "Capacities:")),
              "m:34: Capacities: got an unknown key \"Capacities\", wanted \"capacities\"? "
              "one of the keys known here: version, name, deadline_us, engine, "
              "program_speed_mm_min, axes, bodies, tools, first_tool, pairs, exclusions, "
              "can, guard, output_line, capacities, cycle\n");
}

TEST(MachineFaultsKeys, LookAlikeKeyIsSpelledOut) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "n\320\260me: small")),
              "m:2: n\320\260me: got an unknown key \"n\320\260me\" with the character "
              "U+0430, which is not ASCII, wanted \"name\"? one of the keys known here: "
              "version, name, deadline_us, engine, program_speed_mm_min, axes, bodies, tools, "
              "first_tool, pairs, exclusions, can, guard, output_line, capacities, cycle\n");
}

TEST(MachineFaultsKeys, RepeatedKeyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2",
                             "first_tool: 2\n"
                             "first_tool: 1")),
              "m:22: first_tool: got the same key twice, wanted each key once; remove one "
              "of the two\n");
}

TEST(MachineFaultsKeys, RepeatedNestedKeyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "unit: inch", "unit: inch, unit: mm")),
              "m:12: bodies[1].mesh.unit: got the same key twice, wanted each key once; "
              "remove one of the two\n");
}

TEST(MachineFaultsKeys, MissingKeyIsNamed) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small\n", "")),
              "m:1: name: got no such key, wanted a text; add the key\n");
}

TEST(MachineFaultsKeys, MissingNestedKeyIsNamed) {
    EXPECT_EQ(faults_of(with(kSmallMachine, ", unit: inch", "")),
              "m:12: bodies.slide.mesh.unit: got no such key, wanted one of mm, inch, m, "
              "um; add the key\n");
}

TEST(MachineFaultsKeys, KeyWithoutValueIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2", "first_tool:")),
              "m:21: first_tool: got nothing, wanted a whole number; or remove the key\n");
}

TEST(MachineFaultsKeys, MergeKeyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities: {", "capacities: {<<: {rechecks: 2}, ")),
              "m:34: capacities: got a merge key (<<), wanted the keys themselves; merge "
              "keys are refused\n");
}

TEST(MachineFaultsKeys, ListAsKeyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities: {", "capacities: {[1]: 2, ")),
              "m:34: capacities: got a key that is no word, wanted a key of the machine "
              "file\n");
}

TEST(MachineFaultsKeys, KeyOfTheOtherAxisKindIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "travel_deg: [-110, 30]", "travel_mm: [-110, 30]")),
              "m:6: axes.A.travel_mm: got an unknown key \"travel_mm\", wanted "
              "\"travel_deg\"? one of the keys known here: kind, slot, travel_deg, speed_deg_s, "
              "acceleration_deg_s2, jerk_deg_s3, stopping_deg_s2, position_error_deg, "
              "following_error_deg\n");
}

TEST(MachineFaultsForms, AliasAndAnchorAreRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "sample_us: 1000\n",
                             "sample_us: &t 1000\n"
                             "  frozen_samples: *t\n")),
              "m:30: can.sample_us: got an anchor (&), wanted a plain value; anchors and "
              "aliases are refused\n"
              "m:31: can.frozen_samples: got an alias (*), wanted the value itself; "
              "anchors and aliases are refused\n");
}

TEST(MachineFaultsForms, TagIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: !!str small")),
              "m:2: name: got a tag \"tag:yaml.org,2002:str\", wanted a plain value; tags "
              "are refused\n");
}

TEST(MachineFaultsForms, BareTagIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: ! small")),
              "m:2: name: got a tag \"!\", wanted a plain value; tags are refused\n");
}

TEST(MachineFaultsForms, SecondDocumentIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities:",
                             "---\n"
                             "capacities:")),
              "m:34: got a second document, wanted one document; remove the --- or ... "
              "before it\n");
}

TEST(MachineFaultsForms, DirectiveIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "version: 1\n",
                             "%YAML 1.2\n"
                             "---\n"
                             "version: 1\n")),
              "m:1: got a directive (%), wanted no line that starts with %; directives are "
              "refused\n");
}

TEST(MachineFaultsForms, ControlCharacterIsRefusedAndEscaped) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: sm\033[2Jall")),
              "m:2: got the control character \\x1b, wanted visible text; remove it\n");
}

TEST(MachineFaultsForms, WritingDirectionCannotBeTurned) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: sm\342\200\256all")),
              "m:2: got the control character \\u202e, wanted visible text; remove it\n");
}

TEST(MachineFaultsForms, EscapedControlCharacterIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: \"sm\\x1b[2Jall\"")),
              "m:2: name: got \"sm\\x1b[2Jall\", wanted one line of text, not blank, at "
              "most 128 bytes\n");
}

TEST(MachineFaultsForms, BrokenUtf8IsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: small", "name: sm\377all")),
              "m:2: got the byte \\xff which is not UTF-8, wanted UTF-8 text; save the "
              "file in that encoding\n");
}

TEST(MachineFaultsForms, UnbalancedBracketIsReportedWithItsLine) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "capacities: {", "capacities: {[")),
              "m:34: got no valid YAML (illegal flow end), wanted YAML; is the file cut "
              "off, or a bracket, quote or indent missing here or above?\n");
}

TEST(MachineFaultsForms, ListInPlaceOfAMapIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine,
                       "capacities: {node_pairs: 8192, triangle_pairs: 65536, rechecks: 1024}",
                       "capacities: [1]")),
        "m:34: capacities: got a list of 1, wanted a map with the keys node_pairs, "
        "triangle_pairs, rechecks, batch\n");
}

TEST(MachineFaultsForms, TextInPlaceOfAListIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "data_ids: [0x0181, 641]", "data_ids: 641")),
              "m:32: can.data_ids: got \"641\", wanted a list of 2, one for each frame of "
              "axis positions, as [0x181, 0x281, 0x381]\n");
}

TEST(MachineFaultsNumbers, NanIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: .nan")),
              "m:19: tools.1.length_mm: got \".nan\", wanted a number from 0 to 100000, as "
              "12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, InfinityIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: .inf")),
              "m:19: tools.1.length_mm: got \".inf\", wanted a number from 0 to 100000, as "
              "12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, OctalIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 050")),
              "m:19: tools.1.length_mm: got \"050\", wanted a number from 0 to 100000, as "
              "12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, HexIsRefusedOutsideIdentifiers) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 0x32")),
              "m:19: tools.1.length_mm: got \"0x32\", wanted a number from 0 to 100000, as "
              "12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, LeadingPlusIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: +50")),
              "m:19: tools.1.length_mm: got \"+50\", wanted a number from 0 to 100000, as "
              "12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, UnitInAValueIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 50 mm")),
              "m:19: tools.1.length_mm: got \"50 mm\", wanted a number from 0 to 100000, "
              "as 12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, LocaleCommaIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: \"50,5\"")),
              "m:19: tools.1.length_mm: got \"50,5\" in quotes, wanted a number from 0 to "
              "100000, without quotes\n");
}

TEST(MachineFaultsNumbers, UnderscoreIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 5_0")),
              "m:19: tools.1.length_mm: got \"5_0\", wanted a number from 0 to 100000, as "
              "12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, QuotedNumberIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: \"50\"")),
              "m:19: tools.1.length_mm: got \"50\" in quotes, wanted a number from 0 to "
              "100000, without quotes\n");
}

TEST(MachineFaultsNumbers, BareFractionIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: .5")),
              "m:19: tools.1.length_mm: got \".5\", wanted a number from 0 to 100000, as "
              "12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, HugeIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 1e999")),
              "m:19: tools.1.length_mm: got \"1e999\", wanted a number from 0 to 100000, "
              "as 12, -0.5 or 1.5e-3: a decimal point, no unit, no other form\n");
}

TEST(MachineFaultsNumbers, OutOfRangeIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "length_mm: 50", "length_mm: 100000.1")),
              "m:19: tools.1.length_mm: got \"100000.1\", wanted a number from 0 to "
              "100000\n");
}

TEST(MachineFaultsNumbers, FractionOfAWholeNumberIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "number: 1,", "number: 1.0,")),
              "m:19: tools[0].number: got \"1.0\", wanted a whole number from 1 to 65535, "
              "digits only\n");
}

TEST(MachineFaultsNumbers, NegativeWholeNumberIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2", "first_tool: -2")),
              "m:21: first_tool: got \"-2\", wanted a whole number from 0 to 65535, digits "
              "only\n");
}

TEST(MachineFaultsNumbers, WordForASwitchIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "tool: true", "tool: yes")),
              "m:17: bodies.cutter.tool: got \"yes\", wanted one of false, true\n");
}

TEST(MachineFaultsNumbers, TwoNumbersWhereThreeBelongAreRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "direction: [0, 0, 1]", "direction: [0, 1]")),
              "m:15: bodies.plate.direction: got a list of 2, wanted a list of 3 numbers, "
              "as [0, 0, 0]\n");
}

}  // namespace
}  // namespace axg::test
