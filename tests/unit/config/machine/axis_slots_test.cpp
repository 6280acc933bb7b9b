// SPDX-License-Identifier: Apache-2.0
// The place of an axis on the bus is what `slot` states, whatever the order of the keys; without it
// the order of the keys counts, and another order is another configuration.
#include <gtest/gtest.h>

#include "config/machine/effective_text.hpp"
#include "config/machine/parse_machine.hpp"
#include "config/mesh/load_meshes.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

const std::string kX =
    "  X: {kind: linear, travel_mm: [-300, 300], speed_mm_min: 10000, acceleration_mm_s2: 2000,\n"
    "      jerk_mm_s3: 50000, stopping_mm_s2: 1500, position_error_mm: 0.001, "
    "following_error_mm: 0}\n";
const std::string kA =
    "  A: {kind: rotary, travel_deg: [-110, 30], speed_deg_s: 90, acceleration_deg_s2: 500,\n"
    "      jerk_deg_s3: 10000, stopping_deg_s2: 400}\n";

std::string slotted(std::string axis, int slot) {
    return axis.insert(axis.find('{') + 1, "slot: " + std::to_string(slot) + ", ");
}

/// The small machine with these in place of X and A, and a slot for C.
std::string machine_of(const std::string& two_axes, const std::string& slot_of_c) {
    const std::string text = with(kSmallMachine, kX + kA, two_axes);
    return with(text, "C: {kind", "C: {" + slot_of_c + "kind");
}

Machine parsed(const std::string& text) {
    Machine machine;
    const auto faults = parse_machine(text, "m", machine);
    EXPECT_TRUE(faults.empty()) << to_string(faults[0]);
    return machine;
}

TEST(AxisSlots, AreTheOrderWhateverTheOrderOfTheKeys) {
    const std::string plain = effective_text(parsed(kSmallMachine));
    const std::string same = machine_of(slotted(kX, 0) + slotted(kA, 1), "slot: 2, ");
    const std::string swapped = machine_of(slotted(kA, 1) + slotted(kX, 0), "slot: 2, ");
    EXPECT_EQ(effective_text(parsed(same)), plain);
    EXPECT_EQ(effective_text(parsed(swapped)), plain);
    const Machine other = parsed(machine_of(slotted(kX, 2) + slotted(kA, 1), "slot: 0, "));
    EXPECT_EQ(other.axes[0].name + other.axes[1].name + other.axes[2].name, "CAX");
    EXPECT_EQ(other.bodies[1].joint.axis, 2U) << "the slide follows X, wherever X is";
}

TEST(AxisSlots, WithoutThemAnotherOrderIsAnotherConfiguration) {
    const Machine before = parsed(kSmallMachine);
    const Machine after = parsed(machine_of(kA + kX, ""));
    MachineMeshes none;
    none.bodies.resize(before.bodies.size());
    EXPECT_NE(configuration_hash(before, none), configuration_hash(after, none));
    EXPECT_NE(configuration_hashes(before, none).of[3], configuration_hashes(after, none).of[3]);
}

TEST(AxisSlots, AreForAllAxesOrNone) {
    EXPECT_EQ(faults_of(machine_of(slotted(kX, 0) + kA, "slot: 2, ")),
              "m:6: axes.A.slot: invalid value (found no slot, and other axes with one, expected "
              "each of 0 to 2 once, one for each axis, or no slot at all).\n");
    EXPECT_EQ(faults_of(machine_of(slotted(kX, 0) + slotted(kA, 0), "slot: 2, ")),
              "m:6: axes.A.slot: invalid value (found 0, the slot of axis X, expected each of 0 to "
              "2 once, one for each axis, or no slot at all).\n");
    EXPECT_EQ(faults_of(machine_of(slotted(kX, 0) + slotted(kA, 1), "slot: 3, ")),
              "m:8: axes.C.slot: invalid value (found 3, expected each of 0 to 2 once, one for "
              "each axis, or no slot at all).\n");
    EXPECT_NE(faults_of(machine_of(slotted(kX, 0) + slotted(kA, 1), "slot: 16, ")), "");
}

}  // namespace
}  // namespace axg::test
