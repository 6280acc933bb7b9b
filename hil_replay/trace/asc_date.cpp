// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/trace/asc_date.hpp"

#include "hil_replay/trace/words.hpp"

namespace axg {
namespace {

using detail::to_number;

/// 1..12, or 0. The umlaut of March comes as UTF-8 and as Latin-1.
std::uint32_t month_of(std::string_view name) noexcept {
    struct Name {
        std::string_view text;
        std::uint32_t month;
    };
    constexpr Name kNames[] = {{"Jan", 1},        {"Feb", 2},    {"Mar", 3},  {"Mrz", 3},
                               {"M\xC3\xA4r", 3}, {"M\xE4r", 3}, {"Maer", 3}, {"Apr", 4},
                               {"May", 5},        {"Mai", 5},    {"Jun", 6},  {"Jul", 7},
                               {"Aug", 8},        {"Sep", 9},    {"Oct", 10}, {"Okt", 10},
                               {"Nov", 11},       {"Dec", 12},   {"Dez", 12}};
    for (const Name& known : kNames) {
        if (known.text == name) {
            return known.month;
        }
    }
    return 0;
}

/// Days since 1970-01-01 in the Gregorian calendar: years counted from March, so that the leap day
/// comes last.
std::int64_t days_since_1970(std::int64_t year, std::int64_t month, std::int64_t day) noexcept {
    const std::int64_t y = month > 2 ? year : year - 1;
    const std::int64_t m = month > 2 ? month - 3 : month + 9;
    const std::int64_t day_of_year = (153 * m + 2) / 5 + day - 1;
    return 365 * y + y / 4 - y / 100 + y / 400 + day_of_year - 719'468;
}

/// `15:06:13` or `15:06:13.191`.
bool parse_clock(std::string_view text, std::uint32_t& hour, std::int64_t& rest_us) noexcept {
    std::uint32_t minute = 0, second = 0, fraction = 0;
    const std::size_t first = text.find(':');
    const std::size_t last = text.rfind(':');
    if (first == std::string_view::npos || first == last) {
        return false;
    }
    const std::size_t point = text.find('.', last);
    const bool has_fraction = point != std::string_view::npos;
    const std::string_view digits = has_fraction ? text.substr(point + 1) : std::string_view{};
    if (digits.size() > 6 || (has_fraction && !to_number(digits, 10, 999'999, fraction))) {
        return false;
    }
    for (std::size_t i = digits.size(); i < 6; ++i) {
        fraction *= 10;
    }
    const std::size_t second_end = has_fraction ? point : text.size();
    rest_us = fraction;
    const bool is_time = to_number(text.substr(0, first), 10, 23, hour) &&
                         to_number(text.substr(first + 1, last - first - 1), 10, 59, minute) &&
                         to_number(text.substr(last + 1, second_end - last - 1), 10, 60, second);
    rest_us += (std::int64_t{minute} * 60 + second) * 1'000'000;
    return is_time;
}

}  // namespace

bool parse_asc_date(std::string_view text, std::int64_t& time_us) noexcept {
    detail::Words words(text);
    const std::string_view weekday = words.next();
    const std::uint32_t month = month_of(words.next());
    std::uint32_t day = 0, hour = 0, year = 0;
    std::int64_t rest_us = 0;
    if (weekday.empty() || month == 0 || !to_number(words.next(), 10, 31, day) || day == 0 ||
        !parse_clock(words.next(), hour, rest_us)) {
        return false;
    }
    std::string_view word = words.next();
    if (word == "am" || word == "pm" || word == "AM" || word == "PM") {
        if (hour < 1 || hour > 12) {
            return false;
        }
        hour = hour % 12 + (word == "pm" || word == "PM" ? 12 : 0);
        word = words.next();
    }
    if (!to_number(word, 10, 9999, year) || year < 1970 || !words.rest().empty()) {
        return false;
    }
    time_us = (days_since_1970(year, month, day) * 24 + hour) * 3'600'000'000LL + rest_us;
    return true;
}

}  // namespace axg
