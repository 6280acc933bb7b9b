// SPDX-License-Identifier: Apache-2.0
#include "config/can/dbc_signal.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "config/can/signal_rules.hpp"
#include "core/machine/can_id.hpp"

namespace axg {
namespace {

bool is_can_length(std::uint32_t bytes) noexcept {
    constexpr std::array<std::uint32_t, 7> kFlexible{12, 16, 20, 24, 32, 48, 64};
    return (bytes >= 1 && bytes <= 8) ||
           std::find(kFlexible.begin(), kFlexible.end(), bytes) != kFlexible.end();
}

std::string bits_outside(const DbcMessage& message) {
    return "bits outside the message's " + std::to_string(message.length_bytes) + " bytes";
}

/// Adds the values of one multiplexor, inside those that were added before. Returns the fault.
std::string add_level(const DbcMessage& message, const DbcSignal& multiplexor,
                      const std::vector<SignalSelector::Range>& pages, SignalSelector& out,
                      FrameBits& taken) {
    const std::uint32_t length = multiplexor.length_bits;
    if (length < 1 || length > 32 || multiplexor.type != SignalType::integer) {
        return "a message whose multiplexor is a float, or longer than 32 bits";
    }
    CanSignal selector;
    selector.start_bit = static_cast<std::uint16_t>(multiplexor.start_bit);
    selector.length_bits = static_cast<std::uint8_t>(length);
    selector.order = multiplexor.order;
    FrameBits bits;
    if (multiplexor.start_bit >= kFrameBitsMax ||
        !covered_bits(selector, message.length_bytes * 8, bits)) {
        return bits_outside(message);
    }
    if ((taken & bits).any()) {
        return "multiplexors that share bits";
    }
    taken |= bits;
    std::size_t used = 0;
    for (std::uint32_t i = 0; i < out.level_count; ++i) {
        used += out.levels[i].range_count;
    }
    if (used + pages.size() > kSelectorRangesMax) {
        return "more than " + std::to_string(kSelectorRangesMax) + " ranges of multiplexor values";
    }
    // Values are not negative: a signed multiplexor has them without its sign bit, as read here.
    const std::uint32_t bits_of_value = length - (multiplexor.is_signed ? 1U : 0U);
    const auto most = static_cast<std::uint32_t>((std::uint64_t{1} << bits_of_value) - 1);
    out.levels[out.level_count++] = {selector.start_bit, selector.length_bits, selector.order,
                                     static_cast<std::uint8_t>(pages.size())};
    for (const SignalSelector::Range& range : pages) {
        if (range.least > most) {
            return "a multiplexor value that its multiplexor cannot represent";
        }
        out.ranges[used++] = {range.least, std::min(range.most, most)};
    }
    return "";
}

/// The multiplexors of a signal, the outermost first, each with its values.
std::string add_selector(const DbcMessage& message, const DbcSignal& signal, SignalSelector& out) {
    std::array<const DbcSignal*, kSelectorLevelsMax> pages{};
    std::uint32_t depth = 0;
    for (const DbcSignal* at = &signal; at->multiplexor != kNoIndex;
         at = &message.signals[at->multiplexor]) {
        if (depth == kSelectorLevelsMax) {  // or a circle
            return "more than " + std::to_string(kSelectorLevelsMax) +
                   " multiplexors, one in the other";
        }
        if (!at->refused.empty()) {
            return at->refused;
        }
        pages[depth++] = at;
    }
    if (depth > 0 && !message.signals[pages[depth - 1]->multiplexor].refused.empty()) {
        return message.signals[pages[depth - 1]->multiplexor].refused;
    }
    FrameBits taken;
    std::string fault;
    while (depth > 0 && fault.empty()) {
        const DbcSignal& page = *pages[--depth];
        fault = add_level(message, message.signals[page.multiplexor], page.pages, out, taken);
    }
    return fault;
}

}  // namespace

std::string to_can_signal(const DbcMessage& message, const DbcSignal& signal, CanSignal& out) {
    if (!signal.refused.empty()) {
        return signal.refused;
    }
    if (message.id == 0) {
        return "identifier 0";
    }
    if (!is_can_length(message.length_bytes)) {
        return "a message of " + std::to_string(message.length_bytes) + " bytes";
    }
    const bool is_integer = signal.type == SignalType::integer;
    if (signal.length_bits < 1 || signal.length_bits > (is_integer ? kExactBitsMax : 64)) {
        return std::to_string(signal.length_bits) + " bits (1 to 53 are read)";
    }
    if (!(std::fabs(signal.factor) >= 1e-12 && std::fabs(signal.factor) <= 1e9) ||
        !(std::fabs(signal.offset) <= 1e9)) {
        return "a factor of 0, or outside 1e-12 to 1e9";
    }
    CanSignal made;
    made.id = wire_id(message.id, message.is_extended);
    made.start_bit = static_cast<std::uint16_t>(signal.start_bit);
    made.length_bits = static_cast<std::uint8_t>(signal.length_bits);
    made.order = signal.order;
    made.is_signed = signal.is_signed;
    made.factor = signal.factor;
    made.offset = signal.offset;
    made.type = signal.type;
    made.frame_bytes = static_cast<std::uint8_t>(message.length_bytes);
    made.is_flexible = message.is_flexible;
    FrameBits bits;
    if (signal.start_bit >= kFrameBitsMax || !covered_bits(made, message.length_bytes * 8, bits)) {
        return bits_outside(message);
    }
    std::string refused = add_selector(message, signal, made.selector);
    if (refused.empty()) {
        out = made;
    }
    return refused;
}

std::optional<std::size_t> unit_named(std::string_view text) noexcept {
    struct Spelling {
        std::string_view text, name;
    };
    constexpr std::array<Spelling, 15> kSpellings{{{"in", "inch"},
                                                   {"\xB5m", "um"},
                                                   {"\xC2\xB5m", "um"},
                                                   {"\xCE\xBCm", "um"},
                                                   {"\xB0", "deg"},
                                                   {"\xC2\xB0", "deg"},
                                                   {"degree", "deg"},
                                                   {"degrees", "deg"},
                                                   {"Deg", "deg"},
                                                   {"rev", "turn"},
                                                   {"turns", "turn"},
                                                   {"radian", "rad"},
                                                   {"radians", "rad"},
                                                   {"MM", "mm"},
                                                   {"millimeter", "mm"}}};
    for (const Spelling& spelling : kSpellings) {
        text = text == spelling.text ? spelling.name : text;
    }
    const auto* const found = std::find(kSignalUnitNames.begin(), kSignalUnitNames.end(), text);
    if (found == kSignalUnitNames.end()) {
        return std::nullopt;
    }
    return static_cast<std::size_t>(found - kSignalUnitNames.begin());
}

}  // namespace axg
