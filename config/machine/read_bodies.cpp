// SPDX-License-Identifier: Apache-2.0
// The section `bodies` of a machine file: the tree of rigid bodies, their joints and surfaces.
#include <array>
#include <cmath>

#include "config/machine/machine_keys.hpp"
#include "config/machine/read_sections.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr double kUnitTolerance = 1e-6;

void read_direction(MapReader& reader, Joint& joint) {
    std::array<double, 3> d{};
    if (!reader.numbers("direction", Need::required, {-1 - kUnitTolerance, 1 + kUnitTolerance},
                        d)) {
        return;
    }
    const double length = std::sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
    if (!(std::fabs(length - 1.0) <= kUnitTolerance)) {
        reader.report(
            "direction", "a direction of length " + shown(length),
            "a unit vector to 1e-6, such as [0, 0, 1]; write more digits if it is slanted");
        return;
    }
    joint.direction = {d[0] / length, d[1] / length, d[2] / length};
}

/// Without an axis, direction and pivot have no meaning and are faults; so is a pivot on a linear
/// axis.
void read_joint(MapReader& reader, MachineDraft& draft, Joint& joint) {
    std::string name;
    if (!reader.has("axis")) {
        for (const char* key : {"direction", "pivot_mm", "direction_error_deg", "pivot_error_mm"}) {
            if (reader.has(key)) {
                reader.report(key, std::string{key} + " without an axis",
                              "the key axis too, or a fixed body without this key");
            }
        }
        return;
    }
    const bool has_name = reader.name("axis", Need::required, name);
    if (has_name) {
        joint.axis = index_of(draft.machine.axes, name);
        if (joint.axis == kNoIndex) {
            reader.report("axis", quoted(name),
                          wanted_name("an axis", name, names_of(draft.machine.axes)));
        }
    }
    read_direction(reader, joint);
    const bool is_known = joint.axis != kNoIndex;
    const bool linear = is_known && draft.machine.axes[joint.axis].kind == AxisKind::linear;
    for (const char* key : {"pivot_mm", "pivot_error_mm"}) {
        if (linear && reader.has(key)) {
            reader.report(key, "a pivot on the linear axis " + name,
                          "no such key; only a rotary axis has a pivot");
            return;
        }
    }
    read_scalars(reader, joint_keys(linear ? AxisKind::linear : AxisKind::rotary), joint,
                 draft.machine.states);
    std::array<double, 3> pivot{};
    const Need need = is_known && !linear ? Need::required : Need::optional;
    if (reader.numbers("pivot_mm", need, {-kCoordinateMmMax, kCoordinateMmMax}, pivot)) {
        joint.pivot_mm = {pivot[0], pivot[1], pivot[2]};
    }
}

void read_parent(MapReader& reader, const YamlNode& section, MachineDraft& draft, Body& body) {
    std::string name;
    if (!reader.has("parent") || !reader.name("parent", Need::required, name)) {
        return;
    }
    body.parent = index_of(draft.machine.bodies, name);
    if (body.parent != kNoIndex) {
        return;
    }
    for (const YamlEntry& item : section.entries) {
        for (const YamlEntry& entry : item.value.entries) {
            if (entry.key == "name" && entry.value.text == name) {
                reader.report("parent",
                              quoted(name) + ", which is on line " + std::to_string(entry.line) +
                                  " and not above",
                              "a body listed before this one; list parents before their children");
                return;
            }
        }
    }
    reader.report("parent", quoted(name),
                  "no parent, for the machine's frame, or " +
                      wanted_name("a body", name, names_of(draft.machine.bodies)));
}

void read_surface(MapReader& reader, const std::string& path, MachineDraft& draft, Body& body) {
    const bool has_word = reader.boolean("tool", Need::optional, body.is_tool);
    draft.surfaces_are_sound &= has_word || !reader.has("tool");
    body.has_mesh = reader.has("mesh");
    reader.boolean("stock", Need::optional, body.is_stock);
    reader.boolean("size_is_right", Need::optional, body.mesh.size_is_right);
    if (body.is_stock && (body.is_tool || !body.has_mesh)) {
        reader.report("stock", body.is_tool ? "the tool as stock" : "stock without a mesh",
                      "a body with a mesh");
    }
    if (body.is_tool && body.has_mesh) {
        reader.report(
            "mesh", "a mesh on the tool body",
            "no mesh; its surface is that of the tool in the spindle, listed under tools");
    }
    const YamlNode* mesh = reader.find("mesh", Need::optional, "a map with file and unit");
    if (mesh != nullptr) {
        read_mesh(*mesh, path + ".mesh", draft.faults, body.mesh);
    }
}

