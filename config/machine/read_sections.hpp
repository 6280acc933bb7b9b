// SPDX-License-Identifier: Apache-2.0
// The sections of a machine file, but for `can` (config/can/read_can.hpp): each function reads one.
#pragma once

#include <string>

#include "config/text/machine_draft.hpp"

namespace axg {

class MapReader;
struct ProgramSettings;
struct YamlNode;

// Each reads one section of the file. Faults go to draft.faults; what could be read is in
// draft.machine.
void read_axes(MapReader& top, MachineDraft& draft);
void read_bodies(MapReader& top, MachineDraft& draft);
void read_tools(MapReader& top, MachineDraft& draft);
void read_guard(MapReader& top, MachineDraft& draft);  // after `can`: look-ahead path
/// And exclusions: the complete matrix. After `guard`: usual clearance levels.
void read_pairs(MapReader& top, MachineDraft& draft);
void read_output_line(MapReader& top, MachineDraft& draft);
void read_capacities(MapReader& top, MachineDraft& draft);
void read_cycle(MapReader& top, MachineDraft& draft);
/// After `axes`.
void read_program(MapReader& top, MachineDraft& draft, ProgramSettings& out);

// Parts that bodies and tools share.
void read_mesh(const YamlNode& node, const std::string& path, FaultList& faults, MeshSource& out);
/// at_mm and rotate_deg.
void read_placement(MapReader& reader, Pose& out);
/// slow_mm and warn_mm, of a pair or of all that state none: `levels` has what holds without them.
void read_clearance_levels(MapReader& reader, ClearanceLevelDistances& clearance_levels);

}  // namespace axg
