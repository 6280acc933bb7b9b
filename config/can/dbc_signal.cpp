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

std::string add_selector(const DbcMessage& message, const DbcSignal& signal, CanSignal& out) {
    for (const DbcSignal& other : message.signals) {
        if (signal.turn != DbcSignal::Turn::selected || other.turn != DbcSignal::Turn::selector) {
            continue;
        }
        if (other.length_bits < 1 || other.length_bits > 32 || other.is_signed) {
            return "a message whose multiplexor is signed, or longer than 32 bits";
        }
        if (other.length_bits < 32 && signal.selected_by >> other.length_bits != 0) {
            return "a multiplexor value that its multiplexor cannot represent";
        }
        CanSignal selector;
        selector.start_bit = static_cast<std::uint16_t>(other.start_bit);
        selector.length_bits = static_cast<std::uint8_t>(other.length_bits);
        selector.order = other.order;
        FrameBits bits;
        if (other.start_bit >= kFrameBitsMax ||
            !covered_bits(selector, message.length_bytes * 8, bits)) {
            return bits_outside(message);
        }
        out.selector = {selector.start_bit, selector.length_bits, selector.order,
                        signal.selected_by};
    }
    return "";
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
    std::string refused = add_selector(message, signal, made);
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
