// SPDX-License-Identifier: Apache-2.0
#include "config/text/map_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "config/text/fault_list.hpp"
#include "config/text/fault_text.hpp"
#include "config/text/nearest_word.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

/// The first character outside ASCII: a key may look right and still not be.
std::string look_alike_note(std::string_view key) {
    for (std::size_t at = 0; at < key.size(); ++at) {
        if (static_cast<unsigned char>(key[at]) >= 0x80U) {
            std::array<char, 64> note{};
            std::snprintf(note.data(), note.size(),
                          " with the character U+%04X, which is not ASCII",
                          static_cast<unsigned>(code_point_at(key, at).value));
            return note.data();
        }
    }
    return "";
}

const YamlEntry* entry_of(const YamlNode& node, std::string_view key) noexcept {
    for (const YamlEntry& entry : node.entries) {
        if (entry.key == key) {
            return &entry;
        }
    }
    return nullptr;
}

}  // namespace

MapReader::MapReader(const YamlNode& node, std::string path, std::span<const std::string_view> keys,
                     FaultList& faults)
    : node_(node), path_(std::move(path)), faults_(faults) {
    if (node.kind == YamlNode::Kind::refused) {
        return;
    }
    if (node.kind != YamlNode::Kind::map) {
        faults_.add(node.line, path_, shown(node), "a map with the keys " + listed(keys));
        return;
    }
    for (const YamlEntry& entry : node.entries) {
        if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) {
            continue;
        }
        const std::string_view nearest = nearest_word(entry.key, keys);
        if (!nearest.empty()) {
            misspelt_.push_back(nearest);
        }
        const std::string meant = nearest.empty() ? "" : "; did you mean " + quoted(nearest) + '?';
        faults_.add(entry.line, path_of(escaped(entry.key, kNameLengthMax)),
                    std::string{kUnknownKey} + look_alike_note(entry.key),
                    "one of " + listed(keys) + meant);
    }
}

std::string MapReader::path_of(std::string_view key) const {
    return path_.empty() ? std::string{key} : path_ + '.' + std::string{key};
}

bool MapReader::has(std::string_view key) const noexcept {
    return entry_of(node_, key) != nullptr;
}

int MapReader::line_of(std::string_view key) const noexcept {
    const YamlEntry* entry = entry_of(node_, key);
    return entry == nullptr ? node_.line : entry->line;
}

void MapReader::report(std::string_view key, std::string got, std::string wanted) {
    faults_.add(line_of(key), path_of(key), std::move(got), std::move(wanted));
}

bool MapReader::missing_was_misspelt(std::string_view key) const noexcept {
    return std::find(misspelt_.begin(), misspelt_.end(), key) != misspelt_.end();
}

const YamlNode* MapReader::find(std::string_view key, Need need, std::string_view wanted) {
    if (node_.kind != YamlNode::Kind::map) {
        return nullptr;
    }
    const YamlEntry* entry = entry_of(node_, key);
    if (entry == nullptr) {
        if (need == Need::required && !missing_was_misspelt(key)) {
            report(key, "", std::string{wanted});
        }
        return nullptr;
    }
    if (entry->value.kind == YamlNode::Kind::nothing) {
        report(key, "nothing",
               std::string{wanted} +
                   (need == Need::optional ? "; set a value or remove the key" : ""));
    }
    const bool is_usable = entry->value.kind != YamlNode::Kind::nothing &&
                           entry->value.kind != YamlNode::Kind::refused;
    return is_usable ? &entry->value : nullptr;
}

bool MapReader::number(std::string_view key, Need need, Range range, double& out) {
    const YamlNode* value = find(key, need, "a number");
    return value != nullptr && read_number({*value, path_of(key), faults_}, range, out);
}

bool MapReader::whole(std::string_view key, Need need, WholeRange range, std::uint32_t& out) {
    return whole_text(key, need, range, false, out);
}

bool MapReader::can_id(std::string_view key, Need need, WholeRange range, std::uint32_t& out) {
    return whole_text(key, need, range, true, out);
}

bool MapReader::whole_text(std::string_view key, Need need, WholeRange range, bool hex,
                           std::uint32_t& out) {
    const YamlNode* value = find(key, need, "an integer");
    return value != nullptr && read_whole({*value, path_of(key), faults_}, range, hex, out);
}

bool MapReader::boolean(std::string_view key, Need need, bool& out) {
    constexpr std::array<std::string_view, 2> kWords{"false", "true"};
    std::size_t index = 0;
    const YamlNode* value = find(key, need, "true or false");
    if (value != nullptr && value->is_quoted) {
        report(key, shown(*value) + " in quotes", "true or false, without quotes");
        return false;
    }
    if (value == nullptr || !choice(key, need, kWords, index)) {
        return false;
    }
    out = index == 1;
    return true;
}

bool MapReader::choice(std::string_view key, Need need, std::span<const std::string_view> words,
                       std::size_t& out) {
    const YamlNode* value = find(key, need, "one of " + listed(words));
    if (value == nullptr) {
        return false;
    }
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (value->kind == YamlNode::Kind::scalar && value->text == words[i]) {
            out = i;
            return true;
        }
    }
    const std::string_view nearest = nearest_word(value->text, words);
    report(key, shown(*value),
           "one of " + listed(words) +
               (nearest.empty() ? "" : "; did you mean " + quoted(nearest) + '?'));
    return false;
}

bool MapReader::text(std::string_view key, Need need, std::size_t size_max, std::string& out) {
    const YamlNode* value = find(key, need, "a text");
    if (value == nullptr) {
        return false;
    }
    const bool is_scalar = value->kind == YamlNode::Kind::scalar;
    const std::string clean = escaped(value->text, value->text.size() * 10 + 16);
    const bool is_blank = value->text.find_first_not_of(' ') == std::string::npos;
    if (!is_scalar || is_blank || value->text.size() > size_max || clean != value->text) {
        report(key, shown(*value),
               "one line of text, not blank, at most " + std::to_string(size_max) + " bytes");
        return false;
    }
    out = value->text;
    return true;
}

bool MapReader::name(std::string_view key, Need need, std::string& out) {
    const YamlNode* value = find(key, need, "a name");
    return value != nullptr && read_name({*value, path_of(key), faults_}, out);
}

bool MapReader::numbers(std::string_view key, Need need, Range range, std::span<double> out) {
    const YamlNode* value = find(key, need, "a list of " + std::to_string(out.size()) + " numbers");
    return value != nullptr && read_numbers({*value, path_of(key), faults_}, range, out);
}

}  // namespace axg
