// SPDX-License-Identifier: Apache-2.0
// A sound machine file, broken key by key in every way that people and editors break files. Each
// break must be refused, and some fault must point at the broken line. Text that stays sound is
// counted apart, never skipped over.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <random>

#include "config/text/fault_list.hpp"
#include "config/text/yaml_tree.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/seed.hpp"

namespace axg::test {
namespace {

// One key a line, so that a line can be broken alone. JSON-like values keep their lists on it.
constexpr const char* kTallMachine =
    R"(version: 1
name: tall
deadline_us: 400
program_speed_mm_min: 9000
axes:
  X:
    kind: linear
    travel_mm: [-300, 300]
    speed_mm_min: 10000
    acceleration_mm_s2: 2000
    jerk_mm_s3: 50000
    stopping_mm_s2: 1500
    position_error_mm: 0.002
    following_error_mm: 0.01
  A:
    kind: rotary
    travel_deg: [-110, 30]
    speed_deg_s: 90
    acceleration_deg_s2: 500
    jerk_deg_s3: 10000
    stopping_deg_s2: 400
    position_error_deg: 0.001
    following_error_deg: 0.01
bodies:
  - name: slide
    axis: X
    direction: [1, 0, 0]
    at_mm: [0, 0, 1]
    rotate_deg: [0, 90, 0]
    mesh:
      file: slide.stl
      unit: inch
      sha256: 9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08
      size_mm: [10, 20, 30]
      allow_open: true
      allow_self_intersection: true
      allow_degenerate: false
  - name: cradle
    parent: slide
    axis: A
    direction: [1, 0, 0]
    pivot_mm: [0, 0, -100]
    mesh:
      file: cradle.stl
      unit: mm
  - name: cutter
    tool: true
tools:
  - number: 1
    name: drill
    length_mm: 90
    profile_mm: [[0, -90], [4, -86], [4, 0], [0, 0]]
    segments: 24
    at_mm: [0, 0, 0]
    rotate_deg: [0, 0, 0]
first_tool: 1
pairs:
  - a: cutter
    b: [slide, cradle]
    margin_mm: 0.5
    slow_mm: 2
    warn_mm: 5
exclusions:
  - a: slide
    b: cradle
    reason: bearings
can:
  format: signals
  sample_us: 1000
  permit_samples: 3
  stale_after_us: 3000
  frozen_samples: 100
  counter_delta_max: 3
  heartbeat_timeout_us: 40000
  arrival_jitter_us: 150
  signal_frame_bytes: 8
  ids:
    sync: 0x080
    permit: 0x103
    stop: 0x001
    emergency: 0x082
    heartbeat_in: 0x701
    heartbeat_out: 0x702
  signals:
    X:
      id: 0x181
      start: 0
      length: 32
      order: little
      signed: true
      factor: 1.0e-4
      offset: 0
      unit: mm
    A:
      id: 0x182
      start: 7
      length: 32
      order: big
      signed: true
      factor: 1.0e-4
      unit: deg
cycle:
  stages: 3
  queries: 300
  lists:
    node_pairs: 256
    leaf_pairs: 300
    box_rows: 1000
    triangle_pairs: 3000
    rechecks: 8
guard:
  promise: independent
  board_reaction_ms: 1.5
  latch_jitter_us: 10
  free_jerk: limited
  obeyed_by: drives
  travel_enforced: true
  speed_cap: true
  cap_lead_ms: 35
  cap: none
  travel_proofs: true
  overrun_mm: 1
  overrun_deg: 0.25
  slow_mm: 0
  warn_mm: 3
  level_band_mm: 0.4
  level_hold_samples: 20
capacities:
  node_pairs: 8192
  triangle_pairs: 65536
  rechecks: 1024
  batch:
    level_pairs: 1024
    leaf_pairs: 1024
    box_rows: 6144
    triangle_pairs: 16384
    rechecks: 512
engine: auto
)";

struct Line {
    std::string indent, key, value;  // indent includes "- "; value without the blank before it
};

std::vector<Line> lines_of(const std::string& text) {
    std::vector<Line> out;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text.find('\n', at);
        const std::string line = text.substr(at, end - at);
        const std::size_t key = line.find_first_not_of(" -");
        const std::size_t colon = line.find(':', key);
        const std::size_t value = line.find_first_not_of(' ', colon + 1);
        out.push_back({line.substr(0, key), line.substr(key, colon - key),
                       value == std::string::npos ? "" : line.substr(value)});
        at = end + 1;
    }
    return out;
}

