// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string_view>

#include "config/machine/program_settings.hpp"
#include "config/machine/read_sections.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/machine_text.hpp"
#include "config/text/map_reader.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr double kRadPerDegree = kPi / 180.0;
constexpr std::size_t kStartupCharsMax = 255;  // LinuxCNC's longest line
constexpr Range kPosition{-1e6, 1e6};

/// The axes of a map by their letters. Each value is read by `read(reader, key, axis)`.
template <typename Read>
void read_axis_map(MapReader& section, const char* key, MachineDraft& draft, Read read) {
    const YamlNode* const map =
        section.find(key, Need::optional, "a map of axis letters, such as {C: ...}");
    if (map == nullptr) {
        return;
    }
    MapReader letters{
        *map, section.path_of(key), {"X", "Y", "Z", "A", "B", "C", "U", "V", "W"}, draft.faults};
    for (const YamlEntry& entry : map->entries) {
        const std::uint32_t axis = index_of(draft.machine.axes, entry.key);
        if (axis != kNoIndex) {
            read(letters, entry.key, axis);
        } else if (entry.key.size() == 1 && draft.faults.empty()) {
            letters.report(entry.key, "an axis that the machine lacks", "one of its axes");
        }
    }
}

void read_position(MapReader& section, const char* key, MachineDraft& draft, StoredPosition& out) {
    read_axis_map(section, key, draft,
                  [&](MapReader& letters, const std::string& letter, std::uint32_t axis) {
                      double value = 0;
                      if (letters.number(letter, Need::required, kPosition, value)) {
                          const bool is_rotary = draft.machine.axes[axis].kind == AxisKind::rotary;
                          out[axis] = value * (is_rotary ? kRadPerDegree : 1.0);
                      }
                  });
}

void read_rotary(MapReader& section, MachineDraft& draft, ProgramSettings& out) {
    read_axis_map(
        section, "rotary", draft,
        [&](MapReader& letters, const std::string& letter, std::uint32_t axis) {
            constexpr std::array<std::string_view, 3> kRules{"programmed", "short", "wrapped"};
            std::size_t rule = 0;
            if (!draft.machine.axes[axis].unlimited) {
                letters.report(letter, "an axis with ends", "an endless axis");
            } else if (letters.choice(letter, Need::required, kRules, rule)) {
                out.rotary[axis] = static_cast<RotaryRule>(rule + 1);
            }
        });
}

}  // namespace

void read_program(MapReader& top, MachineDraft& draft, ProgramSettings& out) {
    const YamlNode* const map =
        top.find("program", Need::optional, "a map, such as {start_unit: mm}");
    if (map == nullptr) {
        return;
    }
    MapReader section{*map,
                      "program",
                      {"start_unit", "rotary", "g28", "g30", "startup_code", "arc_tolerance_mm",
                       "arc_tolerance_inch", "program_numbers"},
                      draft.faults};
    constexpr std::array<std::string_view, 2> kUnits{"mm", "inch"};
    std::size_t unit = 0;
    if (section.choice("start_unit", Need::optional, kUnits, unit)) {
        out.starts_in_inch = unit == 1;
    }
    read_rotary(section, draft, out);
    read_position(section, "g28", draft, out.g28);
    read_position(section, "g30", draft, out.g30);
    section.text("startup_code", Need::optional, kStartupCharsMax, out.startup_code);
    section.number("arc_tolerance_mm", Need::optional, {0.001, 10}, out.arc_tolerance_mm);
    section.number("arc_tolerance_inch", Need::optional, {0.00004, 1}, out.arc_tolerance_inch);
    section.boolean("program_numbers", Need::optional, out.takes_program_numbers);
}

ProgramSettings program_settings(const MachineText& source, const Machine& machine) {
    ProgramSettings settings;
    FaultList faults{source.file};
    YamlNode root;
    const NamedFiles no_files;
    MachineDraft draft{.machine = {}, .faults = faults, .files = no_files};
    draft.machine.axes = machine.axes;
    if (parse_yaml(source.text, faults, root) && root.kind == YamlNode::Kind::map) {
        FaultList other_keys{source.file};
        MapReader top{root, "", {"program"}, other_keys};
        read_program(top, draft, settings);
    }
    return settings;
}

}  // namespace axg
