// SPDX-License-Identifier: Apache-2.0
#include "config/init/linuxcnc_ini.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "config/text/fault_text.hpp"
#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr double kNoLimit = 1e9;  // LinuxCNC's default limits are +-1e99
constexpr std::string_view kAxisLetters = "XYZABCUVW";

struct Value {
    std::string text;
    std::uint32_t line = 0;
};
using Sections = std::map<std::string, std::map<std::string, Value>>;

std::string_view trimmed(std::string_view text) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && is_blank(text.front())) {
        text.remove_prefix(1);
    }
    while (!text.empty() && is_blank(text.back())) {
        text.remove_suffix(1);
    }
    return text;
}

std::string upper(std::string_view text) {
    std::string out(text);
    std::transform(out.begin(), out.end(), out.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return out;
}

/// The first value of a name counts, as in LinuxCNC.
Sections sections_of(std::string_view text) {
    Sections out;
    std::string section;
    std::uint32_t number = 0;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        ++number;
        const std::size_t equals = line.find('=');
        if (line.empty() || line.front() == '#' || line.front() == ';') {
            continue;
        }
        if (line.front() == '[') {
            section = upper(line.substr(1, line.find(']') - 1));
        } else if (equals != std::string_view::npos) {
            const std::string_view value = trimmed(line.substr(equals + 1));
            out[section].try_emplace(upper(trimmed(line.substr(0, equals))),
                                     Value{std::string(value), number});
        }
    }
    return out;
}

/// As C's strtod would read it, the whole word.
std::optional<double> number_of(std::string_view word) {
    if (word.starts_with('+')) {
        word.remove_prefix(1);
    }
    double value = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool is_whole = read.ec == std::errc{} && read.ptr == word.data() + word.size();
    return is_whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

class Reader {
  public:
    Reader(const Sections& sections, const std::string& name) : sections_(sections), name_(name) {}

    IniAxes read() {
        const Value* coordinates = find("TRAJ", "COORDINATES");
        const Value* units = find("TRAJ", "LINEAR_UNITS");
        const std::string unit = units == nullptr ? "" : upper(units->text);
        const bool is_inch = unit == "INCH" || unit == "IN" || unit == "IMPERIAL";
        if (!is_inch && unit != "MM" && unit != "METRIC") {
            fault("TRAJ", "LINEAR_UNITS", units, "mm or inch");
        }
        if (coordinates == nullptr) {
            fault("TRAJ", "COORDINATES", nullptr, "the letters of the axes, such as XYZAC");
            return std::move(out_);
        }
        std::uint32_t joint = 0;
        for (const char c : upper(coordinates->text)) {
            if (kAxisLetters.find(c) == std::string_view::npos) {
                continue;  // blanks between the letters
            }
            const auto known = std::find_if(out_.axes.begin(), out_.axes.end(),
                                            [c](const IniAxis& axis) { return axis.letter == c; });
            IniAxis& axis = known == out_.axes.end() ? out_.axes.emplace_back() : *known;
            axis.letter = c;
            axis.is_rotary = c >= 'A' && c <= 'C';
            scale_ = axis.is_rotary || !is_inch ? 1.0 : 25.4;
            take(std::string("AXIS_") + c, axis);
            take(std::string("JOINT_").append(std::to_string(joint++)), axis);
        }
        for (IniAxis& axis : out_.axes) {
            axis.is_unlimited = axis.is_unlimited || (axis.is_rotary && !axis.min && !axis.max);
        }
        return std::move(out_);
    }

  private:
    const Value* find(const std::string& section, const std::string& key) const {
        const auto in = sections_.find(section);
        if (in == sections_.end()) {
            return nullptr;
        }
        const auto value = in->second.find(key);
        return value == in->second.end() ? nullptr : &value->second;
    }

    void fault(const std::string& section, const std::string& key, const Value* value,
               const std::string& wanted) {
        std::string text = name_;
        if (value != nullptr) {
            text.append(":").append(std::to_string(value->line));
        }
        text.append(": [").append(section).append("] ").append(key).append(": ");
        out_.faults.push_back(text +
                              (value == nullptr
                                   ? fault_text("missing required key", "", wanted)
                                   : fault_text("invalid value", quoted(value->text, 40), wanted)));
    }

    /// In mm or degrees; the tighter of two, by `pick`.
    template <class Pick>
    void number(const std::string& section, const char* key, bool is_size,
                std::optional<double>& kept, Pick pick) {
        const Value* value = find(section, key);
        if (value == nullptr) {
            return;
        }
        const std::string_view word =
            std::string_view(value->text).substr(0, value->text.find_first_of(" \t#;"));
        const std::optional<double> read = number_of(word);
        if (!read || (is_size && !(*read > 0))) {
            fault(section, key, value, is_size ? "a number above 0" : "a number");
        } else if (std::abs(*read) < kNoLimit) {
            kept = kept ? pick(*kept, *read * scale_) : *read * scale_;
        }
    }

    void take(const std::string& section, IniAxis& axis) {
        const auto least = [](double a, double b) { return std::min(a, b); };
        const auto most = [](double a, double b) { return std::max(a, b); };
        number(section, "MIN_LIMIT", false, axis.min, most);
        number(section, "MAX_LIMIT", false, axis.max, least);
        number(section, "MAX_VELOCITY", true, axis.speed, least);
        number(section, "MAX_ACCELERATION", true, axis.acceleration, least);
        number(section, "MAX_JERK", true, axis.jerk, least);
        const Value* wrapped = find(section, "WRAPPED_ROTARY");
        axis.is_unlimited =
            axis.is_unlimited || (axis.is_rotary && wrapped != nullptr && wrapped->text == "1");
        const bool is_empty = axis.min && axis.max && !(*axis.min < *axis.max);
        const Value* const low = find(section, "MIN_LIMIT");
        const Value* const high = find(section, "MAX_LIMIT");
        if (is_empty && high != nullptr) {
            fault(section, "MAX_LIMIT", high, "more than MIN_LIMIT");
        } else if (is_empty && low != nullptr) {
            fault(section, "MIN_LIMIT", low, "less than MAX_LIMIT");
        }
    }

    const Sections& sections_;
    const std::string& name_;
    IniAxes out_;
    double scale_ = 1;
};

}  // namespace

IniAxes read_linuxcnc_ini(std::string_view text, const std::string& name) {
    const Sections sections = sections_of(text);
    return Reader(sections, name).read();
}

}  // namespace axg
