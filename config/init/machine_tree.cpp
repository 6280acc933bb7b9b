// SPDX-License-Identifier: Apache-2.0
#include "config/init/machine_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"
#include "config/text/yaml_tree.hpp"

namespace axg {
namespace {

constexpr Range kCoordinates{-1e5, 1e5};
constexpr std::string_view kAxes = "XYZABCUVW";
constexpr std::array<std::string_view, 9> kKeys{"id",   "model", "type",  "position", "origin",
                                                "axis", "joint", "color", "power"};

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return text;
}

bool is_nothing(const YamlNode* node) {
    if (node == nullptr || node->kind == YamlNode::Kind::nothing) {
        return true;
    }
    const std::string word = lower_case(node->text);
    return node->kind == YamlNode::Kind::scalar &&
           (word.empty() || word == "~" || word == "null" || word == "none");
}

bool holds_map(const YamlNode& node) {
    return std::any_of(node.entries.begin(), node.entries.end(), [](const YamlEntry& entry) {
        return entry.value.kind == YamlNode::Kind::map;
    });
}

/// The keys of one part; null: not written.
struct PartKeys {
    const YamlNode *id = nullptr, *model = nullptr, *type = nullptr, *position = nullptr,
                   *origin = nullptr, *axis = nullptr;
};

class TreeReader {
  public:
    TreeReader(const std::vector<std::string>& files, double length_mm, FaultList& faults)
        : files_(files), length_mm_(length_mm), faults_(faults), is_used_(files.size(), false) {}

    /// Every map in `node` is a part, and every map in a part is one that it carries.
    void read_parts(const YamlNode& node, const std::string& path, std::uint32_t parent) {
        for (const YamlEntry& entry : node.entries) {
            const std::string key = (path.empty() ? "" : path + '.') + escaped(entry.key, 64);
            if (entry.value.kind == YamlNode::Kind::map) {
                read_part(entry.value, key, parent);
            } else if (holds_map(entry.value)) {
                faults_.add(entry.line, key, shown(entry.value),
                            "a key of its own for each part; QtPyVCP draws no part of a list");
            }
        }
    }

    [[nodiscard]] std::vector<RoleGuess> take_roles() {
        doubt_ways();
        return std::move(roles_);
    }

  private:
    void read_part(const YamlNode& node, const std::string& path, std::uint32_t parent) {
        const PartKeys keys = find_keys(node, path);
        RoleGuess role;
        role.parent = parent;
        role.is_stated = true;
        read_place(keys, node, path, role);
        if (!is_nothing(keys.axis)) {
            read_axis(keys, path, role);
        }
        const std::string model = is_nothing(keys.model) ? "" : keys.model->text;
        const bool has_mesh = find_mesh(keys, node, path, role);
        role.name = legal_name(is_nothing(keys.id) ? model : keys.id->text, roles_);
        const auto place = static_cast<std::uint32_t>(roles_.size());
        if (has_mesh) {
            roles_.push_back(std::move(role));
        }
        read_parts(node, path, has_mesh ? place : parent);  // of a faulty part: for its faults
    }

    PartKeys find_keys(const YamlNode& node, const std::string& path) {
        PartKeys keys;
        const std::array<const YamlNode**, 6> targets{&keys.id,       &keys.model,  &keys.type,
                                                      &keys.position, &keys.origin, &keys.axis};
        const std::span known(kKeys);
        for (const YamlEntry& entry : node.entries) {
            const auto found = std::find(known.begin(), known.end(), entry.key);
            const auto place = static_cast<std::size_t>(found - known.begin());
            if (place < targets.size()) {
                *targets[place] = &entry.value;
            } else if (found == known.end() && entry.value.kind != YamlNode::Kind::map) {
                const std::string_view meant = nearest_word(entry.key, known.first(6));
                if (!meant.empty()) {
                    faults_.add(entry.line, path + '.' + escaped(entry.key, 64), "unknown key",
                                fmt::format("; did you mean {}?", quoted(meant, 64)));
                }
            }
        }
        return keys;
    }

    /// The mesh is at `position`, in machine coordinates, and a rotary part turns about it.
    void read_place(const PartKeys& keys, const YamlNode& node, const std::string& path,
                    RoleGuess& role) {
        const std::string key = path + ".position";
        if (is_nothing(keys.position)) {
            faults_.add(node.line, key, "", "six numbers: x, y, z, and 0, 0, 0 for no rotation");
            return;
        }
        std::array<double, 6> numbers{};
        if (!read_numbers({*keys.position, key, faults_}, kCoordinates, numbers)) {
            return;
        }
        if (numbers[3] != 0 || numbers[4] != 0 || numbers[5] != 0) {
            faults_.add(keys.position->line, key, shown(*keys.position),
                        "no rotation; turn the mesh itself");
        }
        role.at_mm = length_mm_ * Vec3d{numbers[0], numbers[1], numbers[2]};
        role.pivot_mm = role.at_mm;
        std::array<double, 3> origin{};
        const std::string origin_key = path + ".origin";
        if (!is_nothing(keys.origin) &&
            read_numbers({*keys.origin, origin_key, faults_}, kCoordinates, origin)) {
            const Vec3d other = length_mm_ * Vec3d{origin[0], origin[1], origin[2]};
            if (other != role.pivot_mm) {
                role.pivot_doubt = fmt::format(
                    "position in the tree, about which QtPyVCP turns it; origin there is another "
                    "point, [{:.6g}, {:.6g}, {:.6g}] mm",
                    other.x, other.y, other.z);
            }
        }
    }

