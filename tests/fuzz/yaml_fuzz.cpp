// SPDX-License-Identifier: Apache-2.0
// Any bytes as a machine file: faults or a machine whose indices hold. Nothing is opened but the
// text itself.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "config/effective_text.hpp"
#include "config/parse_machine.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    axg::Machine machine;
    const std::string text(reinterpret_cast<const char*>(data), size);
    const auto faults = axg::parse_machine(text, "fuzz", machine);
    for (const axg::ConfigFault& fault : faults) {
        if (axg::to_string(fault).find('\x1b') != std::string::npos) {
            std::abort();  // a fault may not carry a terminal escape
        }
    }
    if (!faults.empty()) {
        return 0;
    }
    for (const axg::Pair& pair : machine.pairs) {
        if (pair.a >= machine.bodies.size() || pair.b >= machine.bodies.size()) {
            std::abort();
        }
    }
    if (machine.axes.empty() || machine.bodies.empty() || axg::effective_text(machine).empty()) {
        std::abort();
    }
    return 0;
}
