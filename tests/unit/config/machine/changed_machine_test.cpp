// SPDX-License-Identifier: Apache-2.0
// A machine read with other values is the machine whose file has them: keys replaced, keys added,
// maps merged, and the same faults.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/machine/effective_text.hpp"
#include "config/machine/parse_machine.hpp"
#include "tests/support/machine_text.hpp"

namespace axg::test {
namespace {

/// The effective text of the small machine with changes; faults in its place.
std::string changed(const std::vector<std::string>& changes) {
    Machine machine;
    std::string faults;
    for (const ConfigFault& fault :
         parse_changed_machine({"m", kSmallMachine, {}}, changes, machine)) {
        faults += to_string(fault) + '\n';
    }
    return faults.empty() ? effective_text(machine) : faults;
}

std::string edited(const std::string& from, const std::string& to) {
    Machine machine;
    EXPECT_EQ(faults_of(with(kSmallMachine, from, to)), "");
    EXPECT_TRUE(parse_machine(with(kSmallMachine, from, to), "m", machine).empty());
    return effective_text(machine);
}

TEST(ChangedMachine, IsTheMachineOfTheEditedFile) {
    EXPECT_EQ(changed({}), edited("free_jerk: any", "free_jerk: any"));
    EXPECT_EQ(changed({"guard: {free_jerk: limited}"}),
              edited("free_jerk: any", "free_jerk: limited"));
    EXPECT_EQ(changed({"axes: {X: {speed_mm_min: 5000}}"}),
              edited("speed_mm_min: 10000", "speed_mm_min: 5000"));
    EXPECT_EQ(changed({"cycle: {queries: 64}"}),
              edited("capacities:", "cycle: {queries: 64}\ncapacities:"))
        << "a new section";
}

TEST(ChangedMachine, TakesChangesInTheirOrder) {
    EXPECT_EQ(changed({"axes: {X: {speed_mm_min: 5000}}", "guard: {overrun_mm: 3}",
                       "axes: {X: {speed_mm_min: 6000}}", "guard: {overrun_mm: 2}"}),
              edited("speed_mm_min: 10000", "speed_mm_min: 6000"));
}

TEST(ChangedMachine, HasTheFaultsOfTheEditedFile) {
    EXPECT_NE(changed({"guard: {free_jerk: maybe}"}).find("guard.free_jerk"), std::string::npos);
    EXPECT_NE(changed({"guard: {unknown: 1}"}).find("unknown"), std::string::npos);
    EXPECT_NE(changed({"guard: {"}).find("m:"), std::string::npos) << "no YAML";
}

}  // namespace
}  // namespace axg::test