    /// QtPyVCP knows x y z of type linear and a b c of type angular, in small letters. Another
    /// spelling is a doubt, another axis a fault: QtPyVCP lets such a part rest.
    void read_axis(const PartKeys& keys, const std::string& path, RoleGuess& role) {
        const YamlNode& axis = *keys.axis;
        const std::string word = lower_case(axis.text);
        const bool has_sign = word.starts_with('-') || word.starts_with('+');
        const std::string_view letter = std::string_view(word).substr(has_sign ? 1 : 0);
        const std::size_t place = letter.size() == 1
                                      ? kAxes.find(static_cast<char>(letter[0] - 'a' + 'A'))
                                      : std::string_view::npos;
        if (axis.kind != YamlNode::Kind::scalar || place == std::string_view::npos) {
            faults_.add(axis.line, path + ".axis", shown(axis),
                        "an axis letter, with a minus where the part moves against it, or null");
            return;
        }
        const bool is_rotary = place / 3 == 1;
        const std::string type = is_nothing(keys.type) ? "" : lower_case(keys.type->text);
        const std::string_view wanted = is_rotary ? "angular" : "linear";
        if (!type.empty() && type != wanted) {
            faults_.add(keys.type->line, path + ".type", shown(*keys.type),
                        fmt::format("{} with axis {}; QtPyVCP does not move this part: correct "
                                    "type or axis, or state axis: null",
                                    wanted, quoted(axis.text, 64)));
            return;
        }
        role.axis = kAxes[place];
        role.is_reversed = word.starts_with('-');
        const bool is_moved = axis.text == word && word[0] != '+' && place < 6 && type == wanted &&
                              keys.type->text == type;
        if (!is_moved) {
            role.way_doubt = fmt::format("QtPyVCP does not move a part with axis {} and type {}",
                                         quoted(axis.text, 64),
                                         keys.type == nullptr ? "missing" : shown(*keys.type));
        }
    }

    bool find_mesh(const PartKeys& keys, const YamlNode& node, const std::string& path,
                   RoleGuess& role) {
        const std::string model = is_nothing(keys.model) ? "" : keys.model->text;
        const std::string file = model.substr(model.find_last_of("/\\") + 1);
        const auto found = std::find(files_.begin(), files_.end(), file);
        const auto place = static_cast<std::size_t>(found - files_.begin());
        if (file.empty() || found == files_.end() || is_used_[place]) {
            faults_.add(keys.model == nullptr ? node.line : keys.model->line, path + ".model",
                        model.empty() ? "" : quoted(model, 400),
                        "an STL file in the folder of the meshes, each in one body");
            return false;
        }
        is_used_[place] = true;
        role.file = static_cast<std::uint32_t>(place);
        return true;
    }

    /// A part that carries Z or rides on it carries the tool; every other one carries the
    /// workpiece, and so moves against its command. Trees without any minus draw both with their
    /// command, as Probe Basic's do: such a tree states no signs.
    void doubt_ways() {
        std::vector<bool> is_head(roles_.size());
        for (std::size_t i = 0; i < roles_.size(); ++i) {
            is_head[i] = (roles_[i].axis == "Z" && !roles_[i].is_reversed) ||
                         (roles_[i].parent != kNoParent && is_head[roles_[i].parent]);
        }
        for (std::size_t i = roles_.size(); i-- > 0;) {
            if (roles_[i].axis == "Z" && is_head[i]) {
                for (std::uint32_t k = roles_[i].parent; k != kNoParent; k = roles_[k].parent) {
                    is_head[k] = true;
                }
            }
        }
        const bool states_signs = std::any_of(
            roles_.begin(), roles_.end(), [](const RoleGuess& role) { return role.is_reversed; });
        for (std::size_t i = 0; i < roles_.size(); ++i) {
            RoleGuess& role = roles_[i];
            role.is_table_side = !role.axis.empty() && !is_head[i];
            if (!role.is_table_side || role.is_reversed) {
                continue;
            }
            role.is_reversed = !states_signs;
            role.way_doubt +=
                std::string(role.way_doubt.empty() ? "" : "; ") +
                (states_signs
                     ? "as the tree states it; what carries the workpiece moves against its command"
                     : "what carries the workpiece moves against its command; the tree has no "
                       "minus, and QtPyVCP draws it moving with its command");
        }
    }

    const std::vector<std::string>& files_;
    double length_mm_;
    FaultList& faults_;
    std::vector<bool> is_used_;  // [files]
    std::vector<RoleGuess> roles_;
};

/// A machine file needs a pair of bodies and an axis.
void require_motion(const std::vector<RoleGuess>& roles, const YamlNode& document,
                    FaultList& faults) {
    const int line = document.entries.empty() ? document.line : document.entries[0].line;
    const std::string key = document.entries.empty() ? "root" : document.entries[0].key;
    if (roles.size() < 2) {
        faults.add(line, escaped(key, 64), fmt::format("{} part", roles.size()),
                   "two parts or more: a map with id, model, type, position, axis for each");
    } else if (std::none_of(roles.begin(), roles.end(),
                            [](const RoleGuess& role) { return !role.axis.empty(); })) {
        faults.add(line, escaped(key, 64), "no part that moves",
                   "a part with type linear or angular and an axis");
    }
}

}  // namespace

MachineTree read_machine_tree(const std::string& text, const std::string& name,
                              const std::vector<std::string>& files, double length_mm) {
    FaultList faults(name);
    MachineTree tree;
    YamlNode document;
    if (parse_yaml(text, faults, document)) {
        TreeReader reader(files, length_mm, faults);
        reader.read_parts(document, "", kNoParent);
        tree.roles = reader.take_roles();
        if (faults.empty()) {
            require_motion(tree.roles, document, faults);
        }
    }
    tree.faults = faults.in_order();
    return tree;
}

}  // namespace axg
