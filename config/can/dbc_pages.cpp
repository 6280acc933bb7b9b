// SPDX-License-Identifier: Apache-2.0
#include "config/can/dbc_pages.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>

namespace axg {
namespace {

using PageRange = SignalSelector::Range;

bool is_page(const DbcSignal& signal) noexcept {
    return signal.turn == DbcSignal::Turn::selected || signal.turn == DbcSignal::Turn::both;
}

bool is_multiplexor(const DbcSignal& signal) noexcept {
    return signal.turn == DbcSignal::Turn::selector || signal.turn == DbcSignal::Turn::both;
}

/// Sorted, and as few as there can be.
std::vector<PageRange> joined(std::vector<PageRange> values) {
    std::sort(values.begin(), values.end(), [](const PageRange& a, const PageRange& b) {
        return std::tie(a.least, a.most) < std::tie(b.least, b.most);
    });
    std::vector<PageRange> out;
    for (const PageRange& range : values) {
        if (!out.empty() && range.least <= std::uint64_t{out.back().most} + 1) {
            out.back().most = std::max(out.back().most, range.most);
        } else {
            out.push_back(range);
        }
    }
    return out;
}

bool has_value(const std::vector<PageRange>& values, std::uint32_t value) {
    return std::any_of(values.begin(), values.end(), [value](const PageRange& range) {
        return range.least <= value && value <= range.most;
    });
}

/// Why a line and its signal contradict each other; empty: they do not.
const char* fault_of(const DbcMessage& message, const DbcSignal& signal, const DbcPages& line,
                     std::uint32_t multiplexor) {
    if (signal.turn == DbcSignal::Turn::every) {
        return "SG_MUL_VAL_, but no m in its SG_";
    }
    if (multiplexor == kNoIndex || !is_multiplexor(message.signals[multiplexor])) {
        return "an SG_MUL_VAL_ whose multiplexor is none";
    }
    if (std::any_of(line.values.begin(), line.values.end(),
                    [](const PageRange& range) { return range.least > range.most; })) {
        return "an SG_MUL_VAL_ whose range decreases";
    }
    // Some write M for m5M: then the line alone has the values.
    if (is_page(signal) && !has_value(line.values, signal.selected_by)) {
        return "an SG_MUL_VAL_ without the number of its m";
    }
    const bool is_other = signal.multiplexor != kNoIndex && (signal.multiplexor != multiplexor ||
                                                             signal.pages != joined(line.values));
    return is_other ? "two SG_MUL_VAL_ that differ" : "";
}

void refuse(DbcSignal& signal, const char* why) {
    if (signal.refused.empty()) {
        signal.refused = why;
    }
}

}  // namespace

void apply_pages(DbcMessage& message, const std::vector<DbcPages>& lines) {
    std::map<std::string_view, std::uint32_t> index_of;
    std::uint32_t multiplexors = 0, last = kNoIndex;
    for (std::uint32_t i = 0; i < message.signals.size(); ++i) {
        index_of.emplace(message.signals[i].name, i);
        if (is_multiplexor(message.signals[i])) {
            ++multiplexors;
            last = i;
        }
    }
    for (const DbcPages& line : lines) {
        const auto found = index_of.find(line.signal);
        if (found == index_of.end()) {
            continue;
        }
        const auto named = index_of.find(line.multiplexor);
        const std::uint32_t multiplexor = named == index_of.end() ? kNoIndex : named->second;
        DbcSignal& signal = message.signals[found->second];
        refuse(signal, fault_of(message, signal, line, multiplexor));
        if (signal.refused.empty()) {
            signal.multiplexor = multiplexor;
            signal.pages = joined(line.values);
        }
    }
    for (DbcSignal& signal : message.signals) {
        if (!is_page(signal) || signal.multiplexor != kNoIndex || !signal.refused.empty()) {
            continue;
        }
        if (multiplexors == 0 || (multiplexors == 1 && is_page(message.signals[last]))) {
            refuse(signal, "a multiplexed message without multiplexor");
        } else if (multiplexors > 1) {
            refuse(signal, "a page without SG_MUL_VAL_, beside a second multiplexor");
        } else {
            signal.multiplexor = last;
            signal.pages = {{signal.selected_by, signal.selected_by}};
        }
    }
}

}  // namespace axg
