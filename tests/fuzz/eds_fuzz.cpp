// SPDX-License-Identifier: Apache-2.0
// Any text as an EDS or DCF file: faults or PDOs, never both, and no more mapped objects than a
// mapping has.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "config/can/eds.hpp"
#include "tests/fuzz/targets.hpp"

int axg::fuzz::eds(const std::uint8_t* data, std::size_t size) {
    axg::Eds eds;
    const auto faults = axg::parse_eds({reinterpret_cast<const char*>(data), size}, "fuzz.eds",
                                       size == 0 ? 1U : 1U + data[0] % 127U, eds);
    if (!faults.empty() && (!eds.pdos.empty() || eds.node)) {
        std::abort();
    }
    for (const axg::ConfigFault& fault : faults) {
        for (const char c : to_string(fault)) {
            if (static_cast<unsigned char>(c) < 0x20) {
                std::abort();  // a fault would write control characters to the terminal
            }
        }
    }
    for (const axg::EdsPdo& pdo : eds.pdos) {
        if (pdo.number < 1 || pdo.number > 512 || pdo.map.size() > 64 || pdo.line < 1) {
            std::abort();
        }
    }
    return 0;
}
