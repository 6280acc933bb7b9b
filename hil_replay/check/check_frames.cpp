// SPDX-License-Identifier: Apache-2.0
// Which bits of which frames are the axes, as it was read: from the machine file, a DBC file or the
// mapping of drives.
#include <fmt/format.h>

#include <array>

#include "core/machine/can_id.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/check/check_report.hpp"

namespace axg {
namespace {

constexpr std::array<const char*, 3> kTypes{"integer", "float", "double"};
constexpr std::array<const char*, 8> kRoles{"position",    "velocity", "tool",    "moving",
                                            "tool_change", "homed",    "counter", "drive_status"};

template <std::size_t Count, class Enum>
const char* word_of(const std::array<const char*, Count>& words, Enum value) {
    return words.at(static_cast<std::size_t>(value));
}

/// Which bytes of which identifier carry which axis, in frames of our own.
void print_native(const CheckReport& report, const AxisFrameSet& set) {
    const Machine& machine = report.loaded.machine;
    const auto name = [&machine](std::size_t slot) {
        const std::size_t axes = machine.axes.size();
        return slot < axes ? machine.axes[slot].name : slot == axes ? "status" : "zeros";
    };
    if (set.is_flexible[0]) {
        std::string places;
        for (std::size_t i = 0; i < machine.axes.size(); ++i) {
            places += fmt::format("  {} in bytes {} to {}", name(i), 4 + 4 * i, 7 + 4 * i);
        }
        fmt::print(report.words, "  0x{:03X}, data id 0x{:04X}{}\n", set.ids[0], set.data_ids[0],
                   places);
        return;
    }
    for (std::size_t i = 0; i < set.frame_count; ++i) {
        fmt::print(report.words,
                   "  0x{:03X}, data id 0x{:04X}  {} in bytes 2 to 4  {} in bytes 5 "
                   "to 7\n",
                   set.ids[i], set.data_ids[i], name(2 * i), name(2 * i + 1));
    }
}

void print_ids(const CheckReport& report) {
    const CanLayout& can = report.loaded.machine.can;
    fmt::print(report.words, "  from the board:");
    if (has_sync(wire_of(can))) {
        fmt::print(report.words, " SYNC 0x{:03X}", can.sync_id);
    }
    if (is_native(can)) {
        fmt::print(report.words, ", heartbeat 0x{:03X}", can.heartbeat_in_id);
    }
    if (can.look_ahead_samples != 0) {
        fmt::print(report.words, ", look-ahead path 0x{:03X}", can.look_ahead_id);
    }
    if (can.hashes_in_id != 0) {
        fmt::print(report.words, ", hashes 0x{:03X}", can.hashes_in_id);
    }
    if (has_sample_counter(can)) {
        fmt::print(report.words, ", session 0x{:03X}, operator 0x{:03X}", can.session_in_id,
                   can.operator_in_id);
    }
    fmt::print(report.words, "\n  from the guard:");
    if (has_sample_counter(can)) {
        fmt::print(report.words, " permit 0x{:03X} and 0x{:03X},", can.permit_id,
                   can.permit_id + 1);
    }
    fmt::print(report.words, " stop 0x{:03X}, emergency 0x{:03X}, heartbeat 0x{:03X}", can.stop_id,
               can.emergency_id, can.heartbeat_out_id);
    if (can.hashes_out_id != 0) {
        fmt::print(report.words, ", hashes 0x{:03X}", can.hashes_out_id);
    }
    if (has_sample_counter(can)) {
        fmt::print(report.words, ", status 0x{:03X}, hints 0x{:03X}", can.operator_out_id,
                   can.hints_id);
    }
    for (const std::uint32_t id : can.quick_stop_ids) {
        fmt::print(report.words, ", quick stop 0x{:03X}", id);
    }
    fmt::print(report.words, "\n");
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
            return fmt::format("true if {}", signal.mark);
        case SignalRole::counter:
            return fmt::format("counts 0 to {}", signal.mark - 1);
        case SignalRole::drive_status:
            return signal.mark == 0 ? "always homed"
                                    : fmt::format("homed where 0x{:04X} is set", signal.mark);
    }
    return "";
}

/// As candump writes them: 3 digits of 11 bits, 8 of 29.
std::string id_text(std::uint32_t id) {
    return is_extended_id(id) ? fmt::format("0x{:08X}", id_number(id))
                              : fmt::format("0x{:03X}", id);
}

/// The values of each multiplexor in whose frames a signal is: ", page 3", ", page 0, 3-5 in 2".
std::string page_text(const SignalSelector& selector) {
    std::string out;
    std::uint32_t range = 0;
    for (std::uint32_t level = 0; level < selector.level_count; ++level) {
        std::string values;
        for (std::uint32_t i = 0; i < selector.levels[level].range_count; ++i, ++range) {
            const auto [least, most] = selector.ranges[range];
            values += values.empty() ? "" : ", ";
            values += least == most ? fmt::format("{}", least) : fmt::format("{}-{}", least, most);
        }
        out = out.empty() ? values : values + " in " + out;
    }
    return out.empty() ? out : ", page " + out;
}

void print(const CheckReport& report, const CanSignal& signal, std::uint8_t frame_bytes) {
    const Machine& machine = report.loaded.machine;
    const std::string page = page_text(signal.selector);
    fmt::print(
        report.words, "  {:<14} {}, {:>2} bytes{}  {:>3}|{:<2} {} {}{}  {}\n",
        (has_axis(signal.role) ? machine.axes[signal.axis].name + " " : "") + to_text(signal.role),
        id_text(signal.id), frame_bytes, page, signal.start_bit, signal.length_bits,
        signal.order == ByteOrder::little ? "little" : "big",
        signal.type != SignalType::integer ? ""
        : signal.is_signed                 ? "signed "
                                           : "unsigned ",
        to_text(signal.type), meaning_of(machine, signal));
}

}  // namespace

