// SPDX-License-Identifier: Apache-2.0
// What the guard is promised, key by key: what each comes to in the plain data and in the hash of
// the configuration, both ends of its range, and the words of its fault.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "config/machine/effective_text.hpp"
#include "core/base/sincos.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

const std::string kGuard = "board_reaction_ms: 2, latch_jitter_us: 20, free_jerk: any";

Machine loaded(const std::string& text) {
    Machine machine;
    std::string faults;
    for (const ConfigFault& fault : parse_machine(text, "m", machine)) {
        faults += to_string(fault) + '\n';
    }
    EXPECT_EQ(faults, "");
    return machine;
}

std::string without_guard() {
    const std::string text = kSmallMachine;
    return text.substr(0, text.find("guard:"));
}

TEST(MachineGuard, WithoutTheSectionTheDefaultsHold) {
    const Machine machine = loaded(without_guard());
    EXPECT_EQ(machine.guard.board_reaction_s, 2e-3);
    EXPECT_EQ(machine.guard.latch_jitter_s, 20e-6);
    EXPECT_FALSE(machine.guard.free_jerk_limited);
    EXPECT_FALSE(machine.guard.travel_enforced);
    EXPECT_FALSE(machine.guard.travel_proofs);
    EXPECT_EQ(machine.guard.overrun_mm, 2);
    EXPECT_NEAR(machine.guard.overrun_rad, 0.5 * kPi / 180, 1e-17);
    EXPECT_EQ(machine.cycle, CycleRules{});
    EXPECT_FALSE(machine.guard.speed_cap);
    EXPECT_EQ(machine.guard.cap_lead_s, 20e-3);
    EXPECT_EQ(machine.guard.level_band_mm, 0.5);
    EXPECT_EQ(machine.guard.level_hold_samples, 50U);
    for (const Pair& pair : machine.pairs) {
        EXPECT_EQ(pair.slow_mm, 0);
        EXPECT_EQ(pair.warn_mm, 0);
    }
    EXPECT_EQ(machine.axes[0].position_error, 0.001);
    EXPECT_EQ(machine.axes[0].following_error, 0);
    EXPECT_NEAR(machine.axes[1].position_error, 0.0005 * kPi / 180.0, 1e-18);
    EXPECT_EQ(machine.axes[1].following_error, 0);
    EXPECT_EQ(effective_text(machine), effective_text(loaded(kSmallMachine)));
}

struct Change {
    const char *from, *to;
};

