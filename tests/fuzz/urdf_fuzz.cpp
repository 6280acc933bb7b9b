// SPDX-License-Identifier: Apache-2.0
// Any text as a URDF file, every mesh of which exists: faults, or a tree of bodies, parents first,
// whose numbers are finite.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "config/init/urdf.hpp"
#include "core/base/limits.hpp"
#include "tests/fuzz/targets.hpp"

int axg::fuzz::urdf(const std::uint8_t* data, std::size_t size) {
    const axg::UrdfMachine machine =
        axg::read_urdf({reinterpret_cast<const char*>(data), size}, "fuzz.urdf",
                       [](const std::string&) { return true; });
    for (const axg::ConfigFault& fault : machine.faults) {
        for (const char c : to_string(fault)) {
            if (static_cast<unsigned char>(c) < 0x20) {
                std::abort();  // a fault would write control characters to the terminal
            }
        }
    }
    if (!machine.faults.empty()) {
        return 0;
    }
    if (machine.roles.size() < 2 || machine.roles.size() > axg::kBodiesMax) {
        std::abort();
    }
    for (std::size_t i = 0; i < machine.roles.size(); ++i) {
        const axg::RoleGuess& role = machine.roles[i];
        const axg::Vec3d sum = role.at_mm + role.rotate_deg + role.direction + role.pivot_mm;
        if ((role.parent != axg::kNoParent && role.parent >= i) ||
            (role.file != axg::kNoFile && role.file >= machine.meshes.size()) ||
            !std::isfinite(sum.x + sum.y + sum.z)) {
            std::abort();
        }
    }
    return 0;
}
