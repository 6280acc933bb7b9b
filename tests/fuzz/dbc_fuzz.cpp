// SPDX-License-Identifier: Apache-2.0
// Any text as a DBC file: faults or messages, never both; every signal that may be used lies inside
// its frame, so that no frame can make the receiver read beside it.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "config/can/dbc_signal.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/protocol/wire.hpp"
#include "tests/fuzz/targets.hpp"

namespace {

void check_signal(const axg::DbcMessage& message, const axg::DbcSignal& signal) {
    axg::CanSignal wire;
    if (!axg::to_can_signal(message, signal, wire).empty()) {
        return;
    }
    // The receiver has a place for every signal that the reader accepts.
    axg::Machine machine;
    machine.axes.resize(1);
    machine.can.format = axg::CanFormat::signals;
    machine.can.signals = {wire};
    if (axg::make_frame_set(machine).axis_count != 1) {
        std::abort();
    }
    axg::CanFrame frame;
    const double value = axg::detail::value_of(wire, axg::detail::get_signal(wire, &frame.data[0]));
    if (!std::isfinite(value)) {
        std::abort();  // a frame of zeros is a number in every signal
    }
    axg::detail::put_selector(wire.selector, &frame.data[0]);
    if (!axg::detail::selects(wire.selector, &frame.data[0])) {
        std::abort();  // a board can send the signal
    }
}

}  // namespace

int axg::fuzz::dbc(const std::uint8_t* data, std::size_t size) {
    axg::Dbc dbc;
    const auto faults =
        axg::parse_dbc({reinterpret_cast<const char*>(data), size}, "fuzz.dbc", dbc);
    if (!faults.empty() && !dbc.messages.empty()) {
        std::abort();
    }
    for (const axg::ConfigFault& fault : faults) {
        for (const char c : to_string(fault)) {
            if (static_cast<unsigned char>(c) < 0x20) {
                std::abort();  // a fault would write control characters to the terminal
            }
        }
    }
    for (const axg::DbcMessage& message : dbc.messages) {
        for (const axg::DbcSignal& signal : message.signals) {
            check_signal(message, signal);
        }
    }
    return 0;
}
