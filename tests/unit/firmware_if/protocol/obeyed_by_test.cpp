// SPDX-License-Identifier: Apache-2.0
// Who ends the motion of a machine: the board alone, and only where SYNC counts 1 to 240. Goal:
// each other row is refused in words that name what is missing.
#include "firmware_if/protocol/obeyed_by.hpp"

#include <gtest/gtest.h>

#include "tests/support/can_board.hpp"

namespace axg {
namespace {

using test::five_axis_machine;

bool says(const std::string& text, const char* words) {
    return text.find(words) != std::string::npos;
}

TEST(ObeyedBy, ABoardObeysWhereSyncCountsTo240) {
    EXPECT_EQ(obeyed_by_refusal(five_axis_machine(CanFormat::classical)), "");
    EXPECT_EQ(obeyed_by_refusal(five_axis_machine(CanFormat::fd)), "");
    Machine drives = five_axis_machine(CanFormat::cia402);
    drives.can.sync_counter_max = 240;
    EXPECT_EQ(obeyed_by_refusal(drives), "");
}

// Without the counter a permit of long ago reads like one of now; with a short one it does after a
// few samples.
TEST(ObeyedBy, DrivesWithoutTheWholeCounterAreRefused) {
    Machine drives = five_axis_machine(CanFormat::cia402);
    for (const int counts_to : {0, 2, 100, 239}) {
        drives.can.sync_counter_max = static_cast<std::uint8_t>(counts_to);
        EXPECT_FALSE(has_sample_counter(drives.can));
        const std::string refusal = obeyed_by_refusal(drives);
        EXPECT_TRUE(refusal.starts_with("no board can obey these permits: ")) << refusal;
        const std::string found =
            "(found can.sync_counter: " + std::to_string(counts_to) + ", expected 240)";
        EXPECT_TRUE(says(refusal, found.c_str())) << refusal;
        EXPECT_TRUE(says(refusal, "can.sync: guard")) << refusal;
    }
}

TEST(ObeyedBy, SignalsAreRefusedForTheyAreReadWithoutSync) {
    const Machine signals = five_axis_machine(CanFormat::signals);
    EXPECT_FALSE(has_sample_counter(signals.can)) << "whatever the layout says of a counter";
    const std::string refusal = obeyed_by_refusal(signals);
    EXPECT_TRUE(refusal.starts_with("no board can obey these permits: ")) << refusal;
    EXPECT_TRUE(says(refusal, "expected a SYNC counter 1 to 240")) << refusal;
}

// A counter does not help them: their times are in no certificate.
TEST(ObeyedBy, LineAndDrivesAreNotBuiltAndSayWhatIsMissing) {
    Machine machine = five_axis_machine(CanFormat::classical);
    machine.guard.obeyed_by = ObeyedBy::line;
    EXPECT_TRUE(obeyed_by_refusal(machine).starts_with("no line can obey these permits: "));
    EXPECT_TRUE(says(obeyed_by_refusal(machine), "line_lambda_ms"));
    machine.guard.obeyed_by = ObeyedBy::drives;
    EXPECT_TRUE(obeyed_by_refusal(machine).starts_with("no drive can obey these permits: "));
    EXPECT_TRUE(says(obeyed_by_refusal(machine), "0x1016"));
}

}  // namespace
}  // namespace axg
