// SPDX-License-Identifier: Apache-2.0
// A compiled machine is believed by every axguard that reads its format. So the same input has to
// come to the same bytes as long as the format's number is the same: surfaces from files, shapes,
// sections, what is left of cutters, and what the travel prunes. Only the text and the version,
// which the reader compares by itself, and the notes for people may change without it.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "config/compiled/compiled_machine.hpp"
#include "core/base/crc32.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "tests/support/replay_fixture.hpp"

namespace axg::test {
namespace {

constexpr const char* kMachine = R"(version: 1
name: format
axes:
  X: {kind: linear, travel_mm: [-150, 150], speed_mm_min: 9000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
  Z: {kind: linear, travel_mm: [-200, 0], speed_mm_min: 9000, acceleration_mm_s2: 2000,
      jerk_mm_s3: 50000, stopping_mm_s2: 1500}
  C: {kind: rotary, travel_deg: unlimited, speed_deg_s: 90, acceleration_deg_s2: 500,
      jerk_deg_s3: 10000, stopping_deg_s2: 400}
bodies:
  - name: slide
    axis: X
    direction: [-1, 0, 0]
    mesh: {file: a.stl, unit: mm}
    at_mm: [0, 0, -500]
  - name: plate
    parent: slide
    axis: C
    direction: [0, 0, 1]
    pivot_mm: [0, 0, 0]
    mesh: {shapes: [{cylinder: {radius_mm: 80, height_mm: 30}}, {box_mm: [20, 150, 40]}]}
    at_mm: [0, 0, -330]
  - name: blank
    parent: plate
    stock: true
    mesh: {shapes: [{sphere: {radius_mm: 40}, segments: 80}]}
    at_mm: [0, 0, -260]
  - name: head
    axis: Z
    direction: [0, 0, 1]
    mesh: {shapes: [{cone: {radius_mm: 40, top_radius_mm: 60, height_mm: 100}}]}
  - {name: cutter, parent: head, tool: true}
tools:
  - number: 1
    length_mm: 80
    sections:
      - {name: flutes, cutting: true, cylinder: {radius_mm: 4, height_mm: 25}, at_mm: [0, 0, -80]}
      - {name: shank, cylinder: {radius_mm: 4, height_mm: 25}, at_mm: [0, 0, -55]}
      - {name: holder, profile_mm: [[0, -30], [20, -30], [30, 0], [0, 0]]}
  - {number: 2, length_mm: 100, size_is_right: true, mesh: {file: cutter.stl, unit: mm}}
pairs:
  - {a: cutter, b: [slide, plate, blank], margin_mm: 1}
  - {a: head, b: [slide, plate, blank], margin_mm: 2}
exclusions:
  - {a: plate, b: [slide, blank], reason: bearing and clamp}
  - {a: slide, b: blank, reason: the plate lies between}
  - {a: head, b: cutter, reason: the tool sits in it}
guard: {travel_proofs: true}
)";

/// Of every section but text and notes, tags included.
std::uint32_t sum_of(const std::string& compiled) {
    std::vector<SectionView> sections;
    EXPECT_EQ(take_sections(compiled, Sums::checked, sections).got, "");
    std::string bytes;
    for (const SectionView& section : sections) {
        if (section.tag != "TEXT" && section.tag != "NOTE") {
            bytes += section.tag;
            bytes += section.payload;
        }
    }
    return crc32({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

TEST(CompiledFormat, TheSameInputIsTheSameBytesAsLongAsItsNumberIs) {
    const Workshop shop;
    for (const char* const name : {"a.stl", "cutter.stl"}) {
        std::filesystem::copy_file(source_file("config/machines/meshes/paper-trunnion/") + name,
                                   shop.file(name));
    }
    LoadedMachine loaded;
    ASSERT_TRUE(load(shop.write("format.yaml", kMachine), "", loaded, stderr));
    ASSERT_EQ(loaded.machine.pair_surfaces.size(), 1U);
    ASSERT_FALSE(loaded.machine.travel.proofs.empty());
    EXPECT_EQ(kCompiledVersion, 6U);
    EXPECT_EQ(sum_of(compile_machine(loaded)), 2519521096U)
        << "what a machine is compiled to has changed: raise kCompiledVersion, so that no file "
           "from "
           "before is believed, and state both here";
}

}  // namespace
}  // namespace axg::test
