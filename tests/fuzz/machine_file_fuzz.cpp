// SPDX-License-Identifier: Apache-2.0
// Any text: the machine file reader ends, within memory, with a machine or with faults, never both.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "config/machine/effective_text.hpp"
#include "config/machine/parse_machine.hpp"
#include "tests/fuzz/targets.hpp"

int axg::fuzz::machine_file(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    axg::Machine machine;
    machine.name = "untouched";
    const auto faults = axg::parse_machine(text, "fuzz.yaml", machine);
    if (!faults.empty() && machine.name != "untouched") {
        std::abort();
    }
    for (const axg::ConfigFault& fault : faults) {
        for (const char c : to_string(fault)) {
            if (static_cast<unsigned char>(c) < 0x20 && c != '\n') {
                std::abort();  // a fault would write control characters to the terminal
            }
        }
    }
    if (faults.empty() &&
        (machine.axes.size() > axg::kAxesMax || machine.bodies.size() > axg::kBodiesMax ||
         machine.pairs.size() > axg::kPairsMax)) {
        std::abort();
    }
    for (const axg::Pair& pair : machine.pairs) {
        if (pair.a >= machine.bodies.size() || pair.b >= machine.bodies.size()) {
            std::abort();
        }
    }
    if (faults.empty() && axg::effective_text(machine).empty()) {
        std::abort();
    }
    return 0;
}
