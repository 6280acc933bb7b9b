// SPDX-License-Identifier: Apache-2.0
// Drives described by an EDS file and by hand, and a machine file that takes its axes from them.
#pragma once

#include <string>

#include "tests/support/machine_text.hpp"

namespace axg::test {

/// TPDO1 holds the status word and, beyond its count, a position that is not active; TPDO2 is
/// switched off; TPDO3 is the one with the position; TPDO4 is sent by event.
inline constexpr const char* kDriveEds = R"([DeviceInfo]
VendorName=Nobody; with a comment sign
[DeviceComissioning]
NodeID=5
[1800sub1]
DefaultValue=$NODEID+0x180
[1800sub2]
DefaultValue=1
[1A00sub0]
DefaultValue=3
ParameterValue=2
[1A00sub1]
ParameterValue=0x60410010
[1A00sub2]
DefaultValue=0x60770010
ParameterValue=0x60610008
[1A00sub3]
DefaultValue=0x60640020
[1801sub1]
DefaultValue=0x80000280
[1801sub2]
DefaultValue=1
[1A01sub0]
DefaultValue=1
[1A01sub1]
DefaultValue=0x60640020
[1802sub1]
; the other way round, and in other letters
ParameterValue = 0x380 + $NodeID
[1802sub2]
DefaultValue=0x1
[1a02sub0]
DefaultValue=2
[1A02sub1]
DefaultValue=0x60640020
[1A02SUB2]
DefaultValue=0x606C0020
[1803sub1]
DefaultValue=$NODEID+0x480
[1803sub2]
DefaultValue=255
[1A03sub0]
DefaultValue=1
[1A03sub1]
DefaultValue=0x60410010
)";

/// The small machine with three drives; C takes its mapping from kDriveEds.
inline std::string drive_machine() {
    const std::string text = kSmallMachine;
    return text.substr(0, text.find("  format: classical")) + R"(  format: cia402
  sync_counter: 240
  sync_window_us: 800
  drives:
    X: {node: 3, pdos: [{cob_id: 0x183, map: [0x60410010, 0x60640020]}],
        counts: 65536, per_mm: 5, reversed: true, zero_counts: -1000, absolute: true}
    A: {pdos: [{cob_id: 0x184, map: [0x60640020, 0x606C0020]}, {cob_id: 0x284, map: [0x60410010]}],
        counts: 4194304, per_deg: 360, homed_bit: 8, velocity: {counts: 1000, per_deg_s: 6}}
    C: {node: 5, file: drive.dcf, counts: 1048576, per_deg: 360, absolute: true}
)" + text.substr(text.find("capacities"));
}

/// The paper's machine with a drive for each axis; each may report its speed. No jog: drives cannot
/// say which axis may.
inline std::string paper_machine_with_drives(std::string machine, bool has_speeds) {
    const std::size_t jog = machine.find("  single_jog:");
    if (jog != std::string::npos) {
        machine.erase(jog, machine.find('\n', jog) - jog + 1);
    }
    machine.erase(machine.find("\ncan:"));  // the last section
    machine += "\ncan:\n  format: cia402\n  sync_counter: 240\n  drives:\n";
    for (std::size_t i = 0; i < 5; ++i) {
        const std::string node = std::to_string(3 + i), unit = i < 3 ? "mm" : "deg";
        machine += std::string("    ") + "XYZAC"[i] + ": {pdos: [{cob_id: 0x18" + node +
                   ", map: [0x60410010, 0x60640020]}" +
                   (has_speeds ? ", {cob_id: 0x28" + node + ", map: [0x606C0020]}" : "") +
                   "], counts: 10000, per_" + unit + ": 1, absolute: true" +
                   (has_speeds ? ", velocity: {counts: 1000, per_" + unit + "_s: 1}" : "") +
                   (i == 4 ? ", range_counts: 3600000}\n" : "}\n");
    }
    return machine;
}

}  // namespace axg::test