// Each is another machine: its hash differs, and the data hold what was written.
TEST(MachineGuard, EachKeyArrivesAndIsPartOfTheHash) {
    const auto changed = [](Change change) {
        const std::string text = with(kSmallMachine, change.from, change.to);
        const Machine machine = loaded(text);
        EXPECT_NE(effective_text(machine), effective_text(loaded(kSmallMachine))) << change.to;
        return machine;
    };
    EXPECT_EQ(changed({"board_reaction_ms: 2", "board_reaction_ms: 0.5"}).guard.board_reaction_s,
              0.5e-3);
    EXPECT_EQ(changed({"latch_jitter_us: 20", "latch_jitter_us: 0"}).guard.latch_jitter_s, 0);
    EXPECT_TRUE(changed({"free_jerk: any", "free_jerk: limited"}).guard.free_jerk_limited);
    EXPECT_EQ(changed({"free_jerk: any", "free_jerk: any, stop_reversal: jerk_limited"})
                  .guard.stop_reversal,
              StopReversal::jerk_limited);
    EXPECT_EQ(loaded(with(kSmallMachine, "free_jerk: any", "free_jerk: any, stop_reversal: none"))
                  .guard.stop_reversal,
              StopReversal::none);
    EXPECT_TRUE(
        changed({"free_jerk: any", "free_jerk: any, limits_broken: report"}).guard.reports_limits);
    EXPECT_FALSE(
        loaded(with(kSmallMachine, "free_jerk: any", "free_jerk: any, limits_broken: stop"))
            .guard.reports_limits);
    EXPECT_EQ(changed({"free_jerk: any", "free_jerk: any, obeyed_by: line"}).guard.obeyed_by,
              ObeyedBy::line);
    EXPECT_EQ(changed({"free_jerk: any", "free_jerk: any, obeyed_by: drives"}).guard.obeyed_by,
              ObeyedBy::drives);
    EXPECT_EQ(loaded(with(kSmallMachine, "free_jerk: any", "free_jerk: any, obeyed_by: board"))
                  .guard.obeyed_by,
              ObeyedBy::board);
    EXPECT_TRUE(changed({"travel_enforced: false", "travel_enforced: true"}).guard.travel_enforced);
    const Machine proven = changed({"travel_proofs: false", "travel_proofs: true"});
    EXPECT_TRUE(proven.guard.travel_proofs);
    const Machine farther = changed({"travel_proofs: false, overrun_mm: 2, overrun_deg: 0.5",
                                     "travel_proofs: true, overrun_mm: 3.5, overrun_deg: 2"});
    EXPECT_EQ(farther.guard.overrun_mm, 3.5);
    EXPECT_NEAR(farther.guard.overrun_rad, 2 * kPi / 180, 1e-15);
    EXPECT_NE(effective_text(farther), effective_text(proven)) << "limits used are hashed";
    EXPECT_TRUE(changed({"speed_cap: false", "speed_cap: true"}).guard.speed_cap);
    EXPECT_EQ(changed({"speed_cap: false", "speed_cap: false, cap: all_axes"}).guard.cap,
              CapPromise::all_axes);
    EXPECT_EQ(changed({"speed_cap: false", "speed_cap: false, cap: per_axis"}).guard.cap,
              CapPromise::per_axis);
    EXPECT_EQ(
        loaded(with(kSmallMachine, "speed_cap: false", "speed_cap: false, cap: none")).guard.cap,
        CapPromise::none);
    EXPECT_EQ(changed({"cap_lead_ms: 20", "cap_lead_ms: 7.5"}).guard.cap_lead_s, 7.5e-3);
    EXPECT_EQ(changed({"level_band_mm: 0.5", "level_band_mm: 0.25"}).guard.level_band_mm, 0.25);
    EXPECT_EQ(changed({"level_hold_samples: 50", "level_hold_samples: 7"}).guard.level_hold_samples,
              7U);
    EXPECT_EQ(
        changed({"position_error_mm: 0.001", "position_error_mm: 0.5"}).axes[0].position_error,
        0.5);
    EXPECT_EQ(
        changed({"following_error_mm: 0", "following_error_mm: 0.25"}).axes[0].following_error,
        0.25);
    const Machine turned =
        changed({"stopping_deg_s2: 400",
                 "stopping_deg_s2: 400, position_error_deg: 9, following_error_deg: 3"});
    EXPECT_NEAR(turned.axes[1].position_error, kPi / 20, 1e-15);
    EXPECT_NEAR(turned.axes[1].following_error, kPi / 60, 1e-15);
}

// What `guard` says holds for pairs that say nothing, key by key.
TEST(MachineGuard, ClearanceLevelsOfAPairTakeTheUsualOnesPlace) {
    const std::string usual =
        with(kSmallMachine, "slow_mm: 0, warn_mm: 0", "slow_mm: 2, warn_mm: 5");
    for (const Pair& pair : loaded(usual).pairs) {
        EXPECT_EQ(pair.slow_mm, 2);
        EXPECT_EQ(pair.warn_mm, 5);
    }
    const auto pair_of = [&usual](const std::string& words) {
        return loaded(with(usual, "margin_mm: 0.5}", "margin_mm: 0.5, " + words + "}")).pairs[0];
    };
    EXPECT_EQ(pair_of("slow_mm: 3").slow_mm, 3);
    EXPECT_EQ(pair_of("slow_mm: 3").warn_mm, 5);
    EXPECT_EQ(pair_of("warn_mm: 2").warn_mm, 2);
    EXPECT_EQ(pair_of("warn_mm: 2").slow_mm, 2);
    EXPECT_EQ(pair_of("slow_mm: 0, warn_mm: 0").slow_mm, 0) << "none at all";
    EXPECT_EQ(pair_of("slow_mm: 0, warn_mm: 0").warn_mm, 0);
    const Machine first = loaded(with(usual, "margin_mm: 0.5}", "margin_mm: 0.5, slow_mm: 3}"));
    EXPECT_NE(effective_text(first), effective_text(loaded(usual)));
    EXPECT_NE(effective_text(loaded(usual)), effective_text(loaded(kSmallMachine)));
}

