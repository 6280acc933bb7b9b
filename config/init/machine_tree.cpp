// SPDX-License-Identifier: Apache-2.0
#include "config/init/machine_tree.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/yaml_tree.hpp"

namespace axg {
namespace {

constexpr Range kCoordinates{-1e5, 1e5};
constexpr std::string_view kChild = "child_";
constexpr std::string_view kAxes = "XYZABCUVW";

class TreeReader {
  public:
    TreeReader(const std::vector<std::string>& files, double length_mm, FaultList& faults)
        : files_(files), length_mm_(length_mm), faults_(faults), is_used_(files.size(), false) {}

    void read(const YamlNode& node, const std::string& path, std::uint32_t parent) {
        if (node.kind != YamlNode::Kind::map) {
            faults_.add(node.line, path, shown(node), "a body: id, model, axis");
            return;
        }
        RoleGuess role;
        role.parent = parent;
        role.is_stated = true;
        std::string model;
        for (const YamlEntry& entry : node.entries) {
            read_key(entry, path, role, model);
        }
        const bool has_origin =
            std::any_of(node.entries.begin(), node.entries.end(),
                        [](const YamlEntry& entry) { return entry.key == "origin"; });
        if (role.axis >= 'A' && role.axis <= 'C' && !has_origin) {
            faults_.add(node.line, path + ".origin", "", "a point on the axis it turns about");
        }
        if (!find_mesh(node, path, model, role)) {
            return;
        }
        role.name = legal_name(role.name.empty() ? model : role.name, roles_);
        const auto place = static_cast<std::uint32_t>(roles_.size());
        roles_.push_back(std::move(role));
        for (const YamlEntry& entry : node.entries) {
            if (entry.key.compare(0, kChild.size(), kChild) == 0) {
                read(entry.value, path + '.' + entry.key, place);
            }
        }
    }

    [[nodiscard]] std::vector<RoleGuess> take_roles() {
        find_sides();
        return std::move(roles_);
    }

  private:
    void read_key(const YamlEntry& entry, const std::string& path, RoleGuess& role,
                  std::string& model) {
        const std::string key = path + '.' + entry.key;
        const YamlNode& value = entry.value;
        if (entry.key == "id") {
            role.name = value.text;
        } else if (entry.key == "model") {
            model = value.text;
        } else if (entry.key == "axis") {
            read_axis(value, key, role);
        } else if (entry.key == "position") {
            std::array<double, 6> numbers{};
            if (!read_numbers({value, key, faults_}, kCoordinates, numbers)) {
                return;
            }
            if (numbers[3] != 0 || numbers[4] != 0 || numbers[5] != 0) {
                faults_.add(entry.line, key, shown(value), "no rotation; turn the mesh itself");
            }
            role.at_mm = length_mm_ * Vec3d{numbers[0], numbers[1], numbers[2]};
        } else if (entry.key == "origin") {
            std::array<double, 3> numbers{};
            if (read_numbers({value, key, faults_}, kCoordinates, numbers)) {
                role.pivot_mm = length_mm_ * Vec3d{numbers[0], numbers[1], numbers[2]};
            }
        }
    }

    void read_axis(const YamlNode& value, const std::string& key, RoleGuess& role) {
        if (value.kind == YamlNode::Kind::nothing || value.text == "null" || value.text == "~") {
            return;
        }
        const char letter = value.text.size() != 1 ? '\0'
                            : value.text[0] >= 'a' ? static_cast<char>(value.text[0] - 'a' + 'A')
                                                   : value.text[0];
        if (letter == '\0' || kAxes.find(letter) == std::string_view::npos) {
            faults_.add(value.line, key, shown(value), "an axis letter or null");
            return;
        }
        role.axis = letter;
    }

    bool find_mesh(const YamlNode& node, const std::string& path, const std::string& model,
                   RoleGuess& role) {
        const std::string file = model.substr(model.find_last_of('/') + 1);
        const auto found = std::find(files_.begin(), files_.end(), file);
        const auto place = static_cast<std::size_t>(found - files_.begin());
        if (file.empty() || found == files_.end() || is_used_[place]) {
            faults_.add(node.line, path + ".model", model,
                        "an STL file in the folder of the meshes, each in one body");
            return false;
        }
        is_used_[place] = true;
        role.file = static_cast<std::uint32_t>(place);
        return true;
    }

    /// A branch that Z moves in carries the tool; every other one carries the workpiece.
    void find_sides() {
        std::vector<std::size_t> branch(roles_.size());
        std::vector<bool> has_z(roles_.size(), false);
        for (std::size_t i = 0; i < roles_.size(); ++i) {
            const bool is_branch = i == 0 || roles_[i].parent == 0;
            branch[i] = is_branch ? i : branch[roles_[i].parent];
            has_z[branch[i]] = has_z[branch[i]] || roles_[i].axis == 'Z';
        }
        for (std::size_t i = 0; i < roles_.size(); ++i) {
            roles_[i].is_table_side = roles_[i].axis != '\0' && !has_z[branch[i]];
        }
    }

    const std::vector<std::string>& files_;
    double length_mm_;
    FaultList& faults_;
    std::vector<bool> is_used_;  // [files]
    std::vector<RoleGuess> roles_;
};

}  // namespace

MachineTree read_machine_tree(const std::string& text, const std::string& name,
                              const std::vector<std::string>& files, double length_mm) {
    FaultList faults(name);
    MachineTree tree;
    YamlNode document;
    if (parse_yaml(text, faults, document)) {
        const bool has_root = document.kind == YamlNode::Kind::map &&
                              document.entries.size() == 1 && document.entries[0].key == "root";
        if (has_root) {
            TreeReader reader(files, length_mm, faults);
            reader.read(document.entries[0].value, "root", kNoParent);
            tree.roles = reader.take_roles();
        } else {
            faults.add(document.line, "root", "", "the one key root, with its bodies");
        }
    }
    tree.faults = faults.in_order();
    return tree;
}

}  // namespace axg
