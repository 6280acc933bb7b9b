// SPDX-License-Identifier: Apache-2.0
#include "config/can/eds.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <map>
#include <set>

#include "config/text/fault_list.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kMappedMax = 64;  // entries of a mapping, more are other things
constexpr std::size_t kLineBytesMax = 4096;

char lower(char c) noexcept {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::string lowered(std::string_view text) {
    std::string out{text};
    std::transform(out.begin(), out.end(), out.begin(), lower);
    return out;
}

std::string_view trimmed(std::string_view text) noexcept {
    constexpr std::string_view kBlanks = " \t\r";
    const std::size_t begin = text.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) {
        return {};
    }
    return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

struct Entry {
    std::string_view value;
    int line;
};

/// A number of CiA 306: decimal or 0x and hexadecimal digits. A leading zero would be octal to some
/// readers and decimal to others.
std::optional<std::uint32_t> number_of(std::string_view text) noexcept {
    const bool is_hex = text.starts_with("0x") || text.starts_with("0X");
    text.remove_prefix(is_hex ? 2 : 0);
    if (!is_hex && text.size() > 1 && text[0] == '0') {
        return std::nullopt;
    }
    std::uint32_t value = 0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value, is_hex ? 16 : 10);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{value} : std::nullopt;
}

class EdsReader {
  public:
    EdsReader(const std::string& file, std::uint32_t node) : faults_(file), node_(node) {}

    std::vector<ConfigFault> run(std::string_view text, Eds& out) {
        if (split(text)) {
            read_device();
            read_pdos();
        }
        if (faults_.empty()) {
            out = std::move(eds_);
        }
        return faults_.in_order();
    }

  private:
    bool split(std::string_view text);
    bool take_line(std::string_view line, int number, std::string& section);
    [[nodiscard]] const Entry* find(const std::string& section, const char* key) const {
        const auto found = entries_.find(section + '=' + key);
        return found == entries_.end() ? nullptr : &found->second;
    }
    bool value_of(const std::string& section, std::uint32_t& out, int* line = nullptr);
    [[nodiscard]] std::optional<std::uint32_t> sum_of(std::string_view rest) const;
    [[nodiscard]] std::optional<std::uint32_t> default_of(const std::string& section,
                                                          std::uint32_t used) const;
    void read_device();
    void read_pdos();
    bool read_map(std::uint32_t index, EdsPdo& pdo);

    FaultList faults_;
    std::uint32_t node_;
    std::map<std::string, Entry> entries_;  // "1800sub1=defaultvalue"
    Eds eds_;
};

/// "key=value" and "[section]", one a line; ";" begins a comment.
bool EdsReader::split(std::string_view text) {
    std::string section;
    int number = 0;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (!take_line(line, ++number, section)) {
            return false;
        }
    }
    return true;
}

bool EdsReader::take_line(std::string_view line, int number, std::string& section) {
    if (line.starts_with("\xEF\xBB\xBF")) {
        line.remove_prefix(3);
    }
    if (line.empty() || line[0] == ';') {
        return true;
    }
    const std::size_t equals = line.find('=');
    if (line.size() > kLineBytesMax || entries_.size() >= kEdsEntriesMax) {
        faults_.add(number, "", "a line or a file that is too long",
                    "lines of at most 4096 bytes, 200000 of them");
        return false;
    }
    if (line[0] == '[') {
        if (line.back() != ']') {
            faults_.add(number, "", quoted(line, 40), "a section in brackets, such as [1800sub1]");
            return false;
        }
        section = lowered(trimmed(line.substr(1, line.size() - 2)));
        return true;
    }
    if (equals == std::string_view::npos) {
        faults_.add(number, escaped(section, 40), quoted(line, 40),
                    "key=value, such as PDOMapping=0");
        return false;
    }
    const std::string key = section + '=' + lowered(trimmed(line.substr(0, equals)));
    const auto [entry, is_new] =
        entries_.emplace(key, Entry{trimmed(line.substr(equals + 1)), number});
    if (!is_new && entry->second.value != trimmed(line.substr(equals + 1))) {
        faults_.add(number, escaped(key, 80), quoted(trimmed(line.substr(equals + 1)), 40),
                    "one value: line " + std::to_string(entry->second.line) + " states another");
    }
    return true;
}

/// ParameterValue before DefaultValue; empty is absent. False: absent, or reported.
bool EdsReader::value_of(const std::string& section, std::uint32_t& out, int* line) {
    for (const char* key : {"parametervalue", "defaultvalue"}) {
        const Entry* entry = find(section, key);
        if (entry == nullptr || entry->value.empty()) {
            continue;
        }
        if (line != nullptr) {
            *line = entry->line;
        }
        const std::optional<std::uint32_t> sum = sum_of(entry->value);
        if (!sum) {
            faults_.add(entry->line, section + '.' + key, quoted(entry->value, 40),
                        "a number, such as 385, 0x181 or $NODEID+0x180");
            return false;
        }
        out = *sum;
        return true;
    }
    return false;
}

