// SPDX-License-Identifier: Apache-2.0
// Faults in the CAN section: identifiers, frames, signals.
// Each test breaks one thing of a sound file and expects every word of the answer, its line
// included.
#include <gtest/gtest.h>

#include "config/machine/effective_text.hpp"
#include "config/mesh/load_meshes.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

std::string with_signals() {
    const std::string text = kSmallMachine;
    const std::size_t begin = text.find("  format: classical");
    return text.substr(0, begin) +
           R"(  format: signals
  signals:
    X: {id: 0x181, start: 0, length: 32, order: little, signed: true, factor: 1.0e-4, unit: mm}
    A: {id: 0x182, start: 7, length: 32, order: big, signed: true, factor: 1.0e-4, unit: deg}
    C: {id: 0x182, start: 39, length: 32, order: big, signed: true, factor: 1.0e-4, unit: deg}
)" + text.substr(text.find("capacities"));
}

TEST(MachineFaultsCan, TheFilesTheseTestsBreakAreSound) {
    EXPECT_EQ(faults_of(kSmallMachine), "");
    EXPECT_EQ(faults_of(with_signals()), "");
}

TEST(MachineFaultsCan, SameIdentifierTwiceIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "stop: 0x001", "stop: 0x281")),
              "m:31: can.ids: invalid value (found 0x281 for both stop and axes[1], expected a "
              "different id for each (the permit uses its own and the next one)).\n");
}

TEST(MachineFaultsCan, PermitsTwinCounts) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "sync: 0x080", "sync: 0x104")),
              "m:31: can.ids: invalid value (found 0x104 for both sync and the permit's twin, "
              "expected a different id for each (the permit uses its own and the next one)).\n");
}

TEST(MachineFaultsCan, TwelveBitsAreRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "sync: 0x080", "sync: 0x800")),
              "m:31: can.ids.sync: invalid value (found \"0x800\", expected an integer from 0x001 "
              "to 0x7FF).\n");
}

Machine machine_of(const std::string& text) {
    Machine machine;
    EXPECT_TRUE(parse_machine(text, "m", machine).empty()) << text;
    return machine;
}

// Whoever can obey permits is asked for its hashes, unless the file says none.
TEST(MachineFaultsCan, HashesAreRequiredUnlessTheFileSaysNone) {
    const CanLayout required = machine_of(kSmallMachine).can;
    EXPECT_EQ(required.hashes_in_id, 0x582U);
    EXPECT_EQ(required.hashes_out_id, 0x602U);
    const std::string none = with_can(kSmallMachine, "  hashes: none\n");
    EXPECT_EQ(machine_of(none).can.hashes_in_id, 0U);
    EXPECT_EQ(machine_of(none).can.hashes_out_id, 0U);
    EXPECT_EQ(machine_of(with_signals()).can.hashes_in_id, 0U) << "no board can obey its permits";
    EXPECT_EQ(machine_of(with_can(with_signals(), "  hashes: required\n")).can.hashes_in_id,
              0x582U);
    const CanLayout moved =
        machine_of(with(kSmallMachine, "ids: {", "ids: {hashes_in: 0x5A2, ")).can;
    EXPECT_EQ(moved.hashes_in_id, 0x5A2U);
    EXPECT_EQ(moved.hashes_out_id, 0x602U);
}

TEST(MachineFaultsCan, HashesHaveIdentifiersOfTheirOwnAndNoneWithoutThem) {
    for (const auto& [id, name] : {std::pair{"0x582", "hashes_in"}, {"0x602", "hashes_out"}}) {
        const std::string taken = with(kSmallMachine, "stop: 0x001", std::string("stop: ") + id);
        EXPECT_EQ(faults_of(taken), std::string("m:31: can.ids: invalid value (found ") + id +
                                        " for both stop and " + name +
                                        ", expected a different id for each (the permit uses its "
                                        "own and the next one)).\n");
        EXPECT_EQ(faults_of(with_can(taken, "  hashes: none\n")), "");
        EXPECT_EQ(faults_of(with_can(
                      with(kSmallMachine, "ids: {", "ids: {" + std::string(name) + ": 0x5A2, "),
                      "  hashes: none\n")),
                  "m:32: can.ids." + std::string(name) +
                      ": invalid value (found an id of hashes with hashes: none, expected hashes: "
                      "required, or no id).\n");
    }
    EXPECT_NE(faults_of(with_can(kSmallMachine, "  hashes: on\n")), "");
}

