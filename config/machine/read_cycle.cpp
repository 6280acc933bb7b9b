// SPDX-License-Identifier: Apache-2.0
// The sections `capacities` and `cycle` of a machine file: lengths of lists.
#include "config/machine/machine_keys.hpp"
#include "config/machine/read_sections.hpp"

namespace axg {

void read_capacities(MapReader& top, MachineDraft& draft) {
    constexpr const char* kWanted = "a map of list lengths";
    const YamlNode* section = top.find("capacities", Need::optional, kWanted);
    if (section == nullptr) {
        return;
    }
    MapReader reader{*section, "capacities", keys_of(capacity_keys(), {"batch"}), draft.faults};
    Capacities& out = draft.machine.capacities;
    read_scalars(reader, capacity_keys(), out, draft.machine.states);
    if (const YamlNode* batch = reader.find("batch", Need::optional, kWanted)) {
        MapReader lists{*batch, "capacities.batch", keys_of(batch_keys()), draft.faults};
        read_scalars(lists, batch_keys(), out.batch, draft.machine.states);
    }
}

void read_cycle(MapReader& top, MachineDraft& draft) {
    constexpr const char* kWanted = "auto, or a map, such as {stages: 3}";
    const YamlNode* section = top.find("cycle", Need::optional, kWanted);
    if (section == nullptr) {
        return;
    }
    if (section->kind == YamlNode::Kind::scalar) {
        if (section->text != "auto") {
            top.report("cycle", shown(*section), kWanted);
        }
        return;
    }
    MapReader reader{*section, "cycle", keys_of(cycle_keys(), {"lists"}), draft.faults};
    CycleRules& out = draft.machine.cycle;
    out.is_pinned = true;
    read_scalars(reader, cycle_keys(), out, draft.machine.states);
    if (const YamlNode* lists = reader.find("lists", Need::optional, "a map of list lengths")) {
        MapReader lengths{*lists, "cycle.lists", keys_of(list_keys()), draft.faults};
        read_scalars(lengths, list_keys(), out.lists, draft.machine.states);
    }
}

}  // namespace axg
