// SPDX-License-Identifier: Apache-2.0
// Faults in what a machine file says: axes, bodies, tools, pairs.
// Each test breaks one thing of a sound file and expects every word of the answer, its line
// included.
#include <gtest/gtest.h>

#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

TEST(MachineFaultsAxes, SwappedTravelIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[-300, 300]", "[300, -300]")),
              "m:4: axes.X.travel_mm: got [300, -300], wanted two positions, low then "
              "high; are they swapped?\n");
}

TEST(MachineFaultsAxes, EmptyTravelIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[-300, 300]", "[300, 300]")),
              "m:4: axes.X.travel_mm: got [300, 300], wanted two positions, low then high; "
              "are they swapped?\n");
}

TEST(MachineFaultsAxes, UnlimitedLinearAxisIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "travel_mm: [-300, 300]", "travel_mm: unlimited")),
              "m:4: axes.X.travel_mm: got \"unlimited\", wanted a list of 2 numbers, as "
              "[-300, 300]\n");
}

TEST(MachineFaultsAxes, ZeroSpeedIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "speed_mm_min: 10000", "speed_mm_min: 0")),
              "m:4: axes.X.speed_mm_min: got \"0\", wanted a number from 0.001 to 1000000\n");
}

TEST(MachineFaultsAxes, UnknownKindIsRefusedAlone) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "kind: linear", "kind: lineal")),
              "m:4: axes.X.kind: got \"lineal\", wanted \"linear\"? one of linear, rotary\n");
}

TEST(MachineFaultsAxes, SmallLetterIsNoAxisName) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "  X: {", "  x: {")),
              "m:4: axes.x: got the axis name \"x\", wanted a capital letter A-Z, more "
              "capitals or digits behind it (at most 8)\n"
              "m:4: axes.x: got an axis that moves no body, wanted at least one body with "
              "axis: x\n"
              "m:12: bodies.slide.axis: got \"X\", wanted \"x\"? the name of an axis of "
              "this file: x, A, C\n");
}

TEST(MachineFaultsAxes, AxisThatMovesNothingIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, ", axis: X, direction: [1, 0, 0]", "")),
              "m:4: axes.X: got an axis that moves no body, wanted at least one body with "
              "axis: X\n");
}

TEST(MachineFaultsAxes, TravelThatTheFramesCannotSayIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[-300, 300]", "[-8388.7, 300]")),
              "m:4: axes.X.travel_mm: got travel beyond what the CAN frames can say, "
              "wanted at most 8388.607 mm either way, or can: {format: fd}\n");
}

TEST(MachineFaultsBodies, RepeatedNameIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: plate", "name: cradle")),
              "m:15: bodies.cradle.name: got \"cradle\", the name of the body on line 13, "
              "wanted a name that no other body has\n"
              "m:23: pairs[0].b[3]: got \"plate\", wanted the name of a body of this file: "
              "base, slide, cradle, cradle, cutter\n"
              "m:25: exclusions[0].b[2]: got \"plate\", wanted the name of a body of this "
              "file: base, slide, cradle, cradle, cutter\n"
              "m:26: exclusions[1].b[1]: got \"plate\", wanted the name of a body of this "
              "file: base, slide, cradle, cradle, cutter\n"
              "m:27: exclusions[2].b: got \"plate\", wanted the name of a body of this "
              "file: base, slide, cradle, cradle, cutter\n");
}

TEST(MachineFaultsBodies, NameWithASpaceIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: plate", "name: the plate")),
              "m:15: bodies[3].name: got \"the plate\", wanted a name of at most 64 "
              "letters a-z, A-Z, digits, _ - and ., a letter or digit first\n"
              "m:23: pairs[0].b[3]: got \"plate\", wanted the name of a body of this file: "
              "base, slide, cradle, cutter\n"
              "m:25: exclusions[0].b[2]: got \"plate\", wanted the name of a body of this "
              "file: base, slide, cradle, cutter\n"
              "m:26: exclusions[1].b[1]: got \"plate\", wanted the name of a body of this "
              "file: base, slide, cradle, cutter\n"
              "m:27: exclusions[2].b: got \"plate\", wanted the name of a body of this "
              "file: base, slide, cradle, cutter\n");
}

TEST(MachineFaultsBodies, ParentBelowIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: slide,", "name: slide, parent: plate,")),
              "m:12: bodies.slide.parent: got \"plate\", which stands on line 15 and not "
              "above, wanted a body listed before this one: parents stand before their "
              "children\n");
}

TEST(MachineFaultsBodies, OwnParentIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "name: slide,", "name: slide, parent: slide,")),
              "m:12: bodies.slide.parent: got \"slide\", which stands on line 12 and not "
              "above, wanted a body listed before this one: parents stand before their "
              "children\n");
}