TEST(MachineFaultsCan, TheIdsOfASessionAreIdentifiersOfTheirOwn) {
    for (const auto& [id, name] : {std::pair{"0x583", "session_in"},
                                   {"0x682", "hints"},
                                   {"0x584", "operator_in"},
                                   {"0x604", "operator_out"}}) {
        const std::string taken = std::string("stop: ") + id;
        EXPECT_EQ(faults_of(with(kSmallMachine, "stop: 0x001", taken)),
                  std::string("m:31: can.ids: invalid value (found ") + id + " for both stop and " +
                      name +
                      ", expected a different id for each (the permit uses its own and the next "
                      "one)).\n");
        EXPECT_EQ(faults_of(with(kSmallMachine, "stop: 0x001", taken + ", " + name + ": 0x6A0")),
                  "");
    }
    EXPECT_EQ(faults_of(with(with_signals(), "  format: signals",
                             "  format: signals\n  ids: {stop: 0x583}")),
              "")
        << "a board without a sample counter sends none";
}

TEST(MachineFaultsCan, APermitHasVersionTwo) {
    const auto stated = [](const char* permit) {
        return with(kSmallMachine, "stale_after_us: 3000", permit);
    };
    EXPECT_EQ(faults_of(stated("permit: 2")), "");
    for (const std::string other : {"1", "3"}) {
        EXPECT_EQ(
            faults_of(stated(("permit: " + other).c_str())),
            "m:33: can.permit: invalid value (found " + other +
                ", expected 2, or no such key). A permit of version 1 has no session, so that "
                "a board may accept an old one, from before a reset or delayed for a lap of "
                "SYNC.\n");
    }
}

TEST(MachineFaultsCan, PermitTwoNeedsASyncCounter) {
    EXPECT_EQ(
        faults_of(with(with_signals(), "  format: signals", "  format: signals\n  permit: 2")),
        "m:30: can.permit: invalid value (found 2 with samples that have no SYNC counter from 1 to "
        "240, expected no such key, or format: classical or fd, or cia402 with sync_counter: "
        "240).\n");
}

/// The small machine with drives that are told to stop.
std::string with_quick_stop(const std::string& list) {
    return with(kSmallMachine, "stale_after_us: 3000", "quick_stop: " + list);
}

TEST(MachineFaultsCan, QuickStopsAreIdentifiersOfTheirOwn) {
    const std::string wanted =
        ", expected a list of 1 to 16 identifiers, such as [0x303, 0x304]: a receive PDO of each "
        "drive).\n";
    EXPECT_EQ(faults_of(with_quick_stop("[0x303, 0x304]")), "");
    EXPECT_EQ(faults_of(with_quick_stop("[0x303, 0x281]")),
              "m:31: can.ids: invalid value (found 0x281 for both axes[1] and quick_stop[1], "
              "expected a different id for each (the permit uses its own and the next one)).\n");
    EXPECT_EQ(faults_of(with_quick_stop("[0x303, 0x303]")),
              "m:31: can.ids: invalid value (found 0x303 for both quick_stop[0] and quick_stop[1], "
              "expected a different id for each (the permit uses its own and the next one)).\n");
    EXPECT_EQ(faults_of(with_quick_stop("[0x800]")),
              "m:33: can.quick_stop[0]: invalid value (found \"0x800\", expected an integer from "
              "0x001 to 0x7FF).\n");
    EXPECT_EQ(faults_of(with_quick_stop("0x303")),
              "m:33: can.quick_stop: invalid value (found \"0x303\"" + wanted);
    EXPECT_EQ(faults_of(with_quick_stop("[]")),
              "m:33: can.quick_stop: invalid value (found a list of 0" + wanted);
    std::string seventeen = "[0x300";
    for (int i = 1; i < 17; ++i) {
        seventeen += ", " + std::to_string(0x300 + i);
    }
    EXPECT_EQ(faults_of(with_quick_stop(seventeen + "]")),
              "m:33: can.quick_stop: invalid value (found a list of 17" + wanted);
}

