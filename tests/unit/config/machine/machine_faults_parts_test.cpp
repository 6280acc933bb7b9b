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
              "m:4: axes.X.travel_mm: invalid value (found [300, -300], expected two positions, "
              "low then high). Swap the two.\n");
}

TEST(MachineFaultsAxes, EmptyTravelIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[-300, 300]", "[300, 300]")),
              "m:4: axes.X.travel_mm: invalid value (found [300, 300], expected two positions, low "
              "then high). Swap the two.\n");
}

TEST(MachineFaultsAxes, UnlimitedLinearAxisIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "travel_mm: [-300, 300]", "travel_mm: unlimited")),
              "m:4: axes.X.travel_mm: invalid value (found \"unlimited\", expected a list of 2 "
              "numbers, such as [-300, 300]).\n");
}

TEST(MachineFaultsAxes, ZeroSpeedIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "speed_mm_min: 10000", "speed_mm_min: 0")),
              "m:4: axes.X.speed_mm_min: invalid value (found \"0\", expected a number from 0.001 "
              "to 1000000).\n");
}

TEST(MachineFaultsBodies, ErrorsOfAJointNeedTheJoint) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "direction: [1, 0, 0], mesh: {file: slide",
                             "direction: [1, 0, 0], pivot_error_mm: 1, mesh: {file: slide")),
              "m:12: bodies.slide.pivot_error_mm: invalid value (found a pivot on the linear axis "
              "X, expected no such key). Only a rotary axis has a pivot.\n");
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "{name: base, ", "{name: base, direction_error_deg: 0.1, ")),
        "m:11: bodies.base.direction_error_deg: invalid value (found direction_error_deg "
        "without an axis, expected the key axis too, or a fixed body without this key).\n");
    EXPECT_EQ(faults_of(with(kSmallMachine, "{name: base, ", "{name: base, place_error_mm: -1, ")),
              "m:11: bodies.base.place_error_mm: invalid value (found \"-1\", expected a number "
              "from 0 to 1).\n");
}

TEST(MachineFaultsAxes, UnknownKindIsRefusedAlone) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "kind: linear", "kind: lineal")),
              "m:4: axes.X.kind: invalid value (found \"lineal\", expected one of linear, rotary). "
              "Did you mean \"linear\"?\n");
}

TEST(MachineFaultsAxes, SmallLetterIsNoAxisName) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "  X: {", "  x: {")),
              "m:4: axes.x: invalid value (found the axis name \"x\", expected a capital letter "
              "A-Z, then capitals or digits (at most 8 characters)).\nm:4: axes.x: invalid value "
              "(found an axis that moves no body, expected at least one body with axis: x).\nm:12: "
              "bodies.slide.axis: invalid value (found \"X\", expected the name of an axis of this "
              "file: x, A, C). Did you mean \"x\"?\n");
}

TEST(MachineFaultsAxes, AxisThatMovesNothingIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, ", axis: X, direction: [1, 0, 0]", "")),
              "m:4: axes.X: invalid value (found an axis that moves no body, expected at least one "
              "body with axis: X).\n");
}

TEST(MachineFaultsAxes, TravelThatTheFramesCannotSayIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[-300, 300]", "[-8388.7, 300]")),
              "m:4: axes.X.travel_mm: invalid value (found travel beyond the range of the CAN "
              "frames, expected at most 8388.607 mm either way, or can: {format: fd}).\n");
}

TEST(MachineFaultsBodies, RepeatedNameIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "name: plate", "name: cradle")),
        "m:15: bodies.cradle.name: invalid value (found \"cradle\", the name of the body on line "
        "13, expected a name that no other body has).\nm:23: pairs[0].b[3]: invalid value (found "
        "\"plate\", expected the name of a body of this file: base, slide, cradle, cradle, "
        "cutter).\nm:25: exclusions[0].b[2]: invalid value (found \"plate\", expected the name of "
        "a body of this file: base, slide, cradle, cradle, cutter).\nm:26: exclusions[1].b[1]: "
        "invalid value (found \"plate\", expected the name of a body of this file: base, slide, "
        "cradle, cradle, cutter).\nm:27: exclusions[2].b: invalid value (found \"plate\", expected "
        "the name of a body of this file: base, slide, cradle, cradle, cutter).\n");
}

TEST(MachineFaultsBodies, NameWithASpaceIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "name: plate", "name: the plate")),
        "m:15: bodies[3].name: invalid value (found \"the plate\", expected a name of at most 64 "
        "letters a-z, A-Z, digits, _ - and ., a letter or digit first).\nm:23: pairs[0].b[3]: "
        "invalid value (found \"plate\", expected the name of a body of this file: base, slide, "
        "cradle, cutter).\nm:25: exclusions[0].b[2]: invalid value (found \"plate\", expected the "
        "name of a body of this file: base, slide, cradle, cutter).\nm:26: exclusions[1].b[1]: "
        "invalid value (found \"plate\", expected the name of a body of this file: base, slide, "
        "cradle, cutter).\nm:27: exclusions[2].b: invalid value (found \"plate\", expected the "
        "name of a body of this file: base, slide, cradle, cutter).\n");
}