std::string joined(const std::vector<Line>& lines) {
    std::string text;
    for (const Line& line : lines) {
        text += line.indent + line.key + ':' + (line.value.empty() ? "" : " " + line.value) + '\n';
    }
    return text;
}

/// Lines of the faults of a text; empty when it is sound.
std::vector<int> fault_lines(const std::string& text) {
    Machine machine;
    std::vector<int> out;
    for (const ConfigFault& fault : parse_machine(text, "m", machine)) {
        out.push_back(std::stoi(fault.where.substr(fault.where.find(':') + 1)));
    }
    return out;
}

class Mutator : public testing::Test {
  protected:
    const std::vector<Line> sound = lines_of(kTallMachine);
    std::map<std::string, int> count;

    /// The text must be refused with a fault on line `index` (from 0).
    void expect_refused(const char* way, const std::vector<Line>& broken, std::size_t index) {
        const std::string text = joined(broken);
        const std::vector<int> lines = fault_lines(text);
        const int wanted = static_cast<int>(index) + 1;
        EXPECT_NE(std::find(lines.begin(), lines.end(), wanted), lines.end())
            << way << ", line " << wanted << ":\n"
            << faults_of(text);
        ++count[way];
    }
    void expect_value_refused(const char* way, std::size_t index, const std::string& value) {
        std::vector<Line> broken = sound;
        broken[index].value = value;
        expect_refused(way, broken, index);
    }
    void TearDown() override {
        int total = 0;
        for (const auto& [way, times] : count) {
            std::printf("  %-28s %d\n", way.c_str(), times);
            total += times;
        }
        std::printf("  refused in all: %d\n", total);
    }
    static bool is_number(const std::string& value) {
        return !value.empty() && value.size() < 20 && value.find_first_of("[ xz") == value.npos &&
               (value[0] == '-' || (value[0] >= '0' && value[0] <= '9'));
    }
    static bool is_hex(const std::string& value) { return value.starts_with("0x"); }
    static bool is_list(const std::string& value) { return value.starts_with("["); }
};

TEST_F(Mutator, TheFileItBreaksIsSound) {
    EXPECT_EQ(faults_of(kTallMachine), "");
    EXPECT_EQ(joined(sound), kTallMachine);
}

TEST_F(Mutator, EveryBrokenKeyIsRefusedOnItsLine) {
    for (std::size_t i = 0; i < sound.size(); ++i) {
        const auto with_key = [&](const char* way, const std::string& key) {
            std::vector<Line> broken = sound;
            broken[i].key = key;
            expect_refused(way, broken, i);
        };
        const std::string& key = sound[i].key;
        const bool is_axis = key == "X" || key == "A";  // a name of the user's own: other rules
        with_key(is_axis ? "small letter" : "letter added", is_axis ? "x" : key + "s");
        with_key("look-alike letter", "\xD0\xB0" + key.substr(1));
        with_key("wide letter", key + "\xEF\xBD\x81");
        if (!is_axis) {
            with_key("capital letter",
                     std::string(1, static_cast<char>(key[0] - 32)) + key.substr(1));
            with_key("letter lost", key.substr(1));
            if (key.size() > 1 && key[0] != key[1]) {
                std::string swapped = key;
                std::swap(swapped[0], swapped[1]);
                with_key("letters swapped", swapped);
            }
        }
        if (!sound[i].value.empty()) {
            std::vector<Line> twice = sound;
            Line again = sound[i];
            std::replace(again.indent.begin(), again.indent.end(), '-', ' ');
            twice.insert(twice.begin() + static_cast<std::ptrdiff_t>(i) + 1, again);
            expect_refused("key twice", twice, i + 1);
        }
    }
}