// A number of samples is only exact up to a quarter of a period, and SYNC dates the others.
TEST(MachineFaultsCan, TheJitterOfArrivalsIsAtMostAQuarterOfThePeriodOfSignals) {
    const auto stated = [](const std::string& us) {
        return with(with_signals(), "  format: signals\n",
                    "  format: signals\n  arrival_jitter_us: " + us + "\n");
    };
    const std::string wanted = ", expected an integer from 1 to 250).\n";
    EXPECT_EQ(faults_of(stated("1")), "");
    EXPECT_EQ(faults_of(stated("250")), "");
    EXPECT_EQ(faults_of(stated("0")),
              "m:30: can.arrival_jitter_us: invalid value (found \"0\"" + wanted);
    EXPECT_EQ(faults_of(stated("251")),
              "m:30: can.arrival_jitter_us: invalid value (found \"251\"" + wanted);
    Machine known, silent;
    EXPECT_TRUE(parse_machine(stated("200"), "m", known).empty());
    EXPECT_TRUE(parse_machine(with_signals(), "m", silent).empty());
    EXPECT_EQ(known.can.arrival_jitter_us, 200U);
    EXPECT_EQ(silent.can.arrival_jitter_us, 0U);
    EXPECT_NE(effective_text(known), effective_text(silent));
    EXPECT_EQ(faults_of(with(kSmallMachine, "stale_after_us: 3000", "arrival_jitter_us: 200")),
              "m:33: can.arrival_jitter_us: invalid value (found arrival_jitter_us with frames "
              "that follow SYNC, expected format: signals or dbc, or no such key).\n");
}

TEST(MachineFaultsCan, TooFewFramesAreRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "axes: [0x181, 0x281]", "axes: [0x181]")),
              "m:31: can.ids.axes: invalid value (found a list of 1, expected a list of 2, one for "
              "each frame of axis positions, such as [0x181, 0x281, 0x381]).\n");
}

// Two axes a classical frame, less one for the status, and four identifiers by default.
TEST(MachineFaultsCan, MoreThanSevenAxesAreToldTheFormatThatHasRoom) {
    std::string text = with(kSmallMachine, "axes: [0x181, 0x281], ", "");
    text = with(text, "  data_ids: [0x0181, 641]\n", "");
    const auto with_axes = [&text](const std::string& letters) {
        std::string all = text;
        for (const char letter : letters) {
            all.insert(all.find("  A: {"), std::string("  ") + letter +
                                               ": {kind: linear, travel_mm: [0, 9], speed_mm_min: "
                                               "9, acceleration_mm_s2: 9, jerk_mm_s3: none, "
                                               "stopping_mm_s2: 9}\n");
        }
        return all;
    };
    EXPECT_EQ(faults_of(with_axes("YZUV")).find("can.ids"), std::string::npos);
    EXPECT_NE(faults_of(with_axes("YZUVW"))
                  .find("can.ids: invalid value (found no axis ids, expected can.format: fd, whose "
                        "frame has room for 13 axes, or 5 identifiers under can.ids.axes). 8 axes "
                        "need that many frames."),
              std::string::npos)
        << faults_of(with_axes("YZUVW"));
}

TEST(MachineFaultsCan, TooManyFramesAreRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "axes: [0x181, 0x281]", "axes: [0x181, 0x281, 0x381]")),
              "m:31: can.ids.axes: invalid value (found a list of 3, expected a list of 2, one for "
              "each frame of axis positions, such as [0x181, 0x281, 0x381]).\n");
}