TEST(MachineFaultsBodies, ParentBelowIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "name: slide,", "name: slide, parent: plate,")),
        "m:12: bodies.slide.parent: invalid value (found \"plate\", which is on line 15 and not "
        "above, expected a body listed before this one). List parents before their children.\n");
}

TEST(MachineFaultsBodies, OwnParentIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "name: slide,", "name: slide, parent: slide,")),
        "m:12: bodies.slide.parent: invalid value (found \"slide\", which is on line 12 and not "
        "above, expected a body listed before this one). List parents before their children.\n");
}

TEST(MachineFaultsBodies, UnknownParentGetsTheNearestName) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "parent: slide", "parent: slid")),
              "m:13: bodies.cradle.parent: invalid value (found \"slid\", expected no parent, for "
              "the machine's frame, or the name of a body of this file: base, slide). Did you mean "
              "\"slide\"?\n");
}

TEST(MachineFaultsBodies, UnknownAxisIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "axis: C", "axis: B")),
              "m:8: axes.C: invalid value (found an axis that moves no body, expected at least one "
              "body with axis: C).\nm:15: bodies.plate.axis: invalid value (found \"B\", expected "
              "the name of an axis of this file: X, A, C).\n");
}

TEST(MachineFaultsBodies, SlantedDirectionIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "direction: [0, 0, 1]", "direction: [0, 0.1, 1]")),
              "m:15: bodies.plate.direction: invalid value (found a direction of length "
              "1.004987562112089, expected a unit vector to 1e-6, such as [0, 0, 1]). Write more "
              "digits if it is slanted.\n");
}

TEST(MachineFaultsBodies, RotaryAxisNeedsAPivot) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, ", pivot_mm: [0, 0, 0]", "")),
        "m:15: bodies.plate.pivot_mm: missing required key (expected a list of 3 numbers).\n");
}

TEST(MachineFaultsBodies, PivotOnALinearAxisIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "direction: [1, 0, 0], mesh",
                             "direction: [1, 0, 0], pivot_mm: [0, 0, 0], mesh")),
              "m:12: bodies.slide.pivot_mm: invalid value (found a pivot on the linear axis X, "
              "expected no such key). Only a rotary axis has a pivot.\n");
}

TEST(MachineFaultsBodies, DirectionWithoutAxisIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "{name: base,", "{name: base, direction: [1, 0, 0],")),
              "m:11: bodies.base.direction: invalid value (found direction without an axis, "
              "expected the key axis too, or a fixed body without this key).\n");
}

TEST(MachineFaultsBodies, SecondToolBodyIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "- {name: base, mesh: {file: base.stl, unit: mm}}",
                             "- {name: base, tool: true}")),
              "m:17: bodies.cutter.tool: invalid value (found a second tool body after base, "
              "expected one body with tool: true at most).\n");
}

TEST(MachineFaultsBodies, MeshOnTheToolBodyIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "tool: true}", "tool: true, mesh: {file: a.stl, unit: mm}}")),
        "m:17: bodies.cutter.mesh: invalid value (found a mesh on the tool body, expected no "
        "mesh). Its surface is that of the tool in the spindle, listed under tools.\n");
}

TEST(MachineFaultsBodies, MeshAboveTheFolderIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "file: base.stl", "file: a/../../base.stl")),
        "m:11: bodies.base.mesh.file: invalid value (found \"a/../../base.stl\", expected a path "
        "below the machine file's folder (or --mesh-root), without .., \\ or a leading /).\n");
}

TEST(MachineFaultsBodies, AbsoluteMeshIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "file: base.stl", "file: /etc/passwd")),
        "m:11: bodies.base.mesh.file: invalid value (found \"/etc/passwd\", expected a path below "
        "the machine file's folder (or --mesh-root), without .., \\ or a leading /).\n");
}

TEST(MachineFaultsBodies, UnknownUnitIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "unit: inch", "unit: in")),
              "m:12: bodies.slide.mesh.unit: invalid value (found \"in\", expected one of mm, "
              "inch, m, um).\n");
}

TEST(MachineFaultsBodies, ShortHashIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "unit: inch", "unit: inch, sha256: abc123")),
              "m:12: bodies.slide.mesh.sha256: invalid value (found \"abc123\", expected 64 "
              "hexadecimal digits, as sha256sum prints them for the file).\n");
}

TEST(MachineFaultsTools, RepeatedNumberIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "number: 2", "number: 1")),
              "m:20: tools.1.number: invalid value (found 1, the number of the tool on line 19, "
              "expected a number that no other tool has).\nm:21: first_tool: invalid value (found "
              "2, expected the number of a tool listed under tools, or 0 for an empty spindle).\n");
}

TEST(MachineFaultsTools, FirstToolMustExist) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "first_tool: 2", "first_tool: 3")),
              "m:21: first_tool: invalid value (found 3, expected the number of a tool listed "
              "under tools, or 0 for an empty spindle).\n");
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
              "m:1: tools: missing required key (expected a list of 1 to 64 tools, because a body "
              "has tool: true).\n");
}

