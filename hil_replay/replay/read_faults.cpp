// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/read_faults.hpp"

#include <fmt/format.h>

#include <charconv>
#include <set>

#include "hil_replay/board/motion_board.hpp"

namespace axg {

namespace {

constexpr double kSecondsMax = 86400;

/// Field that a word sets: a share, or an instant.
struct Place {
    std::string_view name;
    double BusFaults::*share = nullptr;
    std::int64_t BusFaults::*from_us = nullptr;
};
constexpr Place kPlaces[] = {
    {"lost", &BusFaults::lost, nullptr},
    {"late", &BusFaults::late, nullptr},
    {"corrupted", &BusFaults::corrupted, nullptr},
    {"permit-lost", &BusFaults::permit_lost, nullptr},
    {"silent", nullptr, &BusFaults::silent_from_us},
    {"killed", nullptr, &BusFaults::killed_from_us},
    {"stuck", nullptr, &BusFaults::stuck_from_us},
    {"all-late", nullptr, &BusFaults::late_from_us},
};

std::string read_fault(std::string_view word, BusFaults& faults) {
    const std::size_t equals = word.find('=');
    for (const Place& place : kPlaces) {
        if (equals == std::string_view::npos || word.substr(0, equals) != place.name) {
            continue;
        }
        const std::string_view number = word.substr(equals + 1);
        double value = 0;
        const auto read = std::from_chars(number.data(), number.data() + number.size(), value);
        const double most = place.share != nullptr ? 1 : kSecondsMax;
        const bool is_whole = read.ec == std::errc{} && read.ptr == number.data() + number.size();
        if (!is_whole || !(value >= 0 && value <= most)) {
            return fmt::format(
                "{}: invalid value (found \"{}\", expected a number from 0 to {:g}).", place.name,
                number, most);
        }
        if (place.share != nullptr) {
            faults.*place.share = value;
        } else {
            faults.*place.from_us = kBoardStartUs + static_cast<std::int64_t>(value * 1e6);
        }
        return {};
    }
    std::string names;
    for (const Place& place : kPlaces) {
        names += fmt::format("{}{}=", names.empty() ? "" : ", ", place.name);
    }
    return fmt::format("unknown fault (found \"{}\", expected one of {}).", word, names);
}

}  // namespace

std::string read_faults(std::string_view text, BusFaults& faults) {
    std::set<std::string_view> seen;
    while (!text.empty()) {
        const std::size_t comma = std::min(text.find(','), text.size());
        const std::string_view name = text.substr(0, std::min(comma, text.find('=')));
        if (!seen.insert(name).second) {
            return fmt::format("{}: given twice. Leave one of them out.", name);
        }
        std::string fault = read_fault(text.substr(0, comma), faults);
        if (!fault.empty()) {
            return fault;
        }
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return {};
}

}  // namespace axg
