// SPDX-License-Identifier: Apache-2.0
// The same program on the same machine, once through our own frames, once through those that a DBC
// file describes and once through the process data of drives: simulated, written, read and judged
// by the program itself, all three end with the same verdict at the same sample.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>

#include "firmware_if/cli/exit_codes.hpp"
#include "tests/support/json_value.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

using test::Json;

// Counts of 1 um and 0.0001 degrees, as in our classical frames: equal positions, equal verdicts.
constexpr const char* kDbc = R"(VERSION ""
BU_: Board Guard
BO_ 385 Linear: 8 Board
 SG_ X : 0|24@1- (0.001,0) [0|0] "mm" Guard
 SG_ Y : 31|24@0- (0.001,0) [0|0] "mm" Guard
 SG_ Tool : 48|8@1+ (1,0) [0|0] "" Guard
 SG_ State : 56|2@1+ (1,0) [0|0] "" Guard
 SG_ Counter : 58|4@1+ (1,0) [0|14] "" Guard
 SG_ Homed : 62|1@1+ (1,0) [0|0] "" Guard
BO_ 386 Rest: 12 Board
 SG_ Page M : 0|8@1+ (1,0) [0|0] "" Guard
 SG_ Z m1 : 8|32@1- (1,0) [0|0] "um" Guard
 SG_ A m2 : 8|32@1- (0.0001,0) [0|0] "deg" Guard
 SG_ C m3 : 8|32@1+ (0.0001,0) [0|0] "deg" Guard
)";
constexpr const char* kDbcSection = R"(
can:
  format: dbc
  file: board.dbc
  axes: {X: Linear.X, Y: Linear.Y, Z: Rest.Z, A: Rest.A, C: Rest.C}
  status: {tool: Linear.Tool, moving: {signal: Linear.State, is: 1},
           tool_change: {signal: Linear.State, is: 2}, homed: Linear.Homed}
  counters: [Linear.Counter]
)";
constexpr const char* kDriveSection = R"(
can:
  format: cia402
  sync_counter: 240
  latched_age_us: 0
  drives:
    X: {pdos: [{cob_id: 0x183, map: [0x60410010, 0x60640020]}],
        counts: 1000, per_mm: 1, absolute: true}
    Y: {pdos: [{cob_id: 0x184, map: [0x60410010, 0x60640020]}],
        counts: 1000, per_mm: 1, homed_bit: 8}
    Z: {pdos: [{cob_id: 0x185, map: [0x60410010, 0x60640020]}],
        counts: 1000, per_mm: 1, absolute: true}
    A: {pdos: [{cob_id: 0x186, map: [0x60410010]}, {cob_id: 0x286, map: [0x60640020, 0x606C0020]}],
        counts: 10000, per_deg: 1, absolute: true, velocity: {counts: 1000, per_deg_s: 1}}
    C: {pdos: [{cob_id: 0x187, map: [0x60410010, 0x60640020]}], counts: 10000, per_deg: 1,
        range_counts: 3600000, absolute: true}
)";

/// Without its section `can`, the last one. Frames that are not ours do not say which axis may jog.
std::string without_can(std::string machine) {
    machine.erase(machine.find("\ncan:") + 1);
    const std::size_t line = machine.find("  single_jog:");
    return line == std::string::npos ? machine
                                     : machine.erase(line, machine.find('\n', line) - line + 1);
}

class ForeignFrames : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(AXG_PROGRAM)) {
            GTEST_SKIP() << AXG_PROGRAM << " is not built";
        }
    }
    /// What replay says of the demo program through the frames of this section.
    Json judged(const std::string& name, const std::string& section, const std::string& mode) {
        (void)shop.write(name + ".yaml", without_can(test::content_of(paper)) + section);
        const std::string machine = name + ".yaml --mesh-root " + folder + " ";
        EXPECT_EQ(
            shop.run("simulate " + name + ".yaml " + test::kDemoProgram + " -o " + name + ".log"),
            kExitClean)
            << shop.err;
        EXPECT_EQ(shop.run("replay " + machine + name + ".log --mode " + mode +
                           " --deadline-us 10000000 --json"),
                  kExitCollision)
            << shop.err;
        return Json::parse(shop.out);
    }
    test::Workshop shop;
    std::string folder = std::string(AXG_SOURCE_DIR) + "/config/machines";
    std::string paper = folder + "/paper-trunnion.yaml";
};

