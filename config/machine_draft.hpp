// SPDX-License-Identifier: Apache-2.0
// A machine being read: the plain data so far, and where each part of it stands in the file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/parse_machine.hpp"
#include "core/machine.hpp"

namespace axg {

class FaultList;
class MapReader;
struct YamlNode;

/// What the machine file says about frames; CanFormat says what the receiver makes of it.
enum class CanSource : std::uint8_t { classical, fd, signals, dbc, cia402 };

/// Beyond the margin of a pair.
struct PairLevels {
    double slow_mm = 0, warn_mm = 0;
};

struct MachineDraft {
    Machine machine;
    FaultList& faults;
    const NamedFiles& files;
    CanSource can_source = CanSource::classical;
    std::vector<int> axis_lines{}, body_lines{}, tool_lines{};
    PairLevels usual_levels{};       // of pairs that state none
    bool surfaces_are_sound = true;  // each body says readably whether it is the tool
    bool names_are_sound =
        true;  // else a missing pair would be reported twice: once for its misspelt body
};

// Each reads one section of the file. Faults go to draft.faults; what could be read is in
// draft.machine.
void read_axes(MapReader& top, MachineDraft& draft);
void read_bodies(MapReader& top, MachineDraft& draft);
void read_tools(MapReader& top, MachineDraft& draft);
void read_can(MapReader& top, MachineDraft& draft);
void read_guard(MapReader& top, MachineDraft& draft);  // after `can`: commands ahead
/// And exclusions: the complete matrix. After `guard`: usual levels.
void read_pairs(MapReader& top, MachineDraft& draft);
void read_output_line(MapReader& top, MachineDraft& draft);
void read_capacities(MapReader& top, MachineDraft& draft);

// Parts that bodies and tools share.
void read_mesh(const YamlNode& node, const std::string& path, FaultList& faults, MeshSource& out);
/// at_mm and rotate_deg.
void read_placement(MapReader& reader, Pose& out);
/// slow_mm and warn_mm, of a pair or of all that state none: `levels` has what holds without them.
void read_levels(MapReader& reader, PairLevels& levels);

/// Index of the first item of that name, or kNoIndex.
template <class Named>
[[nodiscard]] std::uint32_t index_of(const std::vector<Named>& all,
                                     std::string_view name) noexcept {
    for (std::uint32_t i = 0; i < all.size(); ++i) {
        if (all[i].name == name) {
            return i;
        }
    }
    return kNoIndex;
}

template <class Named>
[[nodiscard]] std::vector<std::string_view> names_of(const std::vector<Named>& all) {
    std::vector<std::string_view> names;
    for (const Named& one : all) {
        if (!one.name.empty()) {
            names.push_back(one.name);
        }
    }
    return names;
}
/// For "wanted": the nearest of the names when there is one, then all of them.
[[nodiscard]] std::string wanted_name(std::string_view what, std::string_view got,
                                      const std::vector<std::string_view>& names);

}  // namespace axg