TEST(MachineGuard, SlowIsNoFartherThanWarn) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "slow_mm: 0, warn_mm: 0", "slow_mm: 5, warn_mm: 4.5")),
        "m:37: guard.slow_mm: invalid value (found 5, expected at most warn_mm, which is 4.5).\n");
    const std::string usual =
        with(kSmallMachine, "slow_mm: 0, warn_mm: 0", "slow_mm: 2, warn_mm: 5");
    const auto faults = [&usual](const std::string& words) {
        return faults_of(with(usual, "margin_mm: 0.5}", "margin_mm: 0.5, " + words + "}"));
    };
    EXPECT_EQ(
        faults("slow_mm: 6"),
        "m:23: pairs[0].slow_mm: invalid value (found 6, expected at most warn_mm, which is 5).\n");
    EXPECT_EQ(faults("warn_mm: 1"),
              "m:23: pairs[0].warn_mm: invalid value (found 1, expected at least slow_mm, which is "
              "2).\n");
    EXPECT_EQ(faults("slow_mm: -1"),
              "m:23: pairs[0].slow_mm: invalid value (found \"-1\", expected a number from 0 to "
              "1000).\n");
    EXPECT_EQ(faults("slow_mm: 5"), "");
    EXPECT_EQ(faults("warn_mm: 1000, slow_mm: 1000"), "");
}

const std::string kLookAhead = "format: fd\n  ahead: {id: 0x480, data_id: 7, samples: 200}\n";

/// The small machine with one frame of axes, and a look-ahead path.
std::string look_ahead_machine() {
    std::string text = with(kSmallMachine, "format: classical\n", kLookAhead);
    text = with(text, "axes: [0x181, 0x281]", "axes: [0x181]");
    return with(text, "data_ids: [0x0181, 641]", "data_ids: [0x0181]");
}

// A promise that is not made use of must not pass for the one that is: the box would be too small.
TEST(MachineGuard, PromisesThatAreNotUsedAreRefused) {
    const std::string text = kSmallMachine;
    EXPECT_EQ(faults_of(with(text, "promise: independent", "promise: single_jog")),
              "m:35: guard.promise: invalid value (found single_jog, expected independent or "
              "path_keeping). State single_jog in addition, as the map guard.single_jog.\n");
    EXPECT_EQ(faults_of(with(text, "promise: independent", "promise: path_keeping")),
              "m:35: guard.promise: invalid value (found path_keeping, expected independent, or "
              "can.ahead). Without look-ahead the guard does not know the path.\n");
    EXPECT_EQ(faults_of(with(text, "promise: independent", "promise: independant")),
              "m:35: guard.promise: invalid value (found \"independant\", expected one of "
              "independent, path_keeping, single_jog). Did you mean \"independent\"?\n");
}

