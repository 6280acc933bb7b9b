// SPDX-License-Identifier: Apache-2.0
#include "config/machine/effective_yaml.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "config/machine/machine_keys.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/machine_draft.hpp"
#include "config/text/write_yaml.hpp"
#include "config/text/yaml_tree.hpp"
#include "core/base/finite.hpp"
#include "core/machine/frame_ids.hpp"

namespace axg {
namespace {

using Kind = YamlNode::Kind;

YamlNode scalar(std::string text) {
    return {.kind = Kind::scalar,
            .line = kDefaultLine,
            .is_quoted = false,
            .text = std::move(text),
            .entries = {}};
}

/// Shortest of 15 digits or fewer: a unit that was folded in (rad, s) does not show.
YamlNode value_of(double value) {
    std::array<char, 40> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%.15g", value);
    return scalar(buffer.data());
}
YamlNode value_of(std::uint32_t value) {
    return scalar(std::to_string(value));
}
YamlNode value_of(bool value) {
    return scalar(value ? "true" : "false");
}
YamlNode value_of(const char* word) {
    return scalar(word);
}
YamlNode id_of(std::uint32_t id) {
    std::array<char, 16> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "0x%03X", static_cast<unsigned>(id));
    return scalar(buffer.data());
}

YamlNode list_of(std::vector<YamlNode> values) {
    YamlNode list{.kind = Kind::sequence,
                  .line = kDefaultLine,
                  .is_quoted = false,
                  .text = {},
                  .entries = {}};
    for (YamlNode& value : values) {
        list.entries.push_back({"", kDefaultLine, std::move(value)});
    }
    return list;
}

template <class Ids>
YamlNode ids_of(const Ids& ids) {
    std::vector<YamlNode> values;
    for (const auto id : ids) {
        values.push_back(id_of(id));
    }
    return list_of(std::move(values));
}

YamlEntry* find(YamlNode& map, std::string_view key) {
    const auto found = std::find_if(map.entries.begin(), map.entries.end(),
                                    [key](const YamlEntry& entry) { return entry.key == key; });
    return found == map.entries.end() ? nullptr : &*found;
}

/// The value of a key that was left out.
void fill(YamlNode& map, const char* key, YamlNode value) {
    if (find(map, key) == nullptr) {
        map.entries.push_back({key, kDefaultLine, std::move(value)});
    }
}

/// Keys whose absence is their value.
void fill_none(YamlNode& map, std::initializer_list<const char*> keys) {
    for (const char* const key : keys) {
        fill(map, key, {});
    }
}

template <class Owner>
YamlNode value_in_file(const ScalarKey<Owner>& row, const Owner& owner) {
    if (row.number != nullptr) {
        const double value = owner.*row.number;
        return is_finite(value) ? value_of(value * row.unit.back) : YamlNode{};
    }
    return row.whole != nullptr   ? value_of(owner.*row.whole)
           : row.is_on != nullptr ? value_of(owner.*row.is_on)
                                  : scalar(std::string(row.words[row.place(owner)]));
}

template <class Owner>
void fill_scalars(YamlNode& map, ScalarKeys<Owner> table, const Owner& owner) {
    for (const ScalarKey<Owner>& row : table) {
        fill(map, row.key, value_in_file(row, owner));
    }
}

/// The map under a key, made if it was left out.
YamlNode& map_at(YamlNode& parent, const char* key) {
    YamlNode map;
    map.kind = Kind::map;
    fill(parent, key, std::move(map));
    return find(parent, key)->value;
}

void fill_placement(YamlNode& map) {
    for (const char* const key : {"at_mm", "rotate_deg"}) {
        fill(map, key, list_of({value_of(0U), value_of(0U), value_of(0U)}));
    }
}

void fill_shapes(YamlNode& list, bool is_tool) {
    for (YamlEntry& entry : list.entries) {
        YamlNode& shape = entry.value;
        if (is_tool) {
            fill(shape, "cutting", value_of(false));
        }
        if (find(shape, "box_mm") == nullptr) {
            fill(shape, "segments", value_of(Shape{}.segments));
        }
        if (YamlEntry* const cone = find(shape, "cone")) {
            fill(cone->value, "top_radius_mm", value_of(0U));
        }
        fill_placement(shape);
    }
}

void fill_mesh(YamlNode& map) {
    YamlEntry* const mesh = find(map, "mesh");
    if (mesh == nullptr) {
        return;
    }
    if (YamlEntry* const shapes = find(mesh->value, "shapes")) {
        fill_shapes(shapes->value, false);
        return;
    }
    for (const char* const key : {"allow_open", "allow_self_intersection", "allow_degenerate"}) {
        fill(mesh->value, key, value_of(false));
    }
    fill_none(mesh->value, {"sha256", "size_mm", "simplify_mm"});
}

void fill_axes(YamlNode& axes, const Machine& machine) {
    for (YamlEntry& entry : axes.entries) {
        const Axis& axis = machine.axes[index_of(machine.axes, entry.key)];
        fill_scalars(entry.value, axis_keys(axis.kind), axis);
    }
}

void fill_bodies(YamlNode& bodies, const Machine& machine) {
    for (std::size_t i = 0; i < bodies.entries.size(); ++i) {
        YamlNode& body = bodies.entries[i].value;
        const Body& read = machine.bodies[i];
        fill_none(body, {"parent", "axis"});
        if (read.joint.axis != kNoIndex) {
            fill_scalars(body, joint_keys(machine.axes[read.joint.axis].kind), read.joint);
        }
        fill_scalars(body, body_keys(), read);
        fill_placement(body);
        for (const char* const key : {"tool", "stock", "size_is_right"}) {
            fill(body, key, value_of(false));
        }
        fill_mesh(body);
    }
}

void fill_tools(YamlNode& tools, const Machine& machine) {
    for (std::size_t i = 0; i < tools.entries.size(); ++i) {
        YamlNode& tool = tools.entries[i].value;
        fill_scalars(tool, tool_keys(), machine.tools[i]);
        fill_none(tool, {"name"});
        fill_placement(tool);
        fill(tool, "turns", value_of(true));
        fill(tool, "size_is_right", value_of(false));
        fill_mesh(tool);
        if (find(tool, "profile_mm") != nullptr) {
            fill(tool, "segments", value_of(Shape{}.segments));
        }
        if (YamlEntry* const sections = find(tool, "sections")) {
            fill_shapes(sections->value, true);
        }
    }
}

/// After `guard`, whose levels count for pairs that state none.
void fill_pairs(YamlNode& pairs, YamlNode& guard) {
    for (YamlEntry& entry : pairs.entries) {
        for (const char* const key : {"slow_mm", "warn_mm"}) {
            fill(entry.value, key, scalar(find(guard, key)->value.text));
        }
    }
}

void fill_ids(YamlNode& ids, const CanLayout& can) {
    fill(ids, "sync", id_of(can.sync_id));
    if (is_native(can)) {
        fill(ids, "axes", ids_of(can.axis_ids));
    }
    for (const FrameId& row : kFrameIds) {
        fill(ids, row.key, is_stated(can, row.use) ? id_of(can.*row.id) : YamlNode{});
    }
}

void fill_drives(YamlNode& drives) {
    for (YamlEntry& entry : drives.entries) {
        fill(entry.value, "reversed", value_of(false));
        fill(entry.value, "zero_counts", value_of(0U));
        fill_none(entry.value, {"velocity"});
    }
}

/// One number where both are the same.
YamlNode ends_of(std::uint32_t least, std::uint32_t most) {
    return least == most ? value_of(least) : list_of({value_of(least), value_of(most)});
}

void fill_can(YamlNode& map, const CanLayout& can) {
    fill(map, "format", value_of("classical"));
    fill(map, "sample_us", value_of(can.sample_us));
    fill_ids(map_at(map, "ids"), can);
    if (is_native(can)) {
        fill(map, "data_ids", ids_of(can.data_ids));
    }
    if (has_sample_counter(can)) {
        fill(map, "permit", value_of(2U));
    } else {
        fill_none(map, {"permit"});
    }
    fill(map, "hashes", value_of(can.hashes_in_id != 0 ? "required" : "none"));
    fill(map, "permit_samples", ends_of(can.permit_samples.least, can.permit_samples.most));
    fill(map, "latched_age_us", ends_of(can.latched_age.least_us, can.latched_age.most_us));
    fill(map, "stale_after_us", value_of(can.stale_after_us));
    fill(map, "frozen_samples", value_of(can.frozen_samples));
    fill(map, "counter_delta_max", value_of(std::uint32_t{can.counter_delta_max}));
    fill(map, "heartbeat_timeout_us", value_of(can.heartbeat_timeout_us));
    if (find(map, "signals") != nullptr) {
        fill(map, "signal_frame_bytes", value_of(std::uint32_t{can.signal_frame_bytes}));
        for (YamlEntry& entry : find(map, "signals")->value.entries) {
            fill(entry.value, "offset", value_of(0U));
        }
    }
    if (!has_sync(wire_of(can))) {
        fill_none(map, {"arrival_jitter_us"});
    }
    if (wire_of(can).mark == SampleMark::sync) {
        fill(map, "sync", value_of(can.guard_sends_sync ? "guard" : "board"));
        fill(map, "sync_counter", value_of(std::uint32_t{can.sync_counter_max}));
        fill(map, "sync_window_us", value_of(can.sync_window_us));
        fill_drives(find(map, "drives")->value);
    }
    if (YamlEntry* const ahead = find(map, "ahead")) {
        fill(ahead->value, "id", id_of(can.look_ahead_id));
        fill(ahead->value, "data_id", id_of(can.look_ahead_data_id));
    } else {
        fill_none(map, {"ahead"});
    }
    fill_none(map, {"quick_stop"});
}

void fill_guard(YamlNode& map, const GuardRules& guard) {
    constexpr std::size_t kOfLevels = 2;  // the last rows, shown behind slow_mm and warn_mm
    const auto table = guard_keys();
    fill_scalars(map, table.first(table.size() - kOfLevels), guard);
    fill(map, "slow_mm", value_of(0U));
    fill(map, "warn_mm", value_of(0U));
    fill_scalars(map, table.last(kOfLevels), guard);
    fill_none(map, {"single_jog"});
}

void fill_capacities(YamlNode& map, const Capacities& capacities) {
    fill_scalars(map, capacity_keys(), capacities);
    fill_scalars(map_at(map, "batch"), batch_keys(), capacities.batch);
}

void fill_cycle(YamlNode& top, const CycleRules& cycle) {
    if (!cycle.is_pinned) {
        fill(top, "cycle", value_of("auto"));
        return;
    }
    YamlNode& map = map_at(top, "cycle");
    fill_scalars(map, cycle_keys(), cycle);
    fill_scalars(map_at(map, "lists"), list_keys(), cycle.lists);
}

void fill_top(YamlNode& top, const Machine& machine) {
    fill_scalars(top, top_keys(), machine);
    fill_axes(find(top, "axes")->value, machine);
    fill_bodies(find(top, "bodies")->value, machine);
    if (YamlEntry* const tools = find(top, "tools")) {
        fill_tools(tools->value, machine);
    } else {
        fill_none(top, {"tools"});
    }
    fill(top, "first_tool", value_of(std::uint32_t{machine.first_tool}));
    fill_can(map_at(top, "can"), machine.can);
    YamlNode& guard = map_at(top, "guard");
    fill_guard(guard, machine.guard);
    fill_pairs(find(top, "pairs")->value, guard);
    if (YamlEntry* const exclusions = find(top, "exclusions")) {
        for (YamlEntry& entry : exclusions->value.entries) {
            fill_none(entry.value, {"because"});
        }
    }
    fill_none(top, {"exclusions", "output_line"});
    fill_capacities(map_at(top, "capacities"), machine.capacities);
    fill_cycle(top, machine.cycle);
    fill_none(top, {"program"});  // what it leaves out is unknown
}

}  // namespace

std::string effective_yaml(const MachineText& source, const Machine& machine) {
    FaultList faults{source.file};
    YamlNode top;
    if (!parse_yaml(source.text, faults, top) || top.kind != Kind::map || !faults.empty()) {
        return {};  // such a text was no machine
    }
    fill_top(top, machine);
    return write_yaml(top);
}

}  // namespace axg