TEST_F(Mutator, EveryBrokenValueIsRefusedOnItsLine) {
    for (std::size_t i = 0; i < sound.size(); ++i) {
        const std::string& value = sound[i].value;
        if (value.empty()) {
            continue;
        }
        expect_value_refused("no value", i, "");
        expect_value_refused("null", i, "~");
        expect_value_refused("tag", i, "!!str " + value);
        expect_value_refused("anchor", i, "&here " + value);
        expect_value_refused("map", i, "{a: 1}");
        if (is_number(value) || is_hex(value)) {
            for (const char* bad :
                 {".nan", "NaN", ".inf", "-.inf", "1e999", "99999999999999", "-99999999999", "+1",
                  "1_0",  "1,5", "12mm", "0o17",  "017",   "\"1\"",          "one",          "true",
                  "[1]",  "1 2", "0x",   "--1",   "1."}) {
                expect_value_refused("bad number", i, bad);
            }
        }
        if (is_number(value)) {
            expect_value_refused("hexadecimal", i, "0x10");
        }
        if (is_list(value) && value.find_first_of("0123456789") != std::string::npos) {
            const std::size_t digit = value.find_first_of("0123456789");
            for (const char* bad : {"nan", "1e999", "07", "x", "~", "[1, 2]", "1e9"}) {
                std::string broken = value;
                expect_value_refused("bad number in a list", i, broken.replace(digit, 1, bad));
            }
            expect_value_refused("list too short", i, "[1]");
            expect_value_refused("scalar for a list", i, "1");
        }
        if (value == "true" || value == "false") {
            for (const char* bad : {"yes", "on", "True", "1", "\"true\"", "[true]"}) {
                expect_value_refused("bad switch", i, bad);
            }
        }
    }
}

// The order in travel, and what only makes sense in relation to another key.
TEST_F(Mutator, SwappedLimitsAreRefusedOnTheirLine) {
    for (std::size_t i = 0; i < sound.size(); ++i) {
        if (sound[i].key == "travel_mm" || sound[i].key == "travel_deg") {
            const std::string& value = sound[i].value;
            const std::size_t comma = value.find(", ");
            expect_value_refused("limits swapped", i,
                                 "[" + value.substr(comma + 2, value.size() - comma - 3) + ", " +
                                     value.substr(1, comma - 1) + "]");
        }
    }
    EXPECT_EQ(count["limits swapped"], 2);
}

