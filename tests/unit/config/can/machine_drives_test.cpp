// SPDX-License-Identifier: Apache-2.0
// format: cia402: drives, their process data and their counts; every word of each refusal.
#include <gtest/gtest.h>

#include "config/can/eds.hpp"
#include "config/machine/effective_text.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "tests/support/dbc_text.hpp"
#include "tests/support/drive_text.hpp"

namespace axg::test {
namespace {

TEST(MachineDrives, ProcessDataBecomeSignals) {
    Machine machine;
    ASSERT_EQ(faults_with_file(drive_machine(), kDriveEds, machine), "");
    EXPECT_EQ(make_frame_set(machine).axis_count, machine.axes.size());
    const CanLayout& can = machine.can;
    EXPECT_EQ(can.format, CanFormat::cia402);
    EXPECT_EQ(can.sync_counter_max, 240);
    EXPECT_EQ(can.sync_window_us, 800U);
    EXPECT_EQ(can.stale_after_us, 12'000U) << "as long as the longest permit";
    ASSERT_EQ(can.signals.size(), 7U);
    const CanSignal& x = can.signals[0];
    EXPECT_EQ(x.id, 0x183U);
    EXPECT_EQ(x.start_bit, 16);
    EXPECT_EQ(x.length_bits, 32);
    EXPECT_EQ(x.frame_bytes, 6);
    EXPECT_EQ(x.factor, -5.0 / 65536);
    EXPECT_EQ(x.offset, -1000 * (5.0 / 65536)) << "at -1000 counts it is at 0";
    const CanSignal& a = can.signals[1];
    EXPECT_EQ(a.start_bit, 0);
    EXPECT_EQ(a.frame_bytes, 8);
    EXPECT_EQ(a.factor, 360.0 / 4194304);
    const CanSignal& c = can.signals[2];
    EXPECT_EQ(c.id, 0x385U) << "TPDO3 of node 5";
    EXPECT_EQ(c.frame_bytes, 8);
    EXPECT_EQ(can.signals[3].role, SignalRole::velocity);
    EXPECT_EQ(can.signals[3].axis, 1U);
    EXPECT_EQ(can.signals[3].start_bit, 32);
    EXPECT_EQ(can.signals[3].factor, 0.006);
    EXPECT_EQ(can.signals[4].mark, 0U);
    EXPECT_EQ(can.signals[5].mark, 0x100U);
    EXPECT_EQ(can.signals[6].id, 0x185U);
    EXPECT_EQ(can.signals[6].frame_bytes, 3) << "two of the three entries are active";
}

// An EDS with the identifier of a node that somebody wrote into it; a DCF is written for its node.
TEST(MachineDrives, AnotherNodesIdentifierInAnEdsIsDoubted) {
    const std::string plain = with(kDriveEds, "[DeviceComissioning]\nNodeID=5\n", "");
    const std::string with_default =
        with(plain, "ParameterValue = 0x380 + $NodeID", "DefaultValue=$NODEID+0x380");
    const auto doubts_of = [](const std::string& eds) {
        Machine machine;
        std::vector<std::string> doubts;
        const NamedFiles files = [&eds](const std::string&, std::size_t) {
            return NamedFile{eds, {}, {}};
        };
        EXPECT_TRUE(parse_machine(drive_machine(), "m", machine, files, &doubts).empty());
        return doubts;
    };
    EXPECT_TRUE(doubts_of(with_default).empty());
    const std::string changed =
        with(with_default, "$NODEID+0x380", "$NODEID+0x380\nParameterValue=0x38C");
    ASSERT_EQ(doubts_of(changed).size(), 1U);
    const std::string doubt = doubts_of(changed)[0];
    EXPECT_NE(
        doubt.find("can.drives.C.file: TPDO3 is awaited under ParameterValue 0x38C (drive.dcf:"),
        std::string::npos)
        << doubt;
    EXPECT_NE(
        doubt.find("); DefaultValue makes it 0x385 for node 5. Delete ParameterValue if it is "
                   "that of another node."),
        std::string::npos)
        << doubt;
    EXPECT_TRUE(doubts_of(with(changed, "0x38C", "0x385")).empty()) << "the same number";
    EXPECT_TRUE(doubts_of(with(changed, "0x38C", "$NODEID+0x388")).size() == 1);
    const std::string dcf =
        with(changed, "[1800sub1]", "[DeviceComissioning]\nNodeID=5\n[1800sub1]");
    EXPECT_TRUE(doubts_of(dcf).empty());
}

TEST(MachineDrives, WithoutAWordSyncDoesNotCountAndTheWindowIsThePeriod) {
    Machine machine;
    const std::string text =
        with(drive_machine(), "  sync_counter: 240\n  sync_window_us: 800\n", "");
    ASSERT_EQ(faults_with_file(text, kDriveEds, machine), "");
    EXPECT_EQ(machine.can.sync_counter_max, 0);
    EXPECT_EQ(machine.can.sync_window_us, 1000U);
}

TEST(MachineDrives, ADriveMayAnswerWithTheValueOfTheSyncBefore) {
    Machine machine;
    ASSERT_EQ(faults_with_file(drive_machine(), kDriveEds, machine), "");
    EXPECT_EQ(machine.can.latched_age, (ValueAge{0, 1000}));
    EXPECT_FALSE(machine.states.latched_age_us);
    const std::string text = with(drive_machine(), "  sync_counter: 240\n",
                                  "  sync_counter: 240\n  latched_age_us: 0\n");
    ASSERT_EQ(faults_with_file(text, kDriveEds, machine), "");
    EXPECT_EQ(machine.can.latched_age, (ValueAge{0, 0}));
}

// The guard counts to 240, and its SYNC is no more precise than a bus.
TEST(MachineDrives, TheGuardMayBeTheProducerOfSync) {
    const std::string by_guard = with(drive_machine(), "sync_counter: 240", "sync: guard");
    const std::string text = with(by_guard, "latch_jitter_us: 20", "latch_jitter_us: 100");
    Machine machine, of_board;
    ASSERT_EQ(faults_with_file(text, kDriveEds, machine), "");
    EXPECT_TRUE(machine.can.guard_sends_sync);
    EXPECT_EQ(machine.can.sync_counter_max, 240);
    ASSERT_EQ(faults_with_file(with(drive_machine(), "latch_jitter_us: 20", "latch_jitter_us: 100"),
                               kDriveEds, of_board),
              "");
    EXPECT_FALSE(of_board.can.guard_sends_sync);
    EXPECT_NE(effective_text(machine), effective_text(of_board));
    const std::string jitter =
        "latch_jitter_us: invalid value (found 99 with can.sync: guard, expected at least 100). It "
        "covers the time from the guard's clock to the end of SYNC on the bus.\n";
    EXPECT_EQ(
        faults_with_file(with(by_guard, "latch_jitter_us: 20", "latch_jitter_us: 99"), kDriveEds),
        "m:39: guard." + jitter);
    EXPECT_NE(faults_with_file(by_guard.substr(0, by_guard.find("guard: {promise")), kDriveEds)
                  .find("latch_jitter_us: invalid value (found 20 with can.sync: guard"),
              std::string::npos);
    EXPECT_EQ(
        faults_with_file(with(text, "sync: guard", "sync: guard\n  sync_counter: 100"), kDriveEds),
        "m:31: can.sync_counter: invalid value (found 100 with sync: guard, expected 240, or no "
        "such key). The guard counts SYNC to 240.\n");
    EXPECT_NE(faults_with_file(with(text, "format: cia402", "format: classical"), kDriveEds)
                  .find("can.sync: invalid value (found sync without format: cia402"),
              std::string::npos);
}

TEST(MachineDrives, EveryRefusalSaysWhatToDo) {
    struct Case {
        const char *from, *to, *said;
    };
    for (const Case& c : {
             Case{"per_mm: 5", "per_deg: 5",
                  "m:33: can.drives.X.per_mm: missing required key (expected an integer).\nm:34: "
                  "can.drives.X.per_deg: invalid value (found per_deg of a linear axis, expected "
                  "per_mm).\n"},
             Case{"counts: 65536", "counts: 65536.5",
                  "m:34: can.drives.X.counts: invalid value (found \"65536.5\", expected an "
                  "integer from 1 to 2147483647, digits only).\n"},
             Case{"zero_counts: -1000", "zero_counts: 0.5",
                  "m:34: can.drives.X.zero_counts: invalid value (found 0.5, expected a whole "
                  "number of counts).\n"},
             Case{"counts: 65536, per_mm: 5", "counts: 2147483647, per_mm: 5",
                  "m:34: can.drives.X.counts: invalid value (found 32 bits that reach from"},
             Case{"counts: 1048576, per_deg: 360", "counts: 1000000, per_deg: 360",
                  "m:37: can.drives.C.range_counts: invalid value (found 4294967296 counts, "
                  "4294.967296 turns, expected the drive's position range (object 0x607B), a whole "
                  "number of turns).\n"},
             Case{"counts: 1048576, per_deg: 360",
                  "counts: 1000000, per_deg: 360, "
                  "range_counts: 4000000000",
                  ""},
             Case{"counts: 65536, per_mm", "range_counts: 4294967296, counts: 65536, per_mm",
                  "m:34: can.drives.X.range_counts: invalid value (found a range for an axis that "
                  "has travel limits, expected no such key).\n"},
             Case{"zero_counts: -1000, absolute: true", "zero_counts: -1000",
                  "m:33: can.drives.X.absolute: invalid value (found neither absolute: true nor "
                  "homed_bit, expected absolute: true for an absolute encoder, or homed_bit, the "
                  "bit of the status word that means homed).\n"},
             Case{"homed_bit: 8", "homed_bit: 8, absolute: true",
                  "m:36: can.drives.A.homed_bit: invalid value (found homed_bit and absolute, "
                  "expected absolute: true for an absolute encoder, or homed_bit, the bit of the "
                  "status word that means homed).\n"},
             Case{"[0x60410010, 0x60640020]", "[0x60410010, 0x60630020]",
                  "m:33: can.drives.X.pdos: invalid value (found no PDO at every SYNC with "
                  "0x60640020, expected the position, 0x6064 of 32 bits, mapped).\n"},
             Case{", {cob_id: 0x284, map: [0x60410010]}", "",
                  "m:35: can.drives.A.pdos: invalid value (found no PDO at every SYNC with "
                  "0x60410010, expected the status word, 0x6041 of 16 bits, mapped). It reports "
                  "faults.\n"},
             Case{"[0x60640020, 0x606C0020]", "[0x60640020]",
                  "m:35: can.drives.A.pdos: invalid value (found no PDO at every SYNC with "
                  "0x606C0020, expected the velocity, 0x606C of 32 bits, mapped, or no key "
                  "velocity).\n"},
             Case{"[0x60640020, 0x606C0020]", "[0x60640020, 0x606C0020, 0x60610008]",
                  "m:35: can.drives.A.pdos: invalid value (found a PDO of 72 bits under 0x184, "
                  "expected whole bytes, at most 8 of them).\n"},
             Case{"file: drive.dcf", "file: nothing.dcf",
                  "m:37: can.drives.C.file: invalid value (found \"nothing.dcf\": nothing, "
                  "expected a file).\n"},
             Case{"file: drive.dcf", "pdos: [{cob_id: 0x385, map: [0x60640020, 0x60410010]}]", ""},
             Case{"file: drive.dcf, ", "",
                  "m:37: can.drives.C.file: invalid value (found neither, expected either pdos, or "
                  "the EDS or DCF file of the drive).\n"},
             Case{"{cob_id: 0x184,", "{cob_id: 0x183,",
                  "m:32: can.drives: invalid value (found 0x183 for both X and A, expected "
                  "identifiers of its own for each drive).\n"},
             Case{"{cob_id: 0x284,", "{cob_id: 0x184,",
                  "m:32: can.drives: invalid value (found 0x184 for both A and another PDO, "
                  "expected identifiers of its own for each drive).\n"},
             Case{"{cob_id: 0x184,", "{cob_id: 0x080,",
                  "m:29: can.signals: invalid value (found an id that is also the one of sync, "
                  "expected an id of its own for the frames of signals).\n"},
             Case{"    C: {node", "    D: {node",
                  "m:32: can.drives: invalid value (found no drive for axis C, expected exactly "
                  "one drive for each axis).\nm:37: can.drives.D: invalid value (found \"D\", "
                  "expected the name of an axis of this file: X, A, C).\n"},
             Case{"sync_counter: 240", "sync_counter: 1",
                  "m:30: can.sync_counter: invalid value (found 1, expected 0 (SYNC without a "
                  "counter), or 2 to 240: object 0x1019).\n"},
             Case{"sync_window_us: 800", "sync_window_us: 1001",
                  "m:31: can.sync_window_us: invalid value (found \"1001\", expected an integer "
                  "from 10 to 1000).\n"},
             Case{"format: cia402", "format: classical",
                  "m:30: can.sync_counter: invalid value (found sync_counter without format: "
                  "cia402, expected format: cia402, or no such key).\n"},
             Case{"node: 5", "node: 6",
                  "drive.dcf:4: devicecomissioning.nodeid: invalid value (found 5 (machine file: "
                  "6), expected the file of this drive, or its node number).\n"},
         }) {
        const std::string faults = faults_with_file(with(drive_machine(), c.from, c.to), kDriveEds);
        const std::string said = c.said;
        if (said.ends_with('\n') && std::string_view(c.from) != "format: cia402") {
            EXPECT_EQ(faults, said);
        } else {
            EXPECT_NE(faults.find(said), std::string::npos) << faults;
            EXPECT_EQ(faults.empty(), said.empty()) << faults;
        }
    }
}

// Those of X, A and C are five. More drives have two or three each; their axes move nothing, which
// is another fault.
TEST(MachineDrives, ASampleHasAPlaceFor36Frames) {
    std::string axes, drives;
    const auto add = [&](const std::string& id, const std::string& pdos) {
        axes += "  D" + id + ": {kind: linear, travel_mm: [-9, 9], speed_mm_min: 100, " +
                "acceleration_mm_s2: 2000, jerk_mm_s3: none, stopping_mm_s2: 1500}\n";
        drives += "    D" + id + ": {pdos: [" + pdos + "], counts: 1000, per_mm: 1, " +
                  "absolute: true, velocity: {counts: 1, per_mm_s: 1}}\n";
    };
    const auto pdo = [](const std::string& id, const std::string& objects) {
        return "{cob_id: 0x" + id + ", map: [" + objects + "]}";
    };
    const auto faults = [&] {
        const std::string text = with(drive_machine(), "bodies:\n", axes + "bodies:\n");
        return faults_with_file(with(text, "capacities:", drives + "capacities:"), kDriveEds);
    };
    for (const std::string id : {"0", "1", "2", "3", "4", "5", "6", "7", "8"}) {
        add(id, pdo("30" + id, "0x60640020") + ", " + pdo("31" + id, "0x60410010") + ", " +
                    pdo("32" + id, "0x606C0020"));
    }
    const auto add_two = [&](const std::string& id) {
        add(id, pdo("30" + id, "0x60640020") + ", " + pdo("31" + id, "0x60410010, 0x606C0020"));
    };
    add_two("9");
    add_two("A");
    EXPECT_EQ(faults().find("can."), std::string::npos) << faults();
    add_two("B");
    EXPECT_NE(faults().find("can.format: invalid value (found 38 frames with positions and "
                            "states, expected at most 36). Map the objects of a drive in fewer"),
              std::string::npos)
        << faults();
}

// Bit 29 of a COB-ID marks 29 bits, in object 0x1800 and so in both files.
TEST(MachineDrives, ProcessDataMayHaveIdentifiersOf29Bits) {
    const auto written = [](const std::string& cob_id) {
        return with(drive_machine(), "{cob_id: 0x183,", "{cob_id: " + cob_id + ",");
    };
    Machine machine;
    ASSERT_EQ(faults_with_file(written("0x38FF0183"), kDriveEds, machine), "");
    EXPECT_EQ(make_frame_set(machine).axis_count, machine.axes.size());
    EXPECT_EQ(machine.can.signals[0].id, 0x98FF0183U);
    EXPECT_EQ(faults_with_file(written("0x20000184"), kDriveEds), "") << "0x184 is A's, of 11 bits";
    const std::string wanted =
        ", expected 0x001 to 0x7FF, or 0x20000000 plus an identifier of 29 bits).\n";
    for (const std::string bad : {"0x800", "0x20000000", "0x1FFFFFFF"}) {
        EXPECT_EQ(faults_with_file(written(bad), kDriveEds),
                  "m:33: can.drives.X.pdos[0].cob_id: invalid value (found " + bad + wanted);
    }
    EXPECT_EQ(faults_with_file(written("0x40000183"), kDriveEds),
              "m:33: can.drives.X.pdos[0].cob_id: invalid value (found \"0x40000183\", expected an "
              "integer from 0x001 to 0x3FFFFFFF).\n");
    const std::string eds = with(kDriveEds, "= 0x380 + $NodeID", "= 0x38FF0385");
    ASSERT_EQ(faults_with_file(drive_machine(), eds, machine), "");
    bool has_id = false;
    for (const CanSignal& signal : machine.can.signals) {
        has_id = has_id || signal.id == 0x98FF0385U;
    }
    EXPECT_TRUE(has_id);
}

TEST(MachineDrives, APositionThatIsNotLatchedBySyncIsRefused) {
    const std::string eds =
        with(kDriveEds, "[1802sub2]\nDefaultValue=0x1", "[1802sub2]\nDefaultValue=254");
    EXPECT_EQ(faults_with_file(drive_machine(), eds),
              "m:37: can.drives.C.file: invalid value (found TPDO3 with the position, of "
              "transmission type 254 (drive.dcf:29), expected type 1: latched and sent at every "
              "SYNC).\n");
}

TEST(EdsFile, SaysWhatIsActiveAndNothingElse) {
    Eds eds;
    ASSERT_TRUE(parse_eds(kDriveEds, "d", 5, eds).empty());
    EXPECT_EQ(eds.node, 5U);
    ASSERT_EQ(eds.pdos.size(), 4U);
    EXPECT_EQ(eds.pdos[0].cob_id, 0x185U);
    EXPECT_EQ(eds.pdos[0].map, (std::vector<std::uint32_t>{0x60410010, 0x60610008}))
        << "ParameterValue goes before DefaultValue";
    EXPECT_EQ(eds.pdos[1].cob_id, 0x80000280U);
    EXPECT_EQ(eds.pdos[2].cob_id, 0x385U);
    EXPECT_EQ(eds.pdos[2].number, 3U);
    EXPECT_EQ(eds.pdos[3].transmission_type, 255U);
}

TEST(EdsFile, WhatCannotBeReadIsSaidWithItsLine) {
    struct Case {
        const char *text, *said;
    };
    for (const Case& c : {
             Case{"[1800sub1\n",
                  "d:1: invalid file (found \"[1800sub1\", expected a section in brackets, such as "
                  "[1800sub1])."},
             Case{"[a]\nnothing\n",
                  "d:2: a: invalid value (found \"nothing\", expected key=value, such as "
                  "PDOMapping=0)."},
             Case{"[1800sub1]\nDefaultValue=0180\n",
                  "d:2: 1800sub1.defaultvalue: invalid value (found \"0180\", expected a number, "
                  "such as 385, 0x181 or $NODEID+0x180)."},
             Case{"[1800sub1]\nDefaultValue=$NODEID+\n",
                  "d:2: 1800sub1.defaultvalue: invalid value (found \"$NODEID+\", expected a "
                  "number, such as 385, 0x181 or $NODEID+0x180)."},
             Case{"[1800sub1]\nDefaultValue=$NODEID+$NODEID\n",
                  "d:2: 1800sub1.defaultvalue: invalid value (found \"$NODEID+$NODEID\", expected "
                  "a number, such as 385, 0x181 or $NODEID+0x180)."},
             Case{"[a]\nb=1\nB=2\n",
                  "d:3: a=b: invalid value (found \"2\", expected one value: line 2 states "
                  "another)."},
             Case{"[1800sub1]\nDefaultValue=1\n[1800sub2]\nDefaultValue=1\n[1A00sub0]\n"
                  "DefaultValue=2\n[1A00sub1]\nDefaultValue=0x60640020\n",
                  "d:6: 1a00sub2: invalid value (found no value, expected the mapped object). "
                  "Subindex 0 states 2 mapped objects."},
             Case{"[1800sub1]\nDefaultValue=1\n[1800sub2]\nDefaultValue=1\n[1A00sub0]\n"
                  "DefaultValue=65\n",
                  "d:6: 1a00sub0: invalid value (found 65, expected at most 64 mapped objects)."},
             Case{"[DeviceComissioning]\nNodeID=x\n",
                  "d:2: devicecomissioning.nodeid: invalid value (found \"x\", expected a number "
                  "from 1 to 127)."},
         }) {
        Eds eds;
        const auto faults = parse_eds(c.text, "d", 3, eds);
        ASSERT_EQ(faults.size(), 1U) << c.text;
        EXPECT_EQ(to_string(faults[0]), c.said);
        EXPECT_TRUE(eds.pdos.empty());
    }
    Eds eds;
    EXPECT_TRUE(parse_eds("", "d", 3, eds).empty());
    EXPECT_TRUE(parse_eds("[a]\nb=1\nb=1\n", "d", 3, eds).empty()) << "said twice alike";
    EXPECT_EQ(parse_eds(std::string(kEdsSizeBytesMax + 1, '\n'), "d", 3, eds).size(), 1U);
}

}  // namespace
}  // namespace axg::test
