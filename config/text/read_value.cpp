// SPDX-License-Identifier: Apache-2.0
// Single values of a machine file: numbers and names.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "config/text/fault_list.hpp"
#include "config/text/map_reader.hpp"
#include "config/text/number_text.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

std::string from_to(const std::string& min, const std::string& max) {
    return " from " + min + " to " + max;
}

bool is_word(char c) noexcept {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

std::string hex(std::uint32_t value) {
    std::array<char, 16> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "0x%03X", static_cast<unsigned>(value));
    return buffer.data();
}

}  // namespace

std::string shown(double value) {
    std::array<char, 40> buffer{};
    const bool plain = value == 0 || (std::fabs(value) >= 1e-4 && std::fabs(value) < 1e12);
    const auto form = plain ? std::chars_format::fixed : std::chars_format::scientific;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, form).ptr;
    return {buffer.data(), end};
}

std::string shown(const YamlNode& node) {
    switch (node.kind) {
        case YamlNode::Kind::nothing:
            return "nothing";
        case YamlNode::Kind::scalar:
            return quoted(node.text);
        case YamlNode::Kind::sequence:
            return "a list of " + std::to_string(node.entries.size());
        case YamlNode::Kind::map:
            return "a map";
        case YamlNode::Kind::refused:
            break;
    }
    return "a refused value";
}

bool is_name(std::string_view text) noexcept {
    return !text.empty() && text.size() <= kNameLengthMax && is_word(text[0]) &&
           std::all_of(text.begin(), text.end(),
                       [](char c) { return is_word(c) || c == '_' || c == '-' || c == '.'; });
}

bool read_number(ValueSite site, Range range, double& out) {
    const std::string wanted = "a number" + from_to(shown(range.min), shown(range.max));
    if (site.node.kind == YamlNode::Kind::refused) {
        return false;
    }
    if (site.node.kind != YamlNode::Kind::scalar || site.node.is_quoted) {
        site.faults.add(site.node.line, site.path,
                        shown(site.node) + (site.node.is_quoted ? " in quotes" : ""),
                        wanted + (site.node.is_quoted ? ", without quotes" : ""));
        return false;
    }
    const auto value = decimal_number(site.node.text);
    if (!value) {
        site.faults.add(site.node.line, site.path, shown(site.node),
                        wanted + ", such as 12, -0.5 or 1.5e-3; use a decimal point and no unit");
        return false;
    }
    if (*value < range.min || *value > range.max) {
        site.faults.add(site.node.line, site.path, shown(site.node), wanted);
        return false;
    }
    out = *value;
    return true;
}

bool read_whole(ValueSite site, WholeRange range, bool hex_allowed, std::uint32_t& out) {
    const std::string wanted = "an integer" + (hex_allowed ? from_to(hex(range.min), hex(range.max))
                                                           : from_to(std::to_string(range.min),
                                                                     std::to_string(range.max)));
    if (site.node.kind == YamlNode::Kind::refused) {
        return false;
    }
    if (site.node.kind != YamlNode::Kind::scalar || site.node.is_quoted) {
        site.faults.add(site.node.line, site.path,
                        shown(site.node) + (site.node.is_quoted ? " in quotes" : ""),
                        wanted + (site.node.is_quoted ? ", without quotes" : ""));
        return false;
    }
    const auto value = hex_allowed ? hex_number(site.node.text) : whole_number(site.node.text);
    if (!value) {
        site.faults.add(site.node.line, site.path, shown(site.node),
                        wanted + (hex_allowed ? ", such as 0x181 or 385" : ", digits only"));
        return false;
    }
    if (*value < range.min || *value > range.max) {
        site.faults.add(site.node.line, site.path, shown(site.node), wanted);
        return false;
    }
    out = *value;
    return true;
}

bool read_numbers(ValueSite site, Range range, std::span<double> out) {
    if (site.node.kind == YamlNode::Kind::refused) {
        return false;
    }
    if (site.node.kind != YamlNode::Kind::sequence || site.node.entries.size() != out.size()) {
        site.faults.add(site.node.line, site.path, shown(site.node),
                        "a list of " + std::to_string(out.size()) + " numbers, such as [" +
                            (out.size() == 2 ? "-300, 300]" : "0, 0, 0]"));
        return false;
    }
    std::vector<double> values(out.size());
    bool all_read = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string path = site.path + '[' + std::to_string(i) + ']';
        all_read &= read_number({site.node.entries[i].value, path, site.faults}, range, values[i]);
    }
    if (all_read) {
        std::copy(values.begin(), values.end(), out.begin());
    }
    return all_read;
}

bool read_name(ValueSite site, std::string& out) {
    if (site.node.kind == YamlNode::Kind::refused) {
        return false;
    }
    if (site.node.kind != YamlNode::Kind::scalar || !is_name(site.node.text)) {
        site.faults.add(site.node.line, site.path, shown(site.node),
                        "a name of at most " + std::to_string(kNameLengthMax) +
                            " letters a-z, A-Z, digits, _ - and ., a letter or digit first");
        return false;
    }
    out = site.node.text;
    return true;
}

}  // namespace axg