/// With Linear and Rest under identifiers of 29 bits, one with a number of 11 bits too; Z is under
/// several values, and C in a page of a page.
std::string extended_dbc() {
    std::string text = kDbc;
    text.replace(text.find("BO_ 385"), 7, "BO_ 2566848897");  // 0x80000000 + 0x18FF0181
    text.replace(text.find("BO_ 386"), 7, "BO_ 2147484033");  // 0x80000000 + 0x181
    text.replace(text.find("m3 : 8|32"), 9, "m4 : 48|32");
    return text +
           " SG_ Sub m3M : 40|8@1+ (1,0) [0|0] \"\" Guard\n"
           "SG_MUL_VAL_ 2147484033 Z Page 1-1, 5-7;\nSG_MUL_VAL_ 2147484033 A Page 2-2;\n"
           "SG_MUL_VAL_ 2147484033 Sub Page 3-3;\nSG_MUL_VAL_ 2147484033 C Sub 4-9;\n";
}
std::string extended_drives() {
    std::string text = kDriveSection;
    text.replace(text.find("0x183"), 5, "0x38FF0183");
    text.replace(text.find("0x187"), 5, "0x20000183");
    return text;
}

TEST_P(ForeignFrames, EndWithTheVerdictOfOurOwn) {
    (void)shop.write("board.dbc", kDbc);
    (void)shop.write("extended.dbc", extended_dbc());
    std::string extended = kDbcSection;
    extended.replace(extended.find("board.dbc"), 9, "extended.dbc");
    const Json ours = judged("ours", "", GetParam());
    for (const auto& [name, section] :
         {std::pair{"dbc", std::string{kDbcSection}},
          std::pair{"drives", std::string{kDriveSection}}, std::pair{"dbc", extended},
          std::pair{"drives", extended_drives()}}) {
        const Json theirs = judged(name, section, GetParam());
        ASSERT_EQ(theirs["stop_count"], 1) << name;
        EXPECT_EQ(theirs["samples_lost"], 0) << name;
        const bool is_extended = section.find("extended") != std::string::npos ||
                                 section.find("0x38FF0183") != std::string::npos;
        const std::string log = test::content_of(shop.file(std::string(name) + ".log"));
        EXPECT_EQ(log.find(" 18FF018") != std::string::npos, is_extended) << name;
        EXPECT_EQ(log.find(" 0000018") != std::string::npos, is_extended) << name;
        const Json& stop = theirs["stops"][0];
        const Json& wanted = ours["stops"][0];
        EXPECT_EQ(stop["reason"], wanted["reason"]) << name;
        EXPECT_EQ(stop["pair"], wanted["pair"]) << name;
        const bool is_contact = std::string(GetParam()) == "contact";
        EXPECT_EQ(theirs["obeyed_by"], "board");
        EXPECT_EQ(theirs.contains("not_obeyed"), std::string(name) == "dbc");
        if (is_contact) {
            EXPECT_EQ(stop["sample"], wanted["sample"]) << name;
        } else {
            EXPECT_LE(stop["sample"].get<int>(), wanted["sample"].get<int>()) << name;
        }
        // Without SYNC a sample is known to a period only, and its box is that much larger: the DBC
        // file's board is stopped far earlier. Drives have SYNC.
        if (!is_contact && std::string(name) == "drives") {
            EXPECT_GE(stop["sample"].get<int>(), wanted["sample"].get<int>() - 20) << name;
        }
    }
}

// The default of drives, any of which may answer with the value of the SYNC before: their samples
// say less of speed and acceleration, and what they certify begins a period earlier.
TEST_F(ForeignFrames, DrivesThatMayAnswerLateAreStoppedEarlier) {
    std::string late = kDriveSection;
    late.erase(late.find("  latched_age_us: 0\n"), 20);
    const Json stated = judged("drives", kDriveSection, "stoppable")["stops"][0];
    const Json unstated = judged("late", late, "stoppable")["stops"][0];
    EXPECT_EQ(unstated["reason"], stated["reason"]);
    EXPECT_LT(unstated["sample"].get<int>(), stated["sample"].get<int>());
}

