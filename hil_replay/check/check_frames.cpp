// SPDX-License-Identifier: Apache-2.0
// Which bits of which frames are the axes, as it was read: from the machine file, a DBC file or the
// mapping of drives.
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/check/check_report.hpp"

namespace axg {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kFormats{"classical", "fd", "signals", "cia402"};
constexpr std::array<const char*, 3> kTypes{"integer", "float", "double"};
constexpr std::array<const char*, 8> kRoles{"position",    "velocity", "tool",    "moving",
                                            "tool_change", "homed",    "counter", "drive_status"};

template <std::size_t Count, class Enum>
const char* word_of(const std::array<const char*, Count>& words, Enum value) {
    return words.at(static_cast<std::size_t>(value));
}

bool is_number(SignalRole role) noexcept {
    return role == SignalRole::position || role == SignalRole::velocity;
}

Json facts_of(const Machine& machine, const CanSignal& signal, std::uint8_t frame_bytes) {
    const bool has_axis = is_number(signal.role) || signal.role == SignalRole::drive_status;
    Json facts{{"says", word_of(kRoles, signal.role)}};
    if (has_axis) {
        facts["axis"] = machine.axes[signal.axis].name;
    }
    facts["id"] = signal.id;
    facts["frame_bytes"] = frame_bytes;
    facts["start"] = signal.start_bit;
    facts["length"] = signal.length_bits;
    facts["order"] = signal.order == ByteOrder::little ? "little" : "big";
    facts["signed"] = signal.is_signed;
    facts["type"] = word_of(kTypes, signal.type);
    if (is_number(signal.role)) {
        facts["factor"] = signal.factor;
        facts["offset"] = signal.offset;
    } else if (signal.role != SignalRole::tool) {
        facts["mark"] = signal.mark;
    }
    if (signal.selector.length_bits != 0) {
        facts["page"] = signal.selector.value;
    }
    return facts;
}

/// "x 0.0001 mm", "yes is 2", "counts to 14", "homed is bit 8".
std::string meaning_of(const Machine& machine, const CanSignal& signal) {
    switch (signal.role) {
        case SignalRole::position:
        case SignalRole::velocity: {
            const bool is_rotary = machine.axes[signal.axis].kind == AxisKind::rotary;
            const std::string offset =
                signal.offset == 0 ? "" : fmt::format(" {:+.12g}", signal.offset);
            return fmt::format("x {:.12g}{} {}{}", signal.factor, offset, is_rotary ? "deg" : "mm",
                               signal.role == SignalRole::velocity ? "/s" : "");
        }
        case SignalRole::tool:
            return "a number";
        case SignalRole::moving:
        case SignalRole::tool_change:
        case SignalRole::homed:
            return fmt::format("yes is {}", signal.mark);
        case SignalRole::counter:
            return fmt::format("counts 0 to {}", signal.mark - 1);
        case SignalRole::drive_status:
            return signal.mark == 0 ? "always homed"
                                    : fmt::format("homed where 0x{:04X} is set", signal.mark);
    }
    return "";
}

void print(const CheckReport& report, const CanSignal& signal, std::uint8_t frame_bytes) {
    const Machine& machine = report.loaded.machine;
    const bool has_axis = is_number(signal.role) || signal.role == SignalRole::drive_status;
    const std::string page =
        signal.selector.length_bits == 0 ? "" : fmt::format(", page {}", signal.selector.value);
    fmt::print(
        report.words, "  {:<14} 0x{:03X}, {:>2} bytes{}  {:>3}|{:<2} {} {}{}  {}\n",
        (has_axis ? machine.axes[signal.axis].name + " " : "") + word_of(kRoles, signal.role),
        signal.id, frame_bytes, page, signal.start_bit, signal.length_bits,
        signal.order == ByteOrder::little ? "little" : "big",
        signal.type != SignalType::integer ? ""
        : signal.is_signed                 ? "signed "
                                           : "unsigned ",
        word_of(kTypes, signal.type), meaning_of(machine, signal));
}

}  // namespace

void report_frames(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    const CanLayout& can = machine.can;
    const AxisFrameSet set = make_frame_set(machine);
    Json& frames = report.document["frames"] = {{"format", word_of(kFormats, can.format)},
                                                {"sample_us", can.sample_us},
                                                {"frames_a_sample", set.frame_count}};
    fmt::print(
        report.words, "\nframes: {}, {} a sample of {} us{}\n", word_of(kFormats, can.format),
        set.frame_count, can.sample_us,
        can.format != CanFormat::cia402 ? ""
        : can.sync_counter_max == 0
            ? fmt::format(", within {} us after SYNC 0x{:03X}", can.sync_window_us, can.sync_id)
            : fmt::format(", within {} us after SYNC 0x{:03X} that counts 1 to {}",
                          can.sync_window_us, can.sync_id, can.sync_counter_max));
    if (set.signal_count == 0) {
        return;
    }
    bool says_tool = false;
    Json& signals = frames["signals"] = Json::array();
    for (std::uint32_t i = 0; i < set.signal_count; ++i) {
        const std::uint8_t frame_bytes = set.frame_bytes[set.signal_slots[i]];
        signals.push_back(facts_of(machine, set.signals[i], frame_bytes));
        print(report, set.signals[i], frame_bytes);
        says_tool |= set.signals[i].role == SignalRole::tool;
    }
    if (!says_tool && machine.tools.size() > 1) {
        report.warnings.push_back(fmt::format(
            "no frame says which of {} tools is in the spindle: tool {} is checked, whatever is "
            "changed",
            machine.tools.size(), machine.first_tool));
    }
}

}  // namespace axg