TEST(MachineFaultsBodies, UnknownParentGetsTheNearestName) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "parent: slide", "parent: slid")),
              "m:13: bodies.cradle.parent: got \"slid\", wanted \"slide\"? the name of a "
              "body of this file: base, slide; without parent the machine's frame carries "
              "the body\n");
}

TEST(MachineFaultsBodies, UnknownAxisIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "axis: C", "axis: B")),
              "m:8: axes.C: got an axis that moves no body, wanted at least one body with "
              "axis: C\n"
              "m:15: bodies.plate.axis: got \"B\", wanted the name of an axis of this "
              "file: X, A, C\n");
}

TEST(MachineFaultsBodies, SlantedDirectionIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "direction: [0, 0, 1]", "direction: [0, 0.1, 1]")),
              "m:15: bodies.plate.direction: got a direction of length 1.004987562112089, "
              "wanted a unit vector to 1e-6, as [0, 0, 1]; write more digits if it is "
              "slanted\n");
}

TEST(MachineFaultsBodies, RotaryAxisNeedsAPivot) {
    EXPECT_EQ(faults_of(with(kSmallMachine, ", pivot_mm: [0, 0, 0]", "")),
              "m:15: bodies.plate.pivot_mm: got no such key, wanted a list of 3 numbers; "
              "add the key\n");
}

TEST(MachineFaultsBodies, PivotOnALinearAxisIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "direction: [1, 0, 0], mesh",
                             "direction: [1, 0, 0], pivot_mm: [0, 0, 0], mesh")),
              "m:12: bodies.slide.pivot_mm: got a pivot on the linear axis X, wanted no "
              "such key here; only a rotary axis has a pivot\n");
}

TEST(MachineFaultsBodies, DirectionWithoutAxisIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "{name: base,", "{name: base, direction: [1, 0, 0],")),
              "m:11: bodies.base.direction: got direction without an axis, wanted the key "
              "axis as well, or a fixed body without this key\n");
}

TEST(MachineFaultsBodies, SecondToolBodyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "- {name: base, mesh: {file: base.stl, unit: mm}}",
                             "- {name: base, tool: true}")),
              "m:17: bodies.cutter.tool: got a second tool body after base, wanted one "
              "body with tool: true at most\n");
}

TEST(MachineFaultsBodies, MeshOnTheToolBodyIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "tool: true}", "tool: true, mesh: {file: a.stl, unit: mm}}")),
        "m:17: bodies.cutter.mesh: got a mesh on the tool body, wanted no mesh here: "
        "its surface is the tool in the spindle, listed under tools\n");
}

TEST(MachineFaultsBodies, MeshAboveTheFolderIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "file: base.stl", "file: a/../../base.stl")),
              "m:11: bodies.base.mesh.file: got \"a/../../base.stl\", wanted a file below "
              "the machine file's folder (or --mesh-root): no .. , no \\ and no / in "
              "front\n");
}

TEST(MachineFaultsBodies, AbsoluteMeshIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "file: base.stl", "file: /etc/passwd")),
              "m:11: bodies.base.mesh.file: got \"/etc/passwd\", wanted a file below the "
              "machine file's folder (or --mesh-root): no .. , no \\ and no / in front\n");
}

TEST(MachineFaultsBodies, UnknownUnitIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "unit: inch", "unit: in")),
              "m:12: bodies.slide.mesh.unit: got \"in\", wanted one of mm, inch, m, um\n");
}

TEST(MachineFaultsBodies, ShortHashIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "unit: inch", "unit: inch, sha256: abc123")),
              "m:12: bodies.slide.mesh.sha256: got \"abc123\", wanted 64 hexadecimal "
              "digits, as sha256sum prints them for the file\n");
}

TEST(MachineFaultsTools, RepeatedNumberIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "number: 2", "number: 1")),
              "m:20: tools.1.number: got 1, the number of the tool on line 19, wanted a "
              "number that no other tool has\n"
              "m:21: first_tool: got 2, wanted the number of a tool listed under tools, or "
              "0 for an empty spindle\n");
}

TEST(MachineFaultsTools, FirstToolMustExist) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2", "first_tool: 3")),
              "m:21: first_tool: got 3, wanted the number of a tool listed under tools, or "
              "0 for an empty spindle\n");
}

TEST(MachineFaultsTools, ToolBodyNeedsTools) {
    EXPECT_EQ(faults_of(with(
                  kSmallMachine,
                  "tools:\n"
                  "  - {number: 1, name: ball nose, length_mm: 50, mesh: {file: tool.stl, "
                  "unit: mm}}\n"
                  "  - {number: 2, length_mm: 90, profile_mm: [[0, -90], [4, -86], [4, 0], [0, "
                  "0]], segments: 24}\n"
                  "first_tool: 2\n",
                  "")),
              "m:1: tools: got no such key, wanted a list of 1 to 64 tools, as a body says "
              "tool: true; add the key\n");
}