INSTANTIATE_TEST_SUITE_P(Modes, ForeignFrames, testing::Values("contact", "stoppable"),
                         [](const auto& mode) { return std::string(mode.param); });

// A program without a stop: what is proven of it is only proven for a board that obeys.
TEST_F(ForeignFrames, WithoutACounterNothingIsProven) {
    std::string counted = kDriveSection;  // slower: six frames of drives fill a bus of 1 kHz
    counted.insert(counted.find("  sync_counter"), "  sample_us: 2000\n");
    std::string empty_sync = counted;
    empty_sync.erase(empty_sync.find("  sync_counter: 240\n"), 20);
    for (const auto& [name, section] :
         {std::pair{"counted", counted}, std::pair{"empty", empty_sync}}) {
        const bool is_obeyed = std::string(name) == "counted";
        (void)shop.write("m.yaml", without_can(test::content_of(paper)) + section);
        (void)shop.write("clear.ngc", "G1 X10 F1000\nM2\n");
        ASSERT_EQ(shop.run("simulate m.yaml clear.ngc -o m.log --mesh-root " + folder), kExitClean)
            << shop.err;
        const std::string replay =
            "replay m.yaml m.log --deadline-us 10000000 --mesh-root " + folder;
        ASSERT_EQ(shop.run(replay), kExitClean) << shop.err << shop.out;
        const auto is_said = [this](const char* words) {
            return shop.out.find(words) != std::string::npos;
        };
        EXPECT_EQ(is_said(" samples proven, "), is_obeyed) << shop.out;
        EXPECT_EQ(is_said("\nno stop: every checked pair keeps"), is_obeyed) << shop.out;
        EXPECT_EQ(is_said("\nno board can obey these permits: "), !is_obeyed) << shop.out;
        EXPECT_EQ(is_said("because no device obeys the permits"), !is_obeyed) << shop.out;
        (void)shop.run(replay + " --details");
        EXPECT_EQ(is_said("\nproven to standstill, "), is_obeyed) << shop.out;
        const std::string drive = "drive m.yaml clear.ngc --mesh-root " + folder;
        EXPECT_EQ(shop.run(drive), is_obeyed ? kExitClean : kExitCollision) << shop.err << shop.out;
        EXPECT_EQ(is_said("\nno board can obey these permits: "), !is_obeyed) << shop.out;
        EXPECT_EQ(is_said("no motion: "), !is_obeyed) << shop.out;
        (void)shop.run(drive + " --json");
        EXPECT_EQ(Json::parse(shop.out).contains("not_obeyed"), !is_obeyed);
        ASSERT_EQ(shop.run("check m.yaml --engine cpu --mesh-root " + folder), kExitClean);
        EXPECT_TRUE(is_said("\npermits: obeyed by the board (guard.obeyed_by)")) << shop.out;
        EXPECT_EQ(is_said("axguardd run rejects this machine: guard.obeyed_by: no board can"),
                  !is_obeyed)
            << shop.out;
    }
}