TEST(MachineGuard, APathIsKeptWhereThereIsLookAhead) {
    const Machine silent = loaded(kSmallMachine), look_ahead = loaded(look_ahead_machine());
    EXPECT_EQ(silent.can.look_ahead_samples, 0U);
    EXPECT_EQ(look_ahead.can.look_ahead_samples, 200U);
    EXPECT_EQ(look_ahead.can.look_ahead_id, 0x480U);
    EXPECT_EQ(silent.can.permit_samples, (PermitSamples{3, 12}));
    EXPECT_EQ(look_ahead.can.permit_samples, (PermitSamples{8, 12}));
    EXPECT_EQ(look_ahead.can.look_ahead_data_id, 7U);
    EXPECT_EQ(look_ahead.guard.promise, StopPromise::independent) << "a frame is no promise";
    const std::string keeping =
        with(look_ahead_machine(), "promise: independent", "promise: path_keeping");
    EXPECT_EQ(loaded(keeping).guard.promise, StopPromise::path_keeping);
    EXPECT_NE(effective_text(loaded(keeping)), effective_text(look_ahead));
    for (const Change& change :
         {Change{"id: 0x480,", "id: 0x482,"}, Change{"data_id: 7", "data_id: 8"},
          Change{"samples: 200", "samples: 201"}}) {
        EXPECT_NE(effective_text(loaded(with(look_ahead_machine(), change.from, change.to))),
                  effective_text(look_ahead))
            << change.to;
    }
    const Machine usual = loaded(with(look_ahead_machine(), "id: 0x480, data_id: 7, ", ""));
    EXPECT_EQ(usual.can.look_ahead_id, 0x481U);
    EXPECT_EQ(usual.can.look_ahead_data_id, 0x481U);
}

TEST(MachineGuard, TheOutputLineIsOffUnlessItIsNamed) {
    const std::string text =
        with(kSmallMachine, "guard:", "output_line: {chip: gpiochip1, line: 17}\nguard:");
    const Machine machine = loaded(text);
    EXPECT_EQ(machine.output_line.chip, "gpiochip1");
    EXPECT_EQ(machine.output_line.line, 17U);
    EXPECT_EQ(loaded(kSmallMachine).output_line.chip, "");
    EXPECT_NE(effective_text(machine), effective_text(loaded(kSmallMachine)));
    for (const char* const chip : {"gpiochip", "gpiochipX", "../mem", "gpiochip1/x", "mem"}) {
        EXPECT_NE(faults_of(with(text, "gpiochip1", chip))
                      .find("output_line.chip: invalid value (found "),
                  std::string::npos)
            << chip;
    }
    EXPECT_NE(faults_of(with(text, ", line: 17", "")), "");
    EXPECT_NE(faults_of(with(text, "17", "1024")), "");
}

// A drive that stops by itself leaves the path that the proof goes along.
TEST(MachineGuard, QuickStopsOfDrivesVoidAPathThatIsKept) {
    const std::string text =
        with(look_ahead_machine(), "stale_after_us: 3000", "quick_stop: [0x303, 0x304]");
    const Machine machine = loaded(text);
    EXPECT_EQ(machine.can.quick_stop_ids, (std::vector<std::uint32_t>{0x303, 0x304}));
    EXPECT_NE(effective_text(machine), effective_text(loaded(look_ahead_machine())));
    EXPECT_NE(effective_text(machine), effective_text(loaded(with(text, "0x304]", "0x305]"))));
    EXPECT_EQ(
        faults_of(with(text, "promise: independent", "promise: path_keeping")),
        "m:36: guard.promise: invalid value (found path_keeping with can.quick_stop, expected "
        "independent, or no quick_stop). A drive that stops by itself leaves the path.\n");
}

TEST(MachineGuard, FaultsOfLookAhead) {
    const std::string text = look_ahead_machine();
    EXPECT_EQ(faults_of(with(text, ", samples: 200", "")),
              "m:30: can.ahead.samples: missing required key (expected an integer).\n");
    for (const char* samples : {"3", "1025"}) {
        const std::string faults =
            faults_of(with(text, "samples: 200", std::string("samples: ") + samples));
        EXPECT_NE(faults.find(std::string("can.ahead.samples: invalid value (found \"") + samples),
                  faults.npos)
            << faults;
    }
    EXPECT_EQ(faults_of(with(text, "samples: 200", "samples: 4")), "");
    EXPECT_EQ(faults_of(with(text, "samples: 200", "samples: 1024")), "");
    EXPECT_NE(faults_of(with(text, "id: 0x480", "id: 0x181")).find("0x181 for both"),
              std::string::npos);
    EXPECT_EQ(faults_of(with(kSmallMachine, "format: classical\n",
                             "format: classical\n  ahead: {samples: 200}\n")),
              "m:30: can.ahead: invalid value (found can.ahead with a format other than fd, "
              "expected format: fd, or no such key). The frame has 48 bytes for five axes.\n");
}

