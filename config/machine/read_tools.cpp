// SPDX-License-Identifier: Apache-2.0
// The sections `tools` and `first_tool` of a machine file.
#include <algorithm>

#include "config/machine/machine_keys.hpp"
#include "config/machine/read_sections.hpp"
#include "config/machine/read_shapes.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/number_text.hpp"

namespace axg {
namespace {

void read_tool_surface(MapReader& reader, const std::string& path, MachineDraft& draft,
                       Tool& tool) {
    std::string got;
    for (const char* key : {"mesh", "profile_mm", "sections"}) {
        if (reader.has(key)) {
            got.append(got.empty() ? "" : " and ").append(key);
        }
    }
    if (got.empty() || got.find(' ') != std::string::npos) {
        draft.faults.add(reader.node().line, path,
                         got.empty() ? "none of mesh, profile_mm and sections" : got,
                         "one of mesh, profile_mm and sections, for the tool's surface");
        return;
    }
    tool.mesh.where = draft.faults.where(reader.line_of(got));
    if (got == "profile_mm") {
        read_profile(reader, draft.faults, tool.mesh.shapes.emplace_back());
        return;
    }
    if (reader.has("segments")) {
        reader.report("segments", "segments without profile_mm", "no such key with " + got);
    }
    const YamlNode* surface = reader.find(
        got, Need::required, got == "mesh" ? "a map with file and unit" : "a list of sections");
    if (surface != nullptr && got == "mesh") {
        read_mesh(*surface, path + ".mesh", draft.faults, tool.mesh);
    } else if (surface != nullptr) {
        read_shapes(*surface, path + ".sections", draft.faults, true, tool.mesh.shapes);
        const bool cuts_all = std::all_of(tool.mesh.shapes.begin(), tool.mesh.shapes.end(),
                                          [](const Shape& part) { return part.is_cutting; });
        if (cuts_all && !tool.mesh.shapes.empty()) {
            reader.report("sections", "only cutting sections",
                          "a section that is not cutting, such as the shank; otherwise nothing is "
                          "checked against the stock");
        }
    }
}

/// Places the surface of a turning tool in the frame of the tool's body: the swept profile is
/// computed about that frame's axis.
void turn_with_spindle(Tool& tool) {
    tool.mesh.turns = true;
    tool.mesh.at = tool.at;
    tool.at = {};
    for (Shape& shape : tool.mesh.shapes) {
        shape.at = compose(tool.mesh.at, shape.at);
        shape.turns = true;
    }
}

/// The path of a tool in messages: its number if it can be read, else its position in the list.
std::string tool_path(const YamlNode& node, std::size_t index) {
    for (const YamlEntry& entry : node.entries) {
        if (entry.key == "number" && whole_number(entry.value.text)) {
            return "tools." + entry.value.text;
        }
    }
    return "tools[" + std::to_string(index) + ']';
}

void read_tool(const YamlEntry& item, std::size_t index, MachineDraft& draft) {
    const std::string path = tool_path(item.value, index);
    MapReader reader{
        item.value,
        path,
        {"number", "name", "length_mm", "diameter_mm", "mesh", "profile_mm", "segments", "sections",
         "turns", "size_is_right", "at_mm", "rotate_deg", "place_error_mm"},
        draft.faults};
    Tool tool;
    std::uint32_t number = 0;
    if (reader.whole("number", Need::required, {1, 65535}, number)) {
        tool.number = static_cast<std::uint16_t>(number);
        for (std::size_t i = 0; i < draft.machine.tools.size(); ++i) {
            if (draft.machine.tools[i].number == tool.number) {
                reader.report("number",
                              std::to_string(number) + ", the number of the tool on line " +
                                  std::to_string(draft.tool_lines[i]),
                              "a number that no other tool has");
            }
        }
    }
    reader.text("name", Need::optional, 128, tool.name);
    reader.number("length_mm", Need::required, {0, kCoordinateMmMax}, tool.length_mm);
    double diameter_mm = 0;
    if (reader.number("diameter_mm", Need::optional, {-kCoordinateMmMax, kCoordinateMmMax},
                      diameter_mm)) {
        tool.diameter_mm = diameter_mm;
    }
    read_placement(reader, tool.at);
    read_scalars(reader, tool_keys(), tool, draft.machine.states);
    draft.machine.pose_errors.are_stated |= tool.place_error_mm > 0;
    read_tool_surface(reader, path, draft, tool);
    bool turns = true;
    reader.boolean("turns", Need::optional, turns);
    reader.boolean("size_is_right", Need::optional, tool.mesh.size_is_right);
    if (turns) {
        turn_with_spindle(tool);
    }
    draft.machine.tools.push_back(std::move(tool));
    draft.tool_lines.push_back(item.line);
}

/// Default: the first tool listed is in the spindle. The file has to state an empty spindle; it is
/// never assumed.
void read_first_tool(MapReader& top, MachineDraft& draft) {
    Machine& machine = draft.machine;
    std::uint32_t first = machine.tools.empty() ? 0U : machine.tools.front().number;
    if (top.whole("first_tool", Need::optional, {0, 65535}, first) && first != 0) {
        bool found = false;
        for (const Tool& tool : machine.tools) {
            found |= tool.number == first;
        }
        if (!found) {
            top.report("first_tool", std::to_string(first),
                       "the number of a tool listed under tools, or 0 for an empty spindle");
        }
    }
    machine.first_tool = static_cast<std::uint16_t>(first);
}

}  // namespace

void read_tools(MapReader& top, MachineDraft& draft) {
    const std::string wanted = "a list of 1 to " + std::to_string(kToolsMax) + " tools";
    std::uint32_t tool_body = kNoIndex;
    for (std::uint32_t i = 0; i < draft.machine.bodies.size(); ++i) {
        tool_body = draft.machine.bodies[i].is_tool ? i : tool_body;
    }
    const Need need = tool_body == kNoIndex ? Need::optional : Need::required;
    const YamlNode* section = top.find("tools", need, wanted + ", because a body has tool: true");
    if (section != nullptr) {
        const std::size_t count = section->entries.size();
        if (section->kind != YamlNode::Kind::sequence || count == 0 || count > kToolsMax) {
            top.report("tools", shown(*section), wanted);
        } else {
            for (std::size_t i = 0; i < count; ++i) {
                read_tool(section->entries[i], i, draft);
            }
        }
        if (tool_body == kNoIndex && !draft.machine.bodies.empty() && draft.surfaces_are_sound) {
            top.report("tools", "tools, but no body that carries them",
                       "a body with tool: true, or no tools");
        }
    }
    read_first_tool(top, draft);
}

}  // namespace axg