// A key taken away: refused, unless the page calls it optional. Both lists are spelled out.
TEST_F(Mutator, EveryDroppedKeyIsRefusedUnlessItIsOptional) {
    const std::vector<std::string> optional{"deadline_us",
                                            "program_speed_mm_min",
                                            "at_mm",
                                            "rotate_deg",
                                            "sha256",
                                            "size_mm",
                                            "allow_open",
                                            "allow_self_intersection",
                                            "allow_degenerate",
                                            "parent",
                                            "segments",
                                            "first_tool",
                                            "sample_us",
                                            "permit_samples",
                                            "stale_after_us",
                                            "frozen_samples",
                                            "counter_delta_max",
                                            "heartbeat_timeout_us",
                                            "arrival_jitter_us",
                                            "signal_frame_bytes",
                                            "sync",
                                            "permit",
                                            "stop",
                                            "emergency",
                                            "heartbeat_in",
                                            "heartbeat_out",
                                            "hashes_in",
                                            "hashes_out",
                                            "offset",
                                            "node_pairs",
                                            "triangle_pairs",
                                            "rechecks",
                                            "level_pairs",
                                            "leaf_pairs",
                                            "box_rows",
                                            "engine",
                                            "position_error_mm",
                                            "following_error_mm",
                                            "position_error_deg",
                                            "following_error_deg",
                                            "promise",
                                            "board_reaction_ms",
                                            "latch_jitter_us",
                                            "free_jerk",
                                            "obeyed_by",
                                            "travel_enforced",
                                            "cycle",
                                            "stages",
                                            "queries",
                                            "lists",
                                            "speed_cap",
                                            "cap_lead_ms",
                                            "cap",
                                            "travel_proofs",
                                            "overrun_mm",
                                            "overrun_deg",
                                            "slow_mm",
                                            "warn_mm",
                                            "level_band_mm",
                                            "level_hold_samples"};
    for (std::size_t i = 0; i < sound.size(); ++i) {
        if (sound[i].value.empty() || sound[i].indent.ends_with("- ")) {
            continue;  // whole sections are the business of the cut file in machine_limits
        }
        std::vector<Line> broken = sound;
        broken.erase(broken.begin() + static_cast<std::ptrdiff_t>(i));
        const bool is_tool_name = sound[i].key == "name" && sound[i].value == "drill";
        const bool may_go = is_tool_name || std::find(optional.begin(), optional.end(),
                                                      sound[i].key) != optional.end();
        EXPECT_EQ(fault_lines(joined(broken)).empty(), may_go) << sound[i].key;
        ++count[may_go ? "optional key dropped" : "key dropped"];
    }
}

// Anything may happen to a byte. Whatever it is: an answer, and never a machine that breaks its own
// promises.
TEST_F(Mutator, RandomBytesNeverYieldAMachineThatBreaksItsPromises) {
    std::mt19937_64 random{printed_seed(20261120)};
    const std::string text = kTallMachine;
    int accepted = 0;
    constexpr int kRuns = 4000;
    for (int run = 0; run < kRuns; ++run) {
        std::string broken = text;
        for (std::uint64_t changes = random() % 4 + 1; changes > 0; --changes) {
            const std::size_t at = random() % broken.size();
            switch (random() % 4) {
                case 0:
                    broken[at] = static_cast<char>(random() % 256);
                    break;
                case 1:
                    broken.erase(at, random() % 8 + 1);
                    break;
                case 2:
                    broken.insert(at, text.substr(random() % text.size(), random() % 40));
                    break;
                default:
                    broken[at] = "[]{}:,-\"'#&*!|>%@` \n0123456789"[random() % 31];
            }
        }
        Machine machine;
        if (!parse_machine(broken, "m", machine).empty()) {
            EXPECT_TRUE(machine.axes.empty());
            continue;
        }
        ++accepted;
        for (const Axis& axis : machine.axes) {
            EXPECT_TRUE(axis.unlimited || axis.min < axis.max);
            EXPECT_GT(axis.stopping_min, 0);
        }
        for (std::uint32_t i = 0; i < machine.bodies.size(); ++i) {
            const Body& body = machine.bodies[i];
            EXPECT_TRUE(body.parent == kNoIndex || body.parent < i);
            EXPECT_TRUE(body.joint.axis == kNoIndex || body.joint.axis < machine.axes.size());
        }
        const std::size_t surfaces = static_cast<std::size_t>(
            std::count_if(machine.bodies.begin(), machine.bodies.end(),
                          [](const Body& body) { return body.has_mesh || body.is_tool; }));
        EXPECT_EQ(machine.pairs.size() + machine.exclusions.size(), surfaces * (surfaces - 1) / 2);
    }
    std::printf("  %d random breaks: %d refused, %d left a sound file\n", kRuns, kRuns - accepted,
                accepted);
    EXPECT_GT(accepted, 0);
    EXPECT_LT(accepted, kRuns / 2);
}

}  // namespace
}  // namespace axg::test
