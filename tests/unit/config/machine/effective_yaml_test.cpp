// SPDX-License-Identifier: Apache-2.0
// The effective configuration as a machine file: reads back to the same configuration, states each
// key that the schema knows, and marks what nobody stated.
#include "config/machine/effective_yaml.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "config/compiled/compiled_machine.hpp"
#include "config/machine/effective_text.hpp"
#include "config/machine/parse_machine.hpp"
#include "tests/support/drive_text.hpp"
#include "tests/support/machine_text.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg {
namespace {

std::string effective_of(const std::string& text) {
    Machine machine;
    const auto faults = parse_machine(text, "m", machine);
    EXPECT_TRUE(faults.empty()) << to_string(faults[0]);
    return effective_yaml({"m", text, {}}, machine);
}

/// The effective form means the same, and has nothing left to fill in.
void expect_same(const std::string& text) {
    Machine before, after;
    ASSERT_TRUE(parse_machine(text, "m", before).empty());
    const std::string effective = effective_yaml({"m", text, {}}, before);
    const auto faults = parse_machine(effective, "m", after);
    ASSERT_TRUE(faults.empty()) << to_string(faults[0]) << '\n' << effective;
    EXPECT_EQ(effective_text(after), effective_text(before)) << effective;
    const std::string again = effective_yaml({"m", effective, {}}, after);
    for (std::size_t at = 0; (at = again.find("# default", at)) != std::string::npos; ++at) {
        const std::size_t line = again.rfind('\n', at) + 1;
        EXPECT_EQ(again.find_first_not_of(' ', line), again.find('#', line))
            << "filled in twice: " << again.substr(line, at - line);
    }
}

TEST(EffectiveYaml, StatedErrorsReadBackAndChangeTheConfiguration) {
    const std::string text = test::with(
        test::with(test::with(test::kSmallMachine, "pivot_mm: [0, 0, -100],",
                              "pivot_mm: [0, 0, -100], pivot_error_mm: 0.05,"),
                   "axis: X, direction: [1, 0, 0],",
                   "axis: X, direction: [1, 0, 0], direction_error_deg: 0.02, place_error_mm: 1,"),
        "name: ball nose, length_mm: 50,", "name: ball nose, length_mm: 50, place_error_mm: 0.2,");
    expect_same(text);
    Machine before, after;
    ASSERT_TRUE(parse_machine(test::kSmallMachine, "m", before).empty());
    ASSERT_TRUE(parse_machine(text, "m", after).empty());
    EXPECT_FALSE(before.pose_errors.are_stated);
    EXPECT_TRUE(after.pose_errors.are_stated);
    const std::string lines = effective_text(after);
    EXPECT_NE(lines.find("bodies.cradle.pivot_error_mm = 0.05\n"), std::string::npos) << lines;
    EXPECT_NE(lines.find("bodies.slide.place_error_mm = 1\n"), std::string::npos) << lines;
    EXPECT_NE(lines.find("tools.1.place_error_mm = 0.2\n"), std::string::npos) << lines;
    EXPECT_NE(lines.find("bodies.slide.direction_error_rad = 0.00034906"), std::string::npos);
    EXPECT_EQ(effective_text(before).find("_error_mm = 0\n"), std::string::npos)
        << "hashes of files without errors stay";
}

TEST(EffectiveYaml, OfEveryShippedMachineReadsBackToTheSame) {
    const std::filesystem::path folder = std::string(AXG_SOURCE_DIR) + "/config/machines";
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".yaml") {
            SCOPED_TRACE(entry.path());
            const std::string text = test::content_of(entry.path().string());
            expect_same(text);
            EXPECT_NE(text.find("\n  permit: 2\n"), std::string::npos) << "stated, not a default";
            EXPECT_NE(text.find("\n  hashes: required"), std::string::npos);
            ++count;
        }
    }
    EXPECT_EQ(count, 5);
}