const std::string kJog =
    "guard: {single_jog: {speed_mm_min: 300, acceleration_mm_s2: 100, speed_deg_s: 2, "
    "acceleration_deg_s2: 20}, ";

std::string jog_machine() {
    return with(kSmallMachine, "guard: {", kJog);
}

TEST(MachineGuard, AJogIsAPromiseOfItsOwn) {
    EXPECT_FALSE(loaded(kSmallMachine).guard.jog.is_promised);
    const Machine machine = loaded(jog_machine());
    EXPECT_EQ(machine.guard.promise, StopPromise::independent);
    EXPECT_TRUE(machine.guard.jog.is_promised);
    EXPECT_NEAR(machine.guard.jog.speed_mm_s, 5, 1e-12);
    EXPECT_EQ(machine.guard.jog.acceleration_mm_s2, 100);
    EXPECT_NEAR(machine.guard.jog.speed_rad_s, 2 * kPi / 180, 1e-15);
    EXPECT_NEAR(machine.guard.jog.acceleration_rad_s2, 20 * kPi / 180, 1e-15);
    for (const Change& change : {Change{"_min: 300", "_min: 301"}, Change{"_s2: 100", "_s2: 101"},
                                 Change{"_s: 2,", "_s: 3,"}, Change{"_s2: 20", "_s2: 21"}}) {
        const std::string text = jog_machine();
        const std::size_t at = text.find("single_jog");
        const std::string other =
            text.substr(0, at) + with(text.substr(at), change.from, change.to);
        EXPECT_NE(effective_text(loaded(other)), effective_text(machine)) << change.to;
    }
}

TEST(MachineGuard, FaultsOfAJog) {
    const std::string text = jog_machine();
    for (const char* key :
         {"speed_mm_min: 300, ", "acceleration_mm_s2: 100, ", "speed_deg_s: 2, "}) {
        const std::size_t at = text.find("single_jog");
        const std::string faults = faults_of(text.substr(0, at) + with(text.substr(at), key, ""));
        EXPECT_NE(faults.find(std::string("guard.single_jog.").append(key, 11)), std::string::npos)
            << faults;
    }
    EXPECT_NE(faults_of(with(text, "speed_mm_min: 300", "speed_mm_min: 0")).find("found \"0\""),
              std::string::npos);
    EXPECT_NE(faults_of(with(text, "single_jog: {", "single_jog: {speed: 1, "))
                  .find("speed: unknown key (expected one of "),
              std::string::npos);
    Machine machine;
    std::string signals = with(text, "format: classical", "format: signals");
    bool is_said = false;
    for (const ConfigFault& fault : parse_machine(signals, "m", machine)) {
        is_said = is_said || to_string(fault).find("the axis that may move") != std::string::npos;
    }
    EXPECT_TRUE(is_said) << "no place in such frames";
}