TEST(MachineFaultsTools, ToolsNeedAToolBody) {
    EXPECT_EQ(faults_of(with(kSmallMachine, ", tool: true}", ", mesh: {file: c.stl, unit: mm}}")),
              "m:18: tools: got tools, but no body that carries them, wanted a body with "
              "tool: true, or no tools\n");
}

TEST(MachineFaultsTools, ProfileMustEndOnTheAxis) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[4, 0], [0, 0]]", "[4, 0], [1, 0]]")),
              "m:20: tools.2.profile_mm[3]: got the radius 1, wanted 0 at the first and "
              "the last point: the profile ends on the axis\n");
}

TEST(MachineFaultsTools, NegativeRadiusIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[4, -86]", "[-4, -86]")),
              "m:20: tools.2.profile_mm[1]: got the radius -4, wanted a radius of 0 or "
              "more\n");
}

TEST(MachineFaultsTools, MeshAndProfileExcludeEachOther) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "segments: 24",
                             "segments: 24, mesh: {file: a.stl, unit: mm}")),
              "m:20: tools.2: got mesh and profile_mm, wanted one of mesh, profile_mm and "
              "sections, for the tool's surface\n");
}

TEST(MachineFaultsTools, NeitherMeshNorProfileIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, ", mesh: {file: tool.stl, unit: mm}", "")),
              "m:19: tools.1: got none of mesh, profile_mm and sections, wanted one of mesh, "
              "profile_mm and sections, for the tool's surface\n");
}

TEST(MachineFaultsTools, NumberOverAByteNeedsAnotherFormat) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "number: 1,", "number: 256,")),
              "m:19: tools.256.number: got 256 with can format classical, wanted at most "
              "255: the frame has one byte for it; or format: fd\n");
}

TEST(MachineFaultsPairs, ForgottenPairIsNamed) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "b: [slide, cradle, plate], reason: too",
                             "b: [slide, plate], reason: too")),
              "m:22: pairs: got no word on base against cradle, wanted every pair of "
              "bodies in pairs or, with its reason, in exclusions\n");
}

TEST(MachineFaultsPairs, PairNamedTwiceIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "b: [slide, cradle, plate], reason: too",
                             "b: [slide, cradle, plate, cutter], reason: too")),
              "m:25: exclusions[0]: got the pair of base and cutter, named on line 23 "
              "already, wanted each pair once, in pairs or in exclusions\n");
}

TEST(MachineFaultsPairs, BodyAgainstItselfIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "{a: cradle, b: plate,", "{a: cradle, b: [plate, cradle],")),
        "m:27: exclusions[2]: got the body cradle against itself, wanted two bodies\n");
}

TEST(MachineFaultsPairs, UnknownBodyIsReportedOnce) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "b: [slide, cradle, plate], reason: too",
                             "b: [slide, cradel, plate], reason: too")),
              "m:25: exclusions[0].b[1]: got \"cradel\", wanted \"cradle\"? the name of a "
              "body of this file: base, slide, cradle, plate, cutter\n");
}

TEST(MachineFaultsPairs, BlankReasonIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "reason: bearings", "reason: \" \"")),
              "m:26: exclusions[1].reason: got \" \", wanted one line of text, not blank, "
              "at most 512 bytes\n");
}

TEST(MachineFaultsPairs, NegativeMarginIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "margin_mm: 0.5", "margin_mm: -0.5")),
              "m:23: pairs[0].margin_mm: got \"-0.5\", wanted a number from 0 to 1000\n");
}

TEST(MachineFaultsPairs, PairOfABodyWithoutSurfaceIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "{name: base, mesh: {file: base.stl, unit: mm}}",
                             "{name: base}")),
              "m:23: pairs[0]: got the body base without a surface, wanted bodies with "
              "mesh or tool: true\n"
              "m:25: exclusions[0]: got the body base without a surface, wanted bodies "
              "with mesh or tool: true\n");
}

TEST(MachineFaultsPairs, NoPairAtAllIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine,
                             "\n"
                             "  - {a: cutter, b: [base, slide, cradle, plate], margin_mm: 0.5}",
                             " []")),
              "m:22: pairs: got an empty list, wanted at least one pair: else there is "
              "nothing to guard\n"
              "m:22: pairs: got no word on base against cutter, wanted every pair of "
              "bodies in pairs or, with its reason, in exclusions\n"
              "m:22: pairs: got no word on slide against cutter, wanted every pair of "
              "bodies in pairs or, with its reason, in exclusions\n"
              "m:22: pairs: got no word on cradle against cutter, wanted every pair of "
              "bodies in pairs or, with its reason, in exclusions\n"
              "m:22: pairs: got no word on plate against cutter, wanted every pair of "
              "bodies in pairs or, with its reason, in exclusions\n");
}

}  // namespace
}  // namespace axg::test
