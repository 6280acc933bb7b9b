// SPDX-License-Identifier: Apache-2.0
#include "config/machine/load_machine.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "config/can/read_can.hpp"
#include "config/machine/machine_keys.hpp"
#include "config/machine/parse_machine.hpp"
#include "config/machine/program_settings.hpp"
#include "config/machine/read_sections.hpp"
#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/open_beneath.hpp"
#include "config/text/small_file.hpp"
#include "config/text/yaml_tree.hpp"

namespace axg {
namespace {

void read_top(MapReader& top, MachineDraft& draft) {
    Machine& machine = draft.machine;
    std::uint32_t version = 0;
    top.whole("version", Need::required, {1, 1}, version);
    top.text("name", Need::required, 128, machine.name);
    read_scalars(top, top_keys(), machine, machine.states);
    read_axes(top, draft);
    read_bodies(top, draft);
    read_tools(top, draft);
    read_can(top, draft);
    read_guard(top, draft);
    read_pairs(top, draft);
    read_output_line(top, draft);
    read_capacities(top, draft);
    read_cycle(top, draft);
    ProgramSettings settings;  // judged here, kept by program_settings()
    read_program(top, draft, settings);
}

/// Merges maps key by key; any other value of `changes` replaces that of `root`.
void merge(const YamlNode& changes, YamlNode& root) {
    std::vector<std::pair<const YamlNode*, YamlNode*>> open{{&changes, &root}};
    while (!open.empty()) {
        const auto [from, to] = open.back();
        open.pop_back();
        const auto target = [to = to](const std::string& key) {
            return std::find_if(to->entries.begin(), to->entries.end(),
                                [&key](const YamlEntry& entry) { return entry.key == key; });
        };
        for (const YamlEntry& entry : from->entries) {  // new keys first: they move the others
            if (target(entry.key) == to->entries.end()) {
                to->entries.push_back(entry);
            }
        }
        for (const YamlEntry& entry : from->entries) {
            YamlNode& value = target(entry.key)->value;
            if (entry.value.kind == YamlNode::Kind::map && value.kind == YamlNode::Kind::map) {
                open.emplace_back(&entry.value, &value);
            } else {
                value = entry.value;
            }
        }
    }
}

/// How the files are read that a stored text names: from the stored ones.
NamedFiles stored_files(const MachineText& source) {
    return [&source](const std::string& name, std::size_t size_bytes_max) {
        const auto found = source.named.find(name);
        return found == source.named.end() || found->second.size() > size_bytes_max
                   ? NamedFile{{},
                               "a file that is not in the compiled machine",
                               "a machine compiled with it; run axguard compile again"}
                   : NamedFile{found->second, {}, {}};
    };
}

std::vector<ConfigFault> parse(const std::string& text, const std::vector<std::string>& changes,
                               const std::string& file, Machine& out, const NamedFiles& files,
                               std::vector<std::string>* doubts = nullptr) {
    FaultList faults{file};
    YamlNode root;
    if (!parse_yaml(text, faults, root)) {
        return faults.in_order();
    }
    for (const std::string& change : changes) {
        YamlNode changed;
        if (!parse_yaml(change, faults, changed)) {
            return faults.in_order();
        }
        merge(changed, root);
    }
    MachineDraft draft{.machine = {}, .faults = faults, .files = files};
    MapReader top{root,
                  "",
                  {"version", "name", "deadline_us", "engine", "program_speed_mm_min", "axes",
                   "bodies", "tools", "first_tool", "pairs", "exclusions", "can", "guard",
                   "output_line", "capacities", "cycle", "program"},
                  faults};
    if (root.kind == YamlNode::Kind::map) {
        read_top(top, draft);
    }
    if (faults.empty()) {
        out = std::move(draft.machine);
    }
    if (doubts != nullptr) {
        *doubts = std::move(draft.doubts);
    }
    return faults.in_order();
}

}  // namespace

std::vector<ConfigFault> parse_machine(const std::string& text, const std::string& file,
                                       Machine& out, const NamedFiles& files,
                                       std::vector<std::string>* doubts) {
    return parse(text, {}, file, out, files, doubts);
}

std::vector<ConfigFault> parse_machine(const MachineText& source, Machine& out) {
    return parse(source.text, {}, source.file, out, stored_files(source));
}

std::vector<ConfigFault> parse_changed_machine(const MachineText& source,
                                               const std::vector<std::string>& changes,
                                               Machine& out) {
    return parse(source.text, changes, source.file, out, stored_files(source));
}

std::vector<ConfigFault> load_machine(const std::string& path, Machine& out, MachineText& source) {
    std::string text;
    const SmallFileFault fault = read_small_file(path, kYamlSizeBytesMax, text);
    if (!fault.wanted.empty()) {
        FaultList faults{path};
        faults.add(1, "", fault.got, fault.wanted);
        return faults.in_order();
    }
    const std::filesystem::path place(path);
    source = {place.filename().string(), std::move(text), {}};
    const std::string folder = place.parent_path().string();
    return parse_machine(
        source.text, path, out,
        [&](const std::string& name, std::size_t size_bytes_max) {
            const FileRead read = read_beneath(folder, name, size_bytes_max);
            const auto* const bytes = reinterpret_cast<const char*>(read.bytes.data());
            std::string& named = source.named[name];
            named.assign(bytes, bytes + read.bytes.size());
            return NamedFile{named, read.got, read.wanted};
        },
        &source.doubts);
}

}  // namespace axg