TEST(EffectiveYaml, OfOtherFormatsAndSectionsReadsBackToTheSame) {
    expect_same(test::kSmallMachine);
    const std::string paper = test::content_of(test::kPaperMachine);
    const std::string drives = test::paper_machine_with_drives(paper, true);
    expect_same(drives);
    expect_same(test::with(test::with(drives, "  sync_counter: 240\n", "  sync: guard\n"),
                           "\nguard:\n", "\nguard:\n  latch_jitter_us: 200\n"));
    expect_same(test::with(test::kSmallMachine, "free_jerk: any",
                           "free_jerk: any, stop_reversal: jerk_limited, limits_broken: report, "
                           "obeyed_by: line"));
    expect_same(test::with(test::kSmallMachine, "free_jerk: any", "free_jerk: any, cap: all_axes"));
    expect_same(test::with_can(paper, "  format: fd\n  ahead: {samples: 300}\n"));
    expect_same(test::with(paper, "hashes: required", "hashes: none"));
    expect_same(test::with(paper, "name: paper-trunnion", "name: 'it''s #1: \"a\\b\"'"));
}

TEST(EffectiveYaml, MarksWhatNobodyStated) {
    const std::string text = effective_of(test::kSmallMachine);
    EXPECT_NE(text.find("name: small\n"), std::string::npos) << text;
    EXPECT_NE(text.find("deadline_us: 500  # default\n"), std::string::npos);
    EXPECT_NE(text.find("    position_error_deg: 0.0005  # default\n"), std::string::npos);
    EXPECT_NE(text.find("    position_error_mm: 0.001\n"), std::string::npos);
    EXPECT_NE(text.find("  hashes_in: 0x582  # default\n"), std::string::npos);
    EXPECT_NE(text.find("  emergency: 0x082  # default\n"), std::string::npos);
    EXPECT_NE(text.find("  heartbeat_timeout_us: 65000  # default\n"), std::string::npos);
}

/// A key that is added to the schema has to be added here.
TEST(EffectiveYaml, StatesEveryKeyOfTheSchema) {
    const std::string schema =
        test::content_of(std::string(AXG_SOURCE_DIR) + "/config/schema/machine.schema.json");
    // It states little itself.
    const std::string all = effective_of(test::content_of(test::kPaperMachine));
    for (const char* const section : {"\"guard\": {", "\"capacities\": {", "\"body\": {",
                                      "\"tool\": {", "\"linear_axis\": {", "\"rotary_axis\": {"}) {
        const std::size_t begin = schema.find(section);
        ASSERT_NE(begin, std::string::npos) << section;
        // Keys of its own properties are indented alike.
        const std::size_t properties = schema.find("\"properties\": {\n", begin);
        const std::size_t first = schema.find('"', schema.find('\n', properties));
        const std::size_t indent = first - schema.find('\n', properties) - 1;
        const std::string end_mark = '\n' + std::string(indent - 2, ' ') + '}';
        const std::string part =
            schema.substr(properties, schema.find(end_mark, properties) - properties);
        const std::string mark = '\n' + std::string(indent, ' ') + '"';
        int keys = 0;
        for (std::size_t at = 0; (at = part.find(mark, at)) != std::string::npos; ++at) {
            const std::size_t name = at + mark.size();
            const std::string key = part.substr(name, part.find('"', name) - name);
            const bool is_tools_choice = key == "profile_mm" || key == "sections" ||
                                         key == "segments" || key == "axis" || key == "pivot_mm" ||
                                         key == "diameter_mm";
            EXPECT_TRUE(is_tools_choice || all.find(' ' + key + ':') != std::string::npos)
                << section << ' ' << key;
            ++keys;
        }
        EXPECT_GT(keys, 3) << section;
    }
}

// What explains a contact is part of the configuration, and its absence changes no hash.
TEST(EffectiveYaml, AnExclusionKeepsItsBecause) {
    const std::string with_because = test::with(test::kSmallMachine, "reason: bearings}",
                                                "reason: bearings, because: the boss passes}");
    expect_same(with_because);
    Machine machine, plain;
    ASSERT_TRUE(parse_machine(with_because, "m", machine).empty());
    ASSERT_TRUE(parse_machine(test::kSmallMachine, "m", plain).empty());
    ASSERT_EQ(machine.exclusions.size(), 6U);
    EXPECT_EQ(machine.exclusions[3].because, "the boss passes");
    EXPECT_EQ(machine.exclusions[4].because, "the boss passes") << "each pair of the line";
    EXPECT_EQ(machine.exclusions[5].because, "");
    EXPECT_NE(effective_text(machine), effective_text(plain));
    EXPECT_EQ(effective_text(plain).find("because"), std::string::npos);
}

}  // namespace
}  // namespace axg