/// The path shows the body's name where it has one: positions in a list are hard to count.
std::string body_path(const YamlNode& node, std::size_t index) {
    for (const YamlEntry& entry : node.entries) {
        if (entry.key == "name" && is_name(entry.value.text)) {
            return "bodies." + entry.value.text;
        }
    }
    return "bodies[" + std::to_string(index) + ']';
}

void read_body(const YamlNode& section, std::size_t index, MachineDraft& draft) {
    const YamlEntry& item = section.entries[index];
    const std::string path = body_path(item.value, index);
    MapReader reader{
        item.value,
        path,
        {"name", "parent", "axis", "direction", "direction_error_deg", "pivot_mm", "pivot_error_mm",
         "mesh", "at_mm", "rotate_deg", "place_error_mm", "tool", "stock", "size_is_right"},
        draft.faults};
    Body body;
    if (!reader.name("name", Need::required, body.name)) {
        draft.names_are_sound = false;
    } else if (const std::uint32_t other = index_of(draft.machine.bodies, body.name);
               other != kNoIndex) {
        draft.names_are_sound = false;
        reader.report("name",
                      quoted(body.name) + ", the name of the body on line " +
                          std::to_string(draft.body_lines[other]),
                      "a name that no other body has");
    }
    read_parent(reader, section, draft, body);
    read_joint(reader, draft, body.joint);
    read_placement(reader, body.at);
    read_scalars(reader, body_keys(), body, draft.machine.states);
    draft.machine.pose_errors.are_stated |= body.place_error_mm > 0 ||
                                            body.joint.pivot_error_mm > 0 ||
                                            body.joint.direction_error_rad > 0;
    read_surface(reader, path, draft, body);
    draft.machine.bodies.push_back(std::move(body));
    draft.body_lines.push_back(item.line);
}

void check_axes_are_used(MachineDraft& draft) {
    for (std::uint32_t i = 0; i < draft.machine.axes.size(); ++i) {
        bool used = false;
        for (const Body& body : draft.machine.bodies) {
            used |= body.joint.axis == i;
        }
        if (!used) {
            const std::string name = escaped(draft.machine.axes[i].name, kNameLengthMax);
            draft.faults.add(draft.axis_lines[i], "axes." + name, "an axis that moves no body",
                             "at least one body with axis: " + name);
        }
    }
}

void check_one_tool_body(MachineDraft& draft) {
    std::uint32_t first = kNoIndex;
    for (std::uint32_t i = 0; i < draft.machine.bodies.size(); ++i) {
        if (!draft.machine.bodies[i].is_tool) {
            continue;
        }
        if (first != kNoIndex) {
            draft.faults.add(draft.body_lines[i],
                             "bodies." + draft.machine.bodies[i].name + ".tool",
                             "a second tool body after " + draft.machine.bodies[first].name,
                             "one body with tool: true at most");
        } else {
            first = i;
        }
    }
}

}  // namespace

void read_bodies(MapReader& top, MachineDraft& draft) {
    const std::string wanted = "a list of 1 to " + std::to_string(kBodiesMax) + " bodies";
    const YamlNode* section = top.find("bodies", Need::required, wanted);
    if (section == nullptr) {
        draft.names_are_sound = false;
        return;
    }
    const std::size_t count = section->entries.size();
    if (section->kind != YamlNode::Kind::sequence || count == 0 || count > kBodiesMax) {
        draft.names_are_sound = false;
        top.report("bodies", shown(*section), wanted);
        return;
    }
    for (std::size_t i = 0; i < count; ++i) {
        read_body(*section, i, draft);
    }
    check_axes_are_used(draft);
    check_one_tool_body(draft);
}

}  // namespace axg
