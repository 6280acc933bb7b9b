// SPDX-License-Identifier: Apache-2.0
// The one form of a message about a wrong input.
#include <gtest/gtest.h>

#include "config/text/fault_text.hpp"

namespace axg {
namespace {

TEST(FaultText, NamesWhatIsWrongThenTheValuesThenTheAction) {
    EXPECT_EQ(fault_text("invalid value", "[9, 3]", "two angles, low then high; swap the two"),
              "invalid value (found [9, 3], expected two angles, low then high). Swap the two.");
    EXPECT_EQ(fault_text("unknown key", "", "one of a, b; did you mean \"a\"?"),
              "unknown key (expected one of a, b). Did you mean \"a\"?");
    EXPECT_EQ(fault_text("missing required key", "", "an integer"),
              "missing required key (expected an integer).");
    EXPECT_EQ(fault_text("3 more faults", "", "; correct the faults above first"),
              "3 more faults. Correct the faults above first.");
    EXPECT_EQ(fault_text("invalid file", "a folder", ""), "invalid file (found a folder).");
}

TEST(FaultText, SemicolonsOfQuotesAndBracketsBeginNoAction) {
    EXPECT_EQ(fault_text("invalid value", "x", "\"a; \\\" b; c\" or {k: 1; l: 2} (a; b)"),
              "invalid value (found x, expected \"a; \\\" b; c\" or {k: 1; l: 2} (a; b)).");
    EXPECT_EQ(fault_text("invalid value", "x", "\"; \"; repeat it"),
              "invalid value (found x, expected \"; \"). Repeat it.");
}

}  // namespace
}  // namespace axg
