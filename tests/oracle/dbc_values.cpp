// SPDX-License-Identifier: Apache-2.0
// What our reader makes of frames, for comparison with another one: dbc_values FILE.dbc, then lines
// "ID HEXBYTES" on stdin, the id as the file writes it. Prints "frame ID" and "NAME VALUE" (a
// hexadecimal float) for each signal that the frame carries and that can be used.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include "config/can/dbc_signal.hpp"
#include "core/machine/can_id.hpp"
#include "firmware_if/can/can_frame.hpp"
#include "firmware_if/protocol/wire.hpp"

namespace {

void print_frame(const axg::Dbc& dbc, std::uint32_t id, const axg::CanFrame& frame) {
    std::printf("frame %u\n", id);
    for (const axg::DbcMessage& message : dbc.messages) {
        for (const axg::DbcSignal& signal : message.signals) {
            axg::CanSignal wire;
            if (axg::wire_id(message.id, message.is_extended) != id ||
                !axg::to_can_signal(message, signal, wire).empty()) {
                continue;
            }
            if (axg::detail::selects(wire.selector, frame.data.data())) {
                const std::int64_t raw = axg::detail::get_signal(wire, frame.data.data());
                std::printf("%s %a\n", signal.name.c_str(), axg::detail::value_of(wire, raw));
            }
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: dbc_values FILE.dbc < FRAMES\n");
        return 2;
    }
    std::ifstream file(argv[1], std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    axg::Dbc dbc;
    for (const axg::ConfigFault& fault : axg::parse_dbc(text, argv[1], dbc)) {
        std::fprintf(stderr, "%s\n", to_string(fault).c_str());
        return 3;
    }
    std::uint32_t id = 0;
    std::string hex;
    while (std::cin >> id >> hex) {
        axg::CanFrame frame;
        for (std::size_t i = 0; 2 * i + 1 < hex.size() && i < frame.data.size(); ++i) {
            frame.data[i] =
                static_cast<std::uint8_t>(std::stoul(hex.substr(2 * i, 2), nullptr, 16));
        }
        print_frame(dbc, id, frame);
    }
    return 0;
}