TEST(MachineGuard, BothEndsOfEachRange) {
    struct Ends {
        const char *key, *now, *low, *below, *high, *above;
    };
    for (const Ends& e : {
             Ends{"board_reaction_ms", "2", "0", "-0.001", "1000", "1000.1"},
             Ends{"latch_jitter_us", "20", "0", "-1", "10000", "10001"},
             Ends{"cap_lead_ms", "20", "0", "-0.5", "1000", "1000.5"},
             Ends{"overrun_mm", "2", "0", "-0.5", "100", "100.5"},
             Ends{"overrun_deg", "0.5", "0", "-0.5", "10", "10.5"},
             Ends{"level_band_mm", "0.5", "0", "-0.5", "100", "100.5"},
             Ends{"level_hold_samples", "50", "1", "0", "100000", "100001"},
             Ends{"warn_mm", "0", "0", "-0.5", "1000", "1000.5"},
             Ends{"slow_mm", "0", "0", "-0.5", "0", "1000.5"},
             Ends{"position_error_mm", "0.001", "0", "-0.001", "100", "100.5"},
             Ends{"following_error_mm", "0", "0", "-0.001", "100", "100.5"},
         }) {
        const std::string key = std::string{e.key} + ": ", now = key + e.now;
        EXPECT_EQ(faults_of(with(kSmallMachine, now, key + e.low)), "");
        EXPECT_EQ(faults_of(with(kSmallMachine, now, key + e.high)), "");
        for (const char* bad : {e.below, e.above}) {
            const std::string faults = faults_of(with(kSmallMachine, now, key + bad));
            EXPECT_NE(faults.find(std::string{e.key} + ": invalid value (found \"" + bad + "\""),
                      std::string::npos)
                << faults;
            EXPECT_TRUE(faults.starts_with("m:")) << faults;
        }
    }
}

// Full acceleration and braking at once: a value of its own, for axes of either kind.
TEST(MachineGuard, AnAxisMayHaveNoLimitOfJerk) {
    const std::string linear = with(kSmallMachine, "jerk_mm_s3: 50000", "jerk_mm_s3: none");
    const Machine machine = loaded(with(linear, "jerk_deg_s3: 20000", "jerk_deg_s3: none"));
    EXPECT_FALSE(has_jerk_limit(machine.axes[0]));
    EXPECT_TRUE(has_jerk_limit(machine.axes[1]));
    EXPECT_FALSE(has_jerk_limit(machine.axes[2]));
    EXPECT_EQ(machine.axes[2].jerk_max, kNoJerkLimit);
    EXPECT_NE(effective_text(machine), effective_text(loaded(kSmallMachine)));
    EXPECT_NE(faults_of(with(kSmallMachine, "jerk_mm_s3: 50000", "jerk_mm_s3: much")), "");
    EXPECT_NE(faults_of(with(linear, "free_jerk: any", "free_jerk: limited"))
                  .find("guard.free_jerk: invalid value (found limited, and axis X without a jerk "
                        "limit, expected any, or a number for jerk_... of that axis"),
              std::string::npos);
}

// A cap needs a permit that orders it, a sample that acknowledges it, and a longer permit.
TEST(MachineGuard, ACapIsRefusedWhereNothingWouldKeepIt) {
    const std::string capped =
        with(kSmallMachine, "speed_cap: false", "speed_cap: false, cap: all_axes");
    EXPECT_EQ(faults_of(with(capped, "  stale_after_us: 3000\n",
                             "  stale_after_us: 12000\n  permit_samples: 10\n")),
              "m:37: guard.cap: invalid value (found all_axes with one number as "
              "can.permit_samples, expected none, or two numbers, such as [8, 12]). The cap falls "
              "where the longer permit is not proven.\n");
}

TEST(MachineGuard, ACapMayOrderTheEndOfALookAheadPath) {
    const std::string ahead = test::with_can(
        with(test::content_of(test::kPaperMachine), "\nguard:\n", "\nguard:\n  cap: all_axes\n"),
        "  format: fd\n  ahead: {samples: 300}\n");
    Machine machine;
    EXPECT_TRUE(parse_machine(ahead, "m", machine).empty()) << faults_of(ahead);
    EXPECT_EQ(machine.guard.cap, CapPromise::all_axes);
    EXPECT_EQ(machine.can.look_ahead_samples, 300U);
}

TEST(MachineGuard, ACapMakesTheLeastPermitLongerWhereTheFileStatesNone) {
    const auto least = [](const std::string& text) {
        Machine machine;
        EXPECT_TRUE(parse_machine(text, "m", machine).empty()) << faults_of(text);
        return int{machine.can.permit_samples.least};
    };
    const std::string cap =
        with(kSmallMachine, "speed_cap: false", "speed_cap: false, cap: all_axes");
    EXPECT_EQ(least(kSmallMachine), 3);
    EXPECT_EQ(least(cap), 8);
    EXPECT_EQ(least(with(cap, "  stale_after_us: 3000\n",
                         "  stale_after_us: 12000\n  permit_samples: [4, 12]\n")),
              4);
}

