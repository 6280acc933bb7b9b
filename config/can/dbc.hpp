// SPDX-License-Identifier: Apache-2.0
// Reads a DBC file: which message carries which signal, in which bits. A signal whose meaning
// depends on an unsupported statement is stored with a reason not to use it.
// Source: the format as Vector's "DBC File Format Documentation" 1.0.5 describes it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "config/text/config_fault.hpp"
#include "core/machine/machine.hpp"

namespace axg {

inline constexpr std::size_t kDbcSizeBytesMax = std::size_t{4} << 20U;
inline constexpr std::size_t kDbcMessagesMax = 5000;
inline constexpr std::size_t kDbcSignalsMax = 50'000;  // of all messages

struct DbcSignal {
    enum class Turn : std::uint8_t {
        every,     // in every frame of the message
        selector,  // M: its value selects the signals in a frame
        selected,  // m5: only in frames whose selector is 5, or has a value of SG_MUL_VAL_
        both       // m5M: selected, and selects in turn
    };
    std::string name;
    int line = 0;
    std::uint32_t start_bit = 0, length_bits = 0;
    ByteOrder order = ByteOrder::little;
    bool is_signed = false;
    SignalType type = SignalType::integer;
    double factor = 1, offset = 0;
    double minimum = 0, maximum = 0;  // both 0: not stated
    std::string unit;                 // bytes of the file, in whatever encoding it has
    Turn turn = Turn::every;
    std::uint32_t selected_by = 0;               // the number after m
    std::uint32_t multiplexor = kNoIndex;        // of the signals: the one that selects it
    std::vector<SignalSelector::Range> pages{};  // by these values; sorted, apart
    std::string refused;                         // why it cannot be used; empty where it can
};

struct DbcMessage {
    std::string name;
    int line = 0;
    std::uint32_t id = 0;
    bool is_extended = false;
    bool is_flexible = false;  // CAN FD by the attribute VFrameFormat, or more than 8 bytes
    std::uint32_t length_bytes = 0;
    std::vector<DbcSignal> signals;
};

struct Dbc {
    std::vector<DbcMessage> messages;
};

/// Returns no faults, or leaves `out` untouched and returns the faults: the first syntax error, or
/// all names and numbers that contradict each other. Time: proportional to the text.
/// @param file  the name shown in faults
[[nodiscard]] std::vector<ConfigFault> parse_dbc(std::string_view text, const std::string& file,
                                                 Dbc& out);

}  // namespace axg
