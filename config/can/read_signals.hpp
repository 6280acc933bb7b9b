// SPDX-License-Identifier: Apache-2.0
// Location of each axis position in the frames of a foreign board: from the machine file, from a
// DBC file that it names, or in the mapping of drives.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace axg {

class MapReader;
struct CanLayout;
struct MachineDraft;

struct NamedId {
    std::uint32_t id;
    std::string name;
};

/// `signals` and `signal_frame_bytes`: one signal for each axis, inside its frame, overlapping no
/// other, and wide enough for the axis' travel. Without format: signals both keys are faults.
void read_signals(MapReader& can, MachineDraft& draft);

/// `file`, `axes`, `status` and `counters` of format: dbc: the signals that a DBC file describes,
/// as format signals has them. Without format: dbc these keys are faults.
void read_dbc(MapReader& can, MachineDraft& draft);

/// `drives`, `sync_counter` and `sync_window_us` of format: cia402: each axis is a drive, whose
/// process data are signals. Without format: cia402 these keys are faults.
void read_drives(MapReader& can, MachineDraft& draft);

/// Rejects a signal whose identifier another frame uses.
void check_signal_ids(MapReader& can, const CanLayout& layout, std::span<const NamedId> others);

}  // namespace axg