TEST(MachineGuard, TheHardestStopIsNoSofterThanTheOthers) {
    const auto with_most = [](const std::string& value) {
        return with(kSmallMachine, "stopping_mm_s2: 1500,",
                    "stopping_mm_s2: 1500, stopping_most_mm_s2: " + value + ",");
    };
    Machine machine;
    ASSERT_TRUE(parse_machine(kSmallMachine, "m", machine).empty());
    EXPECT_EQ(machine.axes[0].stopping_most, std::numeric_limits<double>::infinity());
    ASSERT_TRUE(parse_machine(with_most("20000"), "m", machine).empty());
    EXPECT_EQ(machine.axes[0].stopping_most, 20000);
    const std::string faults = faults_of(with_most("1600"));
    EXPECT_NE(faults.find("axes.X.stopping_most_mm_s2"), std::string::npos) << faults;
    EXPECT_NE(faults.find("the larger of stopping and acceleration"), std::string::npos) << faults;
}

// A gantry changes the hash, and its absence does not.
TEST(MachineGuard, SkewsHaveABoundInSum) {
    const auto with_skew = [](const std::string& text, const std::string& value) {
        return with(text, "stopping_mm_s2: 1500,", "skew_mm: " + value + ", stopping_mm_s2: 1500,");
    };
    Machine machine;
    ASSERT_TRUE(parse_machine(kSmallMachine, "m", machine).empty());
    EXPECT_EQ(machine.axes[0].skew_mm, 0);
    EXPECT_EQ(effective_text(machine).find("skew"), std::string::npos);
    ASSERT_TRUE(parse_machine(with_skew(kSmallMachine, "0.15"), "m", machine).empty());
    EXPECT_EQ(machine.axes[0].skew_mm, 0.15);
    EXPECT_NE(effective_text(machine).find("axes.X.skew_mm = 0.15\n"), std::string::npos);
    EXPECT_NE(faults_of(with_skew(kSmallMachine, "0.151")).find("axes.X.skew_mm"),
              std::string::npos);
    std::string two = with_skew(kSmallMachine, "0.08");
    two.insert(two.find("  A: {"),
               "  Y: {kind: linear, skew_mm: 0.08, travel_mm: [-9, 9], speed_mm_min: 100, "
               "acceleration_mm_s2: 2000, jerk_mm_s3: none, stopping_mm_s2: 1500}\n");
    EXPECT_NE(faults_of(two).find("skew_mm of 0.16 in sum"), std::string::npos) << faults_of(two);
}

TEST(MachineGuard, WordsOfTheFaults) {
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "free_jerk: any", "free_jerk: none")),
        "m:35: guard.free_jerk: invalid value (found \"none\", expected one of any, limited).\n");
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "travel_enforced: false", "travel_enforced: 0")),
        "m:36: guard.travel_enforced: invalid value (found \"0\", expected one of false, true).\n");
    EXPECT_EQ(
        faults_of(with(kSmallMachine, "speed_cap: false", "speed_cap: 250")),
        "m:36: guard.speed_cap: invalid value (found \"250\", expected one of false, true).\n");
    EXPECT_EQ(faults_of(with(kSmallMachine, "stopping_mm_s2: 1500,",
                             "stopping_mm_s2: 1500, position_error_deg: 1,")),
              "m:5: axes.X.position_error_deg: unknown key (expected one of kind, slot, travel_mm, "
              "speed_mm_min, acceleration_mm_s2, jerk_mm_s3, stopping_mm_s2, stopping_most_mm_s2, "
              "position_error_mm, "
              "following_error_mm, skew_mm). Did you mean \"position_error_mm\"?\n");
}

}  // namespace
}  // namespace axg::test