// SYNC in a trace is that of the guard that was recorded. The simulated board latches on that of
// the guard at the other end of its wire.
TEST_F(ForeignFrames, DrivesLatchOnTheSyncOfTheGuard) {
    std::string section = kDriveSection;
    section.replace(section.find("sync_counter: 240"), 17, "sync: guard\n  sample_us: 2000");
    std::string text = without_can(test::content_of(paper)) + section;
    text.insert(text.find("\nguard:\n") + 8, "  latch_jitter_us: 300\n");
    (void)shop.write("m.yaml", text);
    (void)shop.write("clear.ngc", "G1 X10 F1000\nM2\n");
    ASSERT_EQ(shop.run("simulate m.yaml clear.ngc -o m.log --mesh-root " + folder), kExitClean)
        << shop.err;
    ASSERT_EQ(shop.run("replay m.yaml m.log --json --deadline-us 10000000 --mesh-root " + folder),
              kExitClean)
        << shop.err << shop.out;
    const Json replay = Json::parse(shop.out);
    EXPECT_GT(replay["permits"].get<int>(), 300);
    EXPECT_FALSE(replay.contains("not_obeyed"));
    const std::string drive = " m.yaml clear.ngc --json --mesh-root " + folder;
    EXPECT_EQ(shop.run("drive" + drive), kExitClean) << shop.err << shop.out;
    EXPECT_EQ(Json::parse(shop.out)["state"], "finished") << shop.out;
    EXPECT_GT(Json::parse(shop.out)["permits"].get<int>(), 300);
    // No SYNC from a dead guard: the board brakes by itself.
    EXPECT_EQ(shop.run("drive --faults killed=0.3" + drive), kExitCollision) << shop.err;
    EXPECT_EQ(Json::parse(shop.out)["board_stop"]["why"], "permit_ran_out") << shop.out;
    EXPECT_EQ(shop.run("drive --bus nocan9" + drive), kExitInput) << shop.err;
    EXPECT_NE(shop.err.find("can.sync: guard conflicts with --bus"), std::string::npos) << shop.err;
    ASSERT_EQ(shop.run("check m.yaml --engine cpu --mesh-root " + folder), kExitClean);
    EXPECT_NE(shop.out.find("after SYNC 0x080 of the guard that counts 1 to 240"),
              std::string::npos)
        << shop.out;
}

TEST_F(ForeignFrames, CheckSaysWhereTheAxesStand) {
    (void)shop.write("board.dbc", kDbc);
    (void)shop.write("dbc.yaml", without_can(test::content_of(paper)) + kDbcSection);
    (void)shop.write("drives.yaml", without_can(test::content_of(paper)) + kDriveSection);
    ASSERT_EQ(shop.run("check dbc.yaml --engine cpu --mesh-root " + folder), kExitClean)
        << shop.err;
    EXPECT_NE(shop.out.find("frames: signals, 4 a sample of 1000 us"), std::string::npos)
        << shop.out;
    EXPECT_NE(
        shop.out.find("Y position     0x181,  8 bytes   31|24 big signed integer  x 0.001 mm"),
        std::string::npos)
        << shop.out;
    EXPECT_NE(shop.out.find("0x182, 12 bytes, page 3"), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("counts 0 to 14"), std::string::npos);
    (void)shop.write("board.dbc", extended_dbc());
    ASSERT_EQ(shop.run("check dbc.yaml --engine cpu --mesh-root " + folder), kExitClean)
        << shop.err;
    EXPECT_NE(shop.out.find("Y position     0x18FF0181,  8 bytes"), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("0x00000181, 12 bytes, page 1, 5-7 "), std::string::npos) << shop.out;
    EXPECT_NE(shop.out.find("0x00000181, 12 bytes, page 4-9 in 3 "), std::string::npos);
    ASSERT_EQ(shop.run("check dbc.yaml --engine cpu --json --mesh-root " + folder), kExitClean);
    const Json signals = Json::parse(shop.out)["frames"]["signals"];
    EXPECT_EQ(signals[2]["pages"], Json::parse("[[[1, 1], [5, 7]]]"));
    EXPECT_EQ(signals[3]["page"], 2);
    EXPECT_EQ(signals[4]["pages"], Json::parse("[[[3, 3]], [[4, 9]]]"));
    ASSERT_EQ(shop.run("check drives.yaml --engine cpu --json --mesh-root " + folder), kExitClean);
    EXPECT_EQ(Json::parse(shop.out)["guard"]["obeyed_by"], "board");
    EXPECT_FALSE(Json::parse(shop.out)["guard"].contains("not_obeyed"));
    const Json frames = Json::parse(shop.out)["frames"];
    EXPECT_EQ(frames["format"], "cia402");
    EXPECT_EQ(frames["frames_a_sample"], 6);
    ASSERT_EQ(frames["signals"].size(), 11U);
    EXPECT_EQ(frames["signals"][0]["axis"], "X");
    EXPECT_EQ(frames["signals"][0]["id"], 0x183);
    EXPECT_EQ(frames["signals"][0]["extended"], false);
    EXPECT_EQ(frames["signals"][0]["factor"], 0.001);
    EXPECT_EQ(frames["signals"][5]["says"], "velocity");
}

}  // namespace
}  // namespace axg
