// SPDX-License-Identifier: Apache-2.0
#include "config/text/write_yaml.hpp"

#include <algorithm>

#include "config/text/quote_text.hpp"

namespace axg {
namespace {

// parse_yaml() refuses deeper trees (kYamlDepthMax), so these functions may call each other.

std::string scalar(const YamlNode& node, bool is_in_list) {
    const bool is_plain =
        !node.is_quoted && (!is_in_list || node.text.find_first_of(",[]{}") == std::string::npos);
    return is_plain ? node.text : quoted(node.text, node.text.size() * 10 + 16);
}

bool holds_maps(const YamlNode& list) {
    return std::any_of(list.entries.begin(), list.entries.end(), [](const YamlEntry& entry) {
        return entry.value.kind == YamlNode::Kind::map;
    });
}

std::string one_line(const YamlNode& list) {
    std::string text;
    for (const YamlEntry& entry : list.entries) {
        text += text.empty() ? "" : ", ";
        text += entry.value.kind == YamlNode::Kind::sequence ? one_line(entry.value)
                                                             : scalar(entry.value, true);
    }
    return '[' + text + ']';
}

void write_map(const YamlNode& map, std::size_t indent, std::string& out);

void write_list_of_maps(const YamlNode& list, std::size_t indent, std::string& out) {
    for (const YamlEntry& entry : list.entries) {
        const std::size_t begin = out.size();
        write_map(entry.value, indent + 2, out);
        out[begin + indent] = '-';
    }
}

void write_entry(const YamlEntry& entry, std::size_t indent, std::string& out) {
    const bool is_default = entry.line == kDefaultLine;
    const char* const mark = is_default ? "  # default\n" : "\n";
    const YamlNode& value = entry.value;
    const std::string key = entry.key + ':';
    if (value.kind == YamlNode::Kind::nothing) {
        out += std::string(indent, ' ') + "# " + key + " none" + mark;
        return;
    }
    out += std::string(indent, ' ') + key;
    if (value.kind == YamlNode::Kind::scalar) {
        out += ' ' + scalar(value, false) + mark;
    } else if (value.kind == YamlNode::Kind::sequence && !holds_maps(value)) {
        out += ' ' + one_line(value) + mark;
    } else if (value.kind == YamlNode::Kind::sequence) {
        out += mark;
        write_list_of_maps(value, indent + 2, out);
    } else {
        out += mark;
        write_map(value, indent + 2, out);
    }
}

/// Writes stated entries first, then defaults: a list item then never begins with a comment.
void write_map(const YamlNode& map, std::size_t indent, std::string& out) {
    for (const bool is_default : {false, true}) {
        for (const YamlEntry& entry : map.entries) {
            if ((entry.line == kDefaultLine) == is_default) {
                write_entry(entry, indent, out);
            }
        }
    }
}

}  // namespace

std::string write_yaml(const YamlNode& map) {
    std::string out;
    write_map(map, 0, out);
    return out;
}

}  // namespace axg
