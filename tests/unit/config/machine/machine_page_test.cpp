// SPDX-License-Identifier: Apache-2.0
// The page that explains the machine file must itself be right: its examples are read from it and
// loaded.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "config/machine/parse_machine.hpp"
#include "config/mesh/load_meshes.hpp"
#include "core/base/sincos.hpp"
#include "tests/support/drive_text.hpp"
#include "tests/support/page_text.hpp"

namespace axg {
namespace {

std::vector<std::string> blocks_of(const std::string& language) {
    return test::blocks_of(test::page_of("reference/machine-file.md"), language);
}

std::vector<std::string> yaml_blocks() {
    return blocks_of("yaml");
}

std::string printed(const std::vector<ConfigFault>& faults) {
    std::string out;
    for (const ConfigFault& fault : faults) {
        out += to_string(fault) + '\n';
    }
    return out;
}

TEST(MachinePage, TheExampleLoadsAndMeansWhatItSays) {
    ASSERT_EQ(yaml_blocks().size(), 8U);
    Machine machine;
    EXPECT_EQ(printed(parse_machine(yaml_blocks()[0], "page", machine)), "");
    ASSERT_EQ(machine.axes.size(), 4U);
    EXPECT_EQ(machine.axes[0].speed_max, 10000.0 / 60.0);
    EXPECT_EQ(machine.axes[2].kind, AxisKind::rotary);
    EXPECT_EQ(machine.axes[2].min, -110 * kPi / 180.0);
    EXPECT_TRUE(machine.axes[3].unlimited);
    ASSERT_EQ(machine.bodies.size(), 5U);
    EXPECT_EQ(machine.bodies[1].parent, 0U);
    EXPECT_EQ(machine.bodies[1].joint.pivot_mm, (Vec3d{0, 0, -100}));
    EXPECT_EQ(machine.bodies[1].mesh.where, "page:23");
    EXPECT_TRUE(machine.bodies[4].is_tool);
    ASSERT_EQ(machine.tools.size(), 2U);
    EXPECT_EQ(machine.tools[1].mesh.shapes.at(0).profile.size(), 6U);
    EXPECT_EQ(machine.first_tool, 1);
    EXPECT_EQ(machine.pairs.size(), 6U);
    EXPECT_EQ(machine.exclusions.size(), 4U);
    EXPECT_EQ(machine.pairs[3].margin_mm, 1.5);
}

TEST(MachinePage, TheCapacitiesShownAreTheDefaults) {
    Machine machine;
    ASSERT_EQ(printed(parse_machine(yaml_blocks()[0], "page", machine)), "");
    EXPECT_EQ(machine.engine, EngineChoice::automatic);
    const Capacities &shown = machine.capacities, silent;
    EXPECT_EQ(shown.node_pairs, silent.node_pairs);
    EXPECT_EQ(shown.triangle_pairs, silent.triangle_pairs);
    EXPECT_EQ(shown.rechecks, silent.rechecks);
    EXPECT_EQ(shown.batch.level_pairs, silent.batch.level_pairs);
    EXPECT_EQ(shown.batch.leaf_pairs, silent.batch.leaf_pairs);
    EXPECT_EQ(shown.batch.box_rows, silent.batch.box_rows);
    EXPECT_EQ(shown.batch.triangle_pairs, silent.batch.triangle_pairs);
    EXPECT_EQ(shown.batch.rechecks, silent.batch.rechecks);
}

/// The page's file, and the same from `section` up to the capacities left out.
struct ShownAndSilent {
    Machine shown, silent;
};
ShownAndSilent with_and_without(const std::string& section) {
    const std::string whole = yaml_blocks()[0];
    const std::size_t begin = whole.find("\n" + section + ":") + 1;
    const std::string without = whole.substr(0, begin) + whole.substr(whole.find("capacities:"));
    ShownAndSilent out;
    EXPECT_EQ(printed(parse_machine(whole, "page", out.shown)), "");
    EXPECT_EQ(printed(parse_machine(without, "page", out.silent)), "");
    return out;
}

// What the page calls defaults is what a file without the section gets.
TEST(MachinePage, TheCanSectionShownIsTheDefault) {
    const auto [shown, silent] = with_and_without("can");
    EXPECT_EQ(shown.can.axis_ids, silent.can.axis_ids);
    EXPECT_EQ(shown.can.data_ids, silent.can.data_ids);
    EXPECT_EQ(shown.can.sync_id, silent.can.sync_id);
    EXPECT_EQ(shown.can.permit_id, silent.can.permit_id);
    EXPECT_EQ(shown.can.stop_id, silent.can.stop_id);
    EXPECT_EQ(shown.can.emergency_id, silent.can.emergency_id);
    EXPECT_EQ(shown.can.heartbeat_in_id, silent.can.heartbeat_in_id);
    EXPECT_EQ(shown.can.heartbeat_out_id, silent.can.heartbeat_out_id);
    EXPECT_EQ(shown.can.sample_us, silent.can.sample_us);
    EXPECT_EQ(shown.can.stale_after_us, silent.can.stale_after_us);
    EXPECT_EQ(shown.can.hashes_in_id, silent.can.hashes_in_id);
    EXPECT_EQ(shown.can.hashes_out_id, silent.can.hashes_out_id);
    EXPECT_EQ(shown.can.permit_samples, silent.can.permit_samples);
    EXPECT_EQ(shown.can.frozen_samples, silent.can.frozen_samples);
    EXPECT_EQ(shown.can.counter_delta_max, silent.can.counter_delta_max);
    EXPECT_EQ(shown.can.heartbeat_timeout_us, silent.can.heartbeat_timeout_us);
}

TEST(MachinePage, TheGuardSectionShownIsTheDefault) {
    const auto [shown, silent] = with_and_without("guard");
    EXPECT_EQ(effective_text(shown), effective_text(silent));
    const std::string whole = yaml_blocks()[0];
    const std::size_t begin = whole.find("\nguard:");
    for (const char* key :
         {"promise", "board_reaction_ms", "latch_jitter_us", "free_jerk", "obeyed_by",
          "stop_reversal", "limits_broken", "travel_enforced", "speed_cap", "cap_lead_ms", "cap",
          "travel_proofs", "overrun_mm", "overrun_deg", "slow_mm", "warn_mm", "level_band_mm",
          "level_hold_samples"}) {
        EXPECT_NE(whole.find(std::string("\n  ") + key + ": ", begin), std::string::npos) << key;
    }
}

/// The page's file with one more body and one more tool.
std::string with_examples_without_files() {
    std::string text = yaml_blocks()[0];
    text.insert(text.find("  - {name: z, axis: Z"), yaml_blocks()[1]);
    text.insert(text.find("first_tool:"), yaml_blocks()[2]);
    const std::string pair = "  - {a: z, b: cutter, reason:";
    return text.insert(text.find(pair), "  - {a: vice, b: [x, a, c, z, cutter], reason: shown}\n");
}

TEST(MachinePage, TheExamplesWithoutFilesLoadAndAreSurfaces) {
    Machine machine;
    EXPECT_EQ(printed(parse_machine(with_examples_without_files(), "page", machine)), "");
    ASSERT_EQ(machine.bodies.size(), 6U);
    ASSERT_EQ(machine.tools.size(), 3U);
    Machine alone;  // without the files, which nobody has
    alone.bodies.push_back(machine.bodies[3]);
    alone.tools.push_back(machine.tools[2]);
    MachineMeshes meshes;
    EXPECT_EQ(printed(load_meshes(alone, "/", meshes)), "");
    EXPECT_EQ(alone.bodies[0].mesh.shapes.size(), 6U);
    EXPECT_GT(meshes.bodies.at(0).triangles.size(), 3U * 12U);
    EXPECT_EQ(alone.tools[0].mesh.shapes.at(2).name, "holder");
    EXPECT_GT(meshes.tools.at(0).triangles.size(), 0U);
}

TEST(MachinePage, TheSignalExampleLoadsInPlaceOfTheCanSection) {
    const std::string whole = yaml_blocks()[0];
    const std::size_t begin = whole.find("\ncan:") + 1;
    const std::string text =
        whole.substr(0, begin) + yaml_blocks()[3] + whole.substr(whole.find("capacities:"));
    Machine machine;
    EXPECT_EQ(printed(parse_machine(text, "page", machine)), "");
    ASSERT_EQ(machine.can.signals.size(), 4U);
    EXPECT_EQ(machine.can.signals[3].axis, 3U);
    EXPECT_EQ(machine.can.signals[3].start_bit, 39);
    EXPECT_EQ(machine.can.signals[3].order, ByteOrder::big);
    EXPECT_TRUE(machine.can.axis_ids.empty());
}

TEST(MachinePage, TheExampleOfLookAheadLoadsInPlaceOfBothSections) {
    const std::string whole = yaml_blocks()[0];
    const std::size_t begin = whole.find("\ncan:") + 1;
    const std::string text =
        whole.substr(0, begin) + yaml_blocks()[6] + whole.substr(whole.find("capacities:"));
    Machine machine;
    EXPECT_EQ(printed(parse_machine(text, "page", machine)), "");
    const CanLayout usual;
    EXPECT_EQ(machine.can.look_ahead_id, usual.look_ahead_id);
    EXPECT_EQ(machine.can.look_ahead_data_id, usual.look_ahead_data_id);
    EXPECT_EQ(machine.can.look_ahead_samples, 300U);
    EXPECT_EQ(machine.guard.promise, StopPromise::path_keeping);
}

TEST(MachinePage, TheJogExampleLoadsInPlaceOfTheGuardSection) {
    const std::string whole = yaml_blocks()[0];
    const std::string text = whole.substr(0, whole.find("\nguard:") + 1) + yaml_blocks()[7] +
                             whole.substr(whole.find("capacities:"));
    Machine machine;
    EXPECT_EQ(printed(parse_machine(text, "page", machine)), "");
    EXPECT_TRUE(machine.guard.jog.is_promised);
    EXPECT_EQ(machine.guard.jog.speed_mm_s, 5);
}

/// The whole example with another section `can`, and the text of the file that it names.
std::string faults_with(std::size_t block, const std::string& file, Machine& machine) {
    const std::string whole = yaml_blocks()[0];
    const std::string text = whole.substr(0, whole.find("\ncan:") + 1) + yaml_blocks()[block] +
                             whole.substr(whole.find("capacities:"));
    return printed(parse_machine(text, "page", machine, [&file](const std::string&, std::size_t) {
        return NamedFile{file, {}, {}};
    }));
}

TEST(MachinePage, TheDbcExampleLoadsWithTheFileBesideIt) {
    ASSERT_EQ(blocks_of("dbc").size(), 1U);
    Machine machine;
    ASSERT_EQ(faults_with(4, blocks_of("dbc")[0], machine), "");
    ASSERT_EQ(machine.can.signals.size(), 9U);
    EXPECT_EQ(machine.can.signals[2].type, SignalType::float32);
}

TEST(MachinePage, TheDrivesExampleLoads) {
    Machine machine;
    ASSERT_EQ(faults_with(5, test::kDriveEds, machine),
              "drive.dcf:4: devicecomissioning.nodeid: invalid value (found 5 (machine file: 3), "
              "expected the file of this drive, or its node number).\n")
        << "a DCF file of another node";
    std::string other = test::kDriveEds;
    other.replace(other.find("NodeID=5"), 8, "NodeID=3");
    ASSERT_EQ(faults_with(5, other, machine), "");
    EXPECT_EQ(machine.can.signals.size(), 9U);
    EXPECT_EQ(machine.can.permit_samples, (PermitSamples{4, 4}));
}

}  // namespace
}  // namespace axg
