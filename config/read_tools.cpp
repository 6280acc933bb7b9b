// SPDX-License-Identifier: Apache-2.0
// The sections `tools` and `first_tool` of a machine file.
#include <array>

#include "config/fault_list.hpp"
#include "config/machine_draft.hpp"
#include "config/map_reader.hpp"
#include "config/number_text.hpp"
#include "config/quote_text.hpp"

namespace axg {
namespace {

constexpr std::size_t kProfilePointsMax = 1024;

/// A profile closes on the axis at both ends: otherwise the tool it turns into has a hole.
void read_profile(MapReader& reader, const std::string& path, MachineDraft& draft,
                  MeshSource& out) {
    const YamlNode* list = reader.find("profile_mm", Need::required, "a list of [radius, height]");
    if (list == nullptr) {
        return;
    }
    const std::size_t count = list->entries.size();
    if (list->kind != YamlNode::Kind::sequence || count < 3 || count > kProfilePointsMax) {
        reader.report("profile_mm", shown(*list),
                      "a list of 3 to " + std::to_string(kProfilePointsMax) +
                          " points [radius, height], tip first");
        return;
    }
    for (std::size_t i = 0; i < count; ++i) {
        const YamlEntry& item = list->entries[i];
        const std::string at = path + ".profile_mm[" + std::to_string(i) + ']';
        std::array<double, 2> point{};
        if (!read_numbers({item.value, at, draft.faults}, {-kCoordinateMmMax, kCoordinateMmMax},
                          point)) {
            continue;
        }
        const bool is_end = i == 0 || i + 1 == count;
        const Vec3d here{point[0], 0, point[1]};
        if (point[0] < 0 || (is_end && point[0] != 0)) {
            draft.faults.add(item.line, at, "the radius " + shown(point[0]),
                             is_end
                                 ? "0 at the first and the last point: the profile ends on the axis"
                                 : "a radius of 0 or more");
        } else if (!out.profile.empty() && out.profile.back() == here) {
            draft.faults.add(item.line, at, "the same point twice", "each point once");
        }
        out.profile.push_back(here);
    }
}

void read_tool_surface(MapReader& reader, const std::string& path, MachineDraft& draft,
                       Tool& tool) {
    const bool has_profile = reader.has("profile_mm");
    if (has_profile == reader.has("mesh")) {
        reader.report(has_profile ? "profile_mm" : "mesh",
                      has_profile ? "both mesh and profile_mm" : "neither mesh nor profile_mm",
                      "one of the two, for the tool's surface");
    }
    if (has_profile) {
        read_profile(reader, path, draft, tool.mesh);
        reader.whole("segments", Need::optional, {8, 512}, tool.mesh.profile_segments);
    } else if (reader.has("segments")) {
        reader.report("segments", "segments without profile_mm", "no such key beside a mesh");
    }
    const YamlNode* mesh = reader.find("mesh", Need::optional, "a map with file and unit");
    if (mesh != nullptr) {
        read_mesh(*mesh, path + ".mesh", draft.faults, tool.mesh);
    }
    if (tool.mesh.where.empty()) {
        tool.mesh.where = draft.faults.where(reader.line_of("profile_mm"));
    }
}

/// Tools are known by their numbers where those can be read.
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
        {"number", "name", "length_mm", "mesh", "profile_mm", "segments", "at_mm", "rotate_deg"},
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
    read_placement(reader, tool.at);
    read_tool_surface(reader, path, draft, tool);
    draft.machine.tools.push_back(std::move(tool));
    draft.tool_lines.push_back(item.line);
}

/// Without a word the first tool listed counts as in the spindle: an empty spindle must be said,
/// not assumed.
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
    const YamlNode* section = top.find("tools", need, wanted + ", as a body says tool: true");
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