const char* to_text(SignalType type) {
    return word_of(kTypes, type);
}

const char* to_text(SignalRole role) {
    return word_of(kRoles, role);
}

bool is_number(SignalRole role) noexcept {
    return role == SignalRole::position || role == SignalRole::velocity;
}

bool has_axis(SignalRole role) noexcept {
    return is_number(role) || role == SignalRole::drive_status;
}

void report_frames(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    const CanLayout& can = machine.can;
    const AxisFrameSet set = make_frame_set(machine);
    fmt::print(
        report.words, "\nframes: {}, {} a sample of {} us{}\n", wire_of(can).name, set.frame_count,
        can.sample_us,
        wire_of(can).mark != SampleMark::sync ? ""
        : can.sync_counter_max == 0
            ? fmt::format(", within {} us after SYNC 0x{:03X}", can.sync_window_us, can.sync_id)
            : fmt::format(", within {} us after SYNC 0x{:03X}{} that counts 1 to {}",
                          can.sync_window_us, can.sync_id,
                          can.guard_sends_sync ? " of the guard" : "", can.sync_counter_max));
    if (const std::string_view unproven = unmeasured_period(can); !unproven.empty()) {
        fmt::print(report.words, "  not measured: {}\n", unproven);
    }
    if (set.signal_count == 0) {
        print_native(report, set);
        print_ids(report);
        return;
    }
    bool says_tool = false;
    for (std::uint32_t i = 0; i < set.signal_count; ++i) {
        const std::uint8_t frame_bytes = set.frame_bytes[set.signal_slots[i]];
        print(report, set.signals[i], frame_bytes);
        says_tool |= set.signals[i].role == SignalRole::tool;
    }
    print_ids(report);
    if (!says_tool && machine.tools.size() > 1) {
        report.warnings.push_back(
            fmt::format("no frame names the tool in the spindle (found {} tools). The guard always "
                        "checks tool {}.",
                        machine.tools.size(), machine.first_tool));
    }
}

}  // namespace axg