TEST(MachineFaultsCan, TheHeartbeatsTimeFollowsThePeriodUnlessStated) {
    const auto timeout_us = [](const std::string& text) {
        Machine machine;
        EXPECT_TRUE(parse_machine(text, "m", machine).empty()) << text;
        return machine.can.heartbeat_timeout_us;
    };
    const auto stated = [](const std::string& words) {
        return with(kSmallMachine, "stale_after_us: 3000\n",
                    "stale_after_us: 90000\n  heartbeat_timeout_us: " + words + "\n");
    };
    EXPECT_EQ(timeout_us(kSmallMachine), 65'000U);
    const std::string slow = with(kSmallMachine, "sample_us: 1000", "sample_us: 20000");
    EXPECT_EQ(timeout_us(with(slow, "  stale_after_us: 3000\n", "")), 65'000U);
    const std::string slower = with(kSmallMachine, "sample_us: 1000", "sample_us: 30000");
    EXPECT_EQ(timeout_us(with(slower, "  stale_after_us: 3000\n", "")), 90'000U);
    EXPECT_EQ(timeout_us(stated("1000")), 1000U);
    EXPECT_EQ(timeout_us(stated("10000000")), 10'000'000U);
    for (const std::string bad : {"999", "10000001"}) {
        EXPECT_EQ(faults_of(stated(bad)),
                  "m:34: can.heartbeat_timeout_us: invalid value (found \"" + bad +
                      "\", expected an integer from 1000 to 10000000).\n");
    }
    EXPECT_EQ(faults_of(with(stated("19999"), "sample_us: 1000", "sample_us: 20000")),
              "m:34: can.heartbeat_timeout_us: invalid value (found 19999, expected at least "
              "sample_us, 20000). A board may send its heartbeat with its samples.\n");
}

TEST(MachineFaultsCan, ThePermitsSamplesAreOneNumberOrTwo) {
    const auto stated = [](const std::string& keys) {
        return with(kSmallMachine, "  stale_after_us: 3000\n", keys.empty() ? "" : "  " + keys);
    };
    const auto machine_of = [&](const std::string& keys) {
        Machine machine;
        EXPECT_TRUE(parse_machine(stated(keys), "m", machine).empty()) << keys;
        return machine;
    };
    const auto can_of = [&](const std::string& keys) { return machine_of(keys).can; };
    EXPECT_EQ(can_of("").permit_samples, (PermitSamples{3, 12}));
    EXPECT_EQ(can_of("").stale_after_us, 12'000U) << "as long as the longest permit";
    EXPECT_EQ(can_of("permit_samples: 5\n").permit_samples, (PermitSamples{5, 5}));
    EXPECT_EQ(can_of("permit_samples: 2\n").stale_after_us, 3000U);
    EXPECT_EQ(can_of("permit_samples: [2, 8]\n").permit_samples, (PermitSamples{2, 8}));
    Machine signals;
    EXPECT_TRUE(parse_machine(with_signals(), "m", signals).empty());
    EXPECT_EQ(signals.can.permit_samples, (PermitSamples{3, 3}));
    const std::string wanted =
        ", expected an integer from 2 to 12, or two of them: [least, most]).\n";
    const std::string one = "m:33: can.permit_samples: invalid value (found ";
    EXPECT_EQ(faults_of(stated("permit_samples: [3]\n")), one + "a list of 1" + wanted);
    EXPECT_EQ(faults_of(stated("permit_samples: [3, 4, 5]\n")), one + "a list of 3" + wanted);
    for (const std::string bad : {"1", "13", "[1, 5]", "[3, 13]", "[3, x]"}) {
        EXPECT_EQ(faults_of(stated("permit_samples: " + bad + "\n")).substr(0, one.size()), one)
            << bad;
    }
    EXPECT_EQ(faults_of(stated("permit_samples: [5, 4]\n")).substr(0, one.size()), one);
    EXPECT_EQ(
        faults_of(with(with_signals(), "  format: signals",
                       "  format: signals\n  permit_samples: [3, 4]")),
        "m:30: can.permit_samples: invalid value (found [3, 4] with samples that have no SYNC "
        "counter from 1 to 240, expected one integer). The guard sends no permits for these "
        "samples.\n");
    EXPECT_NE(effective_text(machine_of("permit_samples: [3, 11]\n")),
              effective_text(machine_of("permit_samples: [3, 10]\n")));
}

TEST(MachineFaultsCan, TheAgeOfPositionsIsOneNumberOrTwo) {
    const auto stated = [](const std::string& key) {
        return with(kSmallMachine, "  stale_after_us: 3000\n", key.empty() ? "" : "  " + key);
    };
    const auto machine_of = [&](const std::string& key) {
        Machine machine;
        EXPECT_TRUE(parse_machine(stated(key), "m", machine).empty()) << key;
        return machine;
    };
    EXPECT_EQ(machine_of("").can.latched_age, (ValueAge{0, 0})) << "a board stamps at the latch";
    EXPECT_FALSE(machine_of("").states.latched_age_us);
    EXPECT_EQ(machine_of("latched_age_us: 800\n").can.latched_age, (ValueAge{800, 800}));
    EXPECT_TRUE(machine_of("latched_age_us: 800\n").states.latched_age_us);
    EXPECT_EQ(machine_of("latched_age_us: [0, 10000]\n").can.latched_age, (ValueAge{0, 10'000}));
    const std::string one = "m:33: can.latched_age_us: invalid value (found ";
    EXPECT_EQ(faults_of(stated("latched_age_us: 10001\n")),
              one + "\"10001\", expected an integer from 0 to 10000).\n");
    EXPECT_EQ(faults_of(stated("latched_age_us: [1, 0]\n")).substr(0, one.size()), one);
    EXPECT_EQ(faults_of(stated("latched_age_us: [0]\n")),
              one +
                  "a list of 1, expected an integer from 0 to 10000, or two of them: [least, "
                  "most]).\n");
    EXPECT_EQ(effective_text(machine_of("")), effective_text(machine_of("latched_age_us: 0\n")));
    const MachineMeshes none;
    constexpr std::size_t kLimits = 3;
    EXPECT_NE(configuration_hashes(machine_of(""), none).of[kLimits],
              configuration_hashes(machine_of("latched_age_us: [0, 1]\n"), none).of[kLimits])
        << "the board's H has it";
}

TEST(MachineFaultsCan, StaleBeforeTheNextSampleIsRefused) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "stale_after_us: 3000", "stale_after_us: 999")),
              "m:33: can.stale_after_us: invalid value (found 999, expected at least sample_us, "
              "1000). Otherwise every snapshot is stale before the next one arrives.\n");
}

TEST(MachineFaultsCan, SignalsNeedTheirFormat) {
    EXPECT_EQ(faults_of(with(kSmallMachine, "stale_after_us: 3000", "signals: {}")),
              "m:33: can.signals: invalid value (found signals without format: signals, expected "
              "format: signals, or no such key).\n");
}

TEST(MachineFaultsCan, SignalFormatNeedsSignals) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine,
                       "  format: classical\n"
                       "  sample_us: 1000\n"
                       "  ids: {sync: 0x080, axes: [0x181, 0x281], permit: 0x103, stop: 0x001}\n"
                       "  data_ids: [0x0181, 641]\n",
                       "  format: signals\n")),
        "m:29: can.signals: missing required key (expected a map with a signal for each axis).\n");
}