TEST(MachineFaultsTools, ToolsNeedAToolBody) {
    EXPECT_EQ(faults_of(with(kSmallMachine, ", tool: true}", ", mesh: {file: c.stl, unit: mm}}")),
              "m:18: tools: invalid value (found tools, but no body that carries them, expected a "
              "body with tool: true, or no tools).\n");
}

TEST(MachineFaultsTools, ProfileMustEndOnTheAxis) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[4, 0], [0, 0]]", "[4, 0], [1, 0]]")),
              "m:20: tools.2.profile_mm[3]: invalid value (found the radius 1, expected 0 at the "
              "first and the last point). The profile ends on the axis.\n");
}

TEST(MachineFaultsTools, NegativeRadiusIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "[4, -86]", "[-4, -86]")),
              "m:20: tools.2.profile_mm[1]: invalid value (found the radius -4, expected a radius "
              "of 0 or more).\n");
}

TEST(MachineFaultsTools, MeshAndProfileExcludeEachOther) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "segments: 24",
                             "segments: 24, mesh: {file: a.stl, unit: mm}")),
              "m:20: tools.2: invalid value (found mesh and profile_mm, expected one of mesh, "
              "profile_mm and sections, for the tool's surface).\n");
}

TEST(MachineFaultsTools, NeitherMeshNorProfileIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, ", mesh: {file: tool.stl, unit: mm}", "")),
              "m:19: tools.1: invalid value (found none of mesh, profile_mm and sections, expected "
              "one of mesh, profile_mm and sections, for the tool's surface).\n");
}

TEST(MachineFaultsTools, NumberOverAByteNeedsAnotherFormat) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "number: 1,", "number: 256,")),
              "m:19: tools.256.number: invalid value (found 256 with can format classical, "
              "expected at most 255, or format: fd). The classical frame has one byte for it.\n");
}

TEST(MachineFaultsPairs, ForgottenPairIsNamed) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "b: [slide, cradle, plate], reason: too",
                             "b: [slide, plate], reason: too")),
              "m:22: pairs: invalid value (found no entry for base and cradle, expected every pair "
              "of bodies in pairs or, with its reason, in exclusions).\n");
}

TEST(MachineFaultsPairs, PairNamedTwiceIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "b: [slide, cradle, plate], reason: too",
                             "b: [slide, cradle, plate, cutter], reason: too")),
              "m:25: exclusions[0]: invalid value (found the pair of base and cutter, listed on "
              "line 23 already, expected each pair once, in pairs or in exclusions).\n");
}

TEST(MachineFaultsPairs, BodyAgainstItselfIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "{a: cradle, b: plate,", "{a: cradle, b: [plate, cradle],")),
        "m:27: exclusions[2]: invalid value (found the body cradle against itself, expected two "
        "bodies).\n");
}

TEST(MachineFaultsPairs, UnknownBodyIsReportedOnce) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "b: [slide, cradle, plate], reason: too",
                             "b: [slide, cradel, plate], reason: too")),
              "m:25: exclusions[0].b[1]: invalid value (found \"cradel\", expected the name of a "
              "body of this file: base, slide, cradle, plate, cutter). Did you mean \"cradle\"?\n");
}

TEST(MachineFaultsPairs, BlankReasonIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "reason: bearings", "reason: \" \"")),
              "m:26: exclusions[1].reason: invalid value (found \" \", expected one line of text, "
              "not blank, at most 512 bytes).\n");
}

TEST(MachineFaultsPairs, NegativeMarginIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "margin_mm: 0.5", "margin_mm: -0.5")),
              "m:23: pairs[0].margin_mm: invalid value (found \"-0.5\", expected a number from 0 "
              "to 1000).\n");
}

TEST(MachineFaultsPairs, PairOfABodyWithoutSurfaceIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "{name: base, mesh: {file: base.stl, unit: mm}}",
                             "{name: base}")),
              "m:23: pairs[0]: invalid value (found the body base without a surface, expected "
              "bodies with mesh or tool: true).\nm:25: exclusions[0]: invalid value (found the "
              "body base without a surface, expected bodies with mesh or tool: true).\n");
}

TEST(MachineFaultsPairs, NoPairAtAllIsRefused) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine,
                       "\n"
                       "  - {a: cutter, b: [base, slide, cradle, plate], margin_mm: 0.5}",
                       " []")),
        "m:22: pairs: invalid value (found an empty list, expected at least one pair).\nm:22: "
        "pairs: invalid value (found no entry for base and cutter, expected every pair of bodies "
        "in pairs or, with its reason, in exclusions).\nm:22: pairs: invalid value (found no entry "
        "for slide and cutter, expected every pair of bodies in pairs or, with its reason, in "
        "exclusions).\nm:22: pairs: invalid value (found no entry for cradle and cutter, expected "
        "every pair of bodies in pairs or, with its reason, in exclusions).\nm:22: pairs: invalid "
        "value (found no entry for plate and cutter, expected every pair of bodies in pairs or, "
        "with its reason, in exclusions).\n");
}

}  // namespace
}  // namespace axg::test