/// $NODEID+0x180, or the two the other way round.
std::optional<std::uint32_t> EdsReader::sum_of(std::string_view rest) const {
    std::uint32_t sum = 0;
    bool has_node = false;
    for (;;) {
        const std::size_t plus = std::min(rest.find('+'), rest.size());
        const std::string_view part = trimmed(rest.substr(0, plus));
        const bool is_node = lowered(part) == "$nodeid";
        const std::optional<std::uint32_t> number =
            is_node ? std::optional{node_} : number_of(part);
        if (!number || (is_node && has_node)) {
            return std::nullopt;
        }
        sum += *number;
        has_node |= is_node;
        if (plus == rest.size()) {
            return sum;
        }
        rest.remove_prefix(plus + 1);
    }
}

/// An EDS describes every device of its type: a number that replaces $NODEID is that of one of
/// them. A DCF is written for one node.
std::optional<std::uint32_t> EdsReader::default_of(const std::string& section,
                                                   std::uint32_t used) const {
    const Entry* const written = find(section, "parametervalue");
    const Entry* const usual = find(section, "defaultvalue");
    if (eds_.node || written == nullptr || written->value.empty() || usual == nullptr ||
        lowered(usual->value).find("$nodeid") == std::string::npos) {
        return std::nullopt;
    }
    const std::optional<std::uint32_t> sum = sum_of(usual->value);
    return sum && *sum != used ? sum : std::nullopt;
}

void EdsReader::read_device() {
    // Misspelt in the standard itself; both forms are seen.
    for (const char* section : {"devicecomissioning", "devicecommissioning"}) {
        const Entry* entry = find(section, "nodeid");
        if (entry == nullptr || entry->value.empty()) {
            continue;
        }
        eds_.node = number_of(entry->value);
        if (!eds_.node) {
            faults_.add(entry->line, std::string{section} + ".nodeid", quoted(entry->value, 40),
                        "a number from 1 to 127");
        } else if (*eds_.node != node_) {
            faults_.add(
                entry->line, std::string{section} + ".nodeid",
                std::to_string(*eds_.node) + " (machine file: " + std::to_string(node_) + ')',
                "the file of this drive, or its node number");
        }
    }
}

std::string hex(std::uint32_t value) {
    std::array<char, 16> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%x", value);
    return buffer.data();
}

/// Reads only the active entries: subindex 0 is their number, and the file may contain more.
bool EdsReader::read_map(std::uint32_t index, EdsPdo& pdo) {
    const std::string base = hex(index) + "sub";
    std::uint32_t count = 0;
    int line = 0;
    if (!value_of(base + '0', count, &line)) {
        return false;
    }
    if (count > kMappedMax) {
        faults_.add(line, base + '0', std::to_string(count), "at most 64 mapped objects");
        return false;
    }
    for (std::uint32_t i = 1; i <= count; ++i) {
        std::uint32_t object = 0;
        if (!value_of(base + hex(i), object)) {
            faults_.add(line, base + hex(i), "no value",
                        "the mapped object; subindex 0 states " + std::to_string(count) +
                            " mapped objects");
            return false;
        }
        pdo.map.push_back(object);
    }
    return true;
}

/// Reads the transmit PDOs that the file contains: 1800sub1 to 19FFsub1.
void EdsReader::read_pdos() {
    std::set<std::uint32_t> indices;
    const auto end = entries_.lower_bound("1a00");
    for (auto entry = entries_.lower_bound("1800"); entry != end; ++entry) {
        const std::string_view key = entry->first;
        std::uint32_t index = 0;
        const auto read = std::from_chars(key.data(), key.data() + key.size(), index, 16);
        if (read.ptr == key.data() + 4 && key.substr(4).starts_with("sub1=")) {
            indices.insert(index);
        }
    }
    for (const std::uint32_t index : indices) {
        EdsPdo pdo;
        pdo.number = index - 0x1800 + 1;
        const std::string base = hex(index) + "sub";
        if (value_of(base + '1', pdo.cob_id, &pdo.line) &&
            value_of(base + '2', pdo.transmission_type) && read_map(index + 0x200, pdo)) {
            pdo.default_cob_id = default_of(base + '1', pdo.cob_id);
            eds_.pdos.push_back(std::move(pdo));
        }
    }
}

}  // namespace

std::vector<ConfigFault> parse_eds(std::string_view text, const std::string& file,
                                   std::uint32_t node, Eds& out) {
    if (text.size() > kEdsSizeBytesMax) {
        FaultList faults{file};
        faults.add(1, "", std::to_string(text.size()) + " bytes",
                   "at most " + std::to_string(kEdsSizeBytesMax) + " bytes");
        return faults.in_order();
    }
    return EdsReader{file, node}.run(text, out);
}

}  // namespace axg