TEST(MachineFaultsSignals, SignalOutsideItsFrameIsRefused) {
    EXPECT_EQ(faults_of(with(with_signals(), "start: 0,", "start: 33,")),
              "m:31: can.signals.X.start: invalid value (found bits that leave the frame of 8 "
              "bytes, expected start and length inside can.signal_frame_bytes).\n");
}

TEST(MachineFaultsSignals, AnIdentifierOf29BitsIsWrittenSo) {
    const auto x_id = [](const std::string& keys) {
        return with(with_signals(), "X: {id: 0x181,", "X: {" + keys + ",");
    };
    Machine machine, plain;
    ASSERT_TRUE(parse_machine(x_id("id: 0x18FF0181, extended: true"), "m", machine).empty());
    EXPECT_EQ(machine.can.signals[0].id, 0x98FF0181U);
    ASSERT_TRUE(parse_machine(x_id("id: 0x181, extended: true"), "m", machine).empty());
    ASSERT_TRUE(parse_machine(x_id("id: 0x181, extended: false"), "m", plain).empty());
    EXPECT_EQ(plain.can.signals[0].id, 0x181U);
    EXPECT_NE(effective_text(machine), effective_text(plain));
    EXPECT_EQ(faults_of(x_id("id: 0x103, extended: true")), "") << "not the permit's";
    EXPECT_EQ(faults_of(x_id("id: 0x800")),
              "m:31: can.signals.X.id: invalid value (found \"0x800\", expected an integer from "
              "0x001 to 0x7FF, or extended: true for 29 bits).\n");
    EXPECT_EQ(faults_of(x_id("id: 0x20000000, extended: true")),
              "m:31: can.signals.X.id: invalid value (found \"0x20000000\", expected an integer "
              "from 0x001 to 0x1FFFFFFF).\n");
    EXPECT_EQ(faults_of(x_id("id: 0x181, extended: 1")),
              "m:31: can.signals.X.extended: invalid value (found \"1\", expected one of "
              "false, true).\n");
}

TEST(MachineFaultsSignals, OverlappingSignalsAreRefused) {
    EXPECT_EQ(faults_of(with(with_signals(), "start: 39", "start: 31")),
              "m:33: can.signals.C.start: invalid value (found bits that axis A uses in the same "
              "frame, expected bits of its own for each axis).\n");
}

TEST(MachineFaultsSignals, LengthThatEndsTheTravelIsRefused) {
    EXPECT_EQ(
        faults_of(with(with_signals(), "length: 32, order: little", "length: 22, order: little")),
        "m:31: can.signals.X.length: invalid value (found bits that reach from -209.7152 to "
        "209.7151, expected the axis' whole travel, -300 to 300).\n");
}

// A double holds 53 bits of an integer.
TEST(MachineFaultsSignals, BitsThatWouldRoundAreRefused) {
    const auto with_length = [](const std::string& bits) {
        return faults_of(with(with_signals(), "length: 32, order: little",
                              "length: " + bits + ", order: little"));
    };
    EXPECT_EQ(with_length("53"), "");
    EXPECT_EQ(
        with_length("54"),
        "m:31: can.signals.X.length: invalid value (found \"54\", expected an integer from 1 to "
        "53).\n");
}

TEST(MachineFaultsSignals, AngleForALinearAxisIsRefused) {
    EXPECT_EQ(
        faults_of(with(with_signals(), "factor: 1.0e-4, unit: mm}", "factor: 1.0e-4, unit: deg}")),
        "m:31: can.signals.X.unit: invalid value (found \"deg\" for a linear axis, expected mm, "
        "inch, m or um).\n");
}

TEST(MachineFaultsSignals, ZeroFactorIsRefused) {
    EXPECT_EQ(faults_of(with(with_signals(), "factor: 1.0e-4, unit: mm", "factor: 0, unit: mm")),
              "m:31: can.signals.X.factor: invalid value (found 0, expected a factor of at least "
              "1e-12 in size, not 0).\n");
}

TEST(MachineFaultsSignals, SignalOfNoAxisAndAxisWithoutSignalAreRefused) {
    EXPECT_EQ(faults_of(with(with_signals(), "    X: {id", "    Y: {id")),
              "m:30: can.signals: invalid value (found no signal for axis X, expected exactly one "
              "signal for each axis).\nm:31: can.signals.Y: invalid value (found \"Y\", expected "
              "the name of an axis of this file: X, A, C).\n");
}

TEST(MachineFaultsSignals, IdentifierWithAnotherMeaningIsRefused) {
    EXPECT_EQ(faults_of(with(with_signals(), "id: 0x181", "id: 0x080")),
              "m:30: can.signals: invalid value (found an id that is also the one of sync, "
              "expected an id of its own for the frames of signals).\n");
}

TEST(MachineFaultsSignals, LengthThatCanHasNotIsRefused) {
    EXPECT_EQ(faults_of(with(with_signals(), "  signals:\n",
                             "  signal_frame_bytes: 9\n"
                             "  signals:\n")),
              "m:30: can.signal_frame_bytes: invalid value (found 9, expected a CAN payload "
              "length: 1 to 8, 12, 16, 20, 24, 32, 48 or 64).\n");
}

TEST(MachineFaultsSignals, AxisIdentifiersAreRefusedBesideSignals) {
    EXPECT_EQ(faults_of(with(with_signals(), "  signals:\n",
                             "  ids: {axes: [0x181]}\n"
                             "  signals:\n")),
              "m:30: can.ids.axes: invalid value (found ids of axis frames with format: signals, "
              "expected no such key). Each signal has its own id.\n");
}

}  // namespace
}  // namespace axg::test
