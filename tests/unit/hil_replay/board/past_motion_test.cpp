// SPDX-License-Identifier: Apache-2.0
// Where an axis was, between two notes and before the first one: against the motion itself.
#include "hil_replay/board/past_motion.hpp"

#include <gtest/gtest.h>

namespace axg {
namespace {

TEST(PastMotion, IsTheMotionOfConstantJerk) {
    const AxisMotion begin{.position = 3, .speed = -200, .acceleration = 4000, .jerk = -50'000};
    PastMotion past(3000);
    for (std::int64_t at = 0; at <= 6000; at += kPastPartUs) {
        AxisMotions axes{};
        axes[1] = moved_on(begin, static_cast<double>(at) * 1e-6);
        past.note(1'000'000 + at, axes);
    }
    for (std::int64_t at = 3000; at <= 6000; at += 37) {
        EXPECT_NEAR(past.position(1'000'000 + at, 1),
                    moved_on(begin, static_cast<double>(at) * 1e-6).position, 1e-12)
            << at;
    }
    EXPECT_EQ(past.position(1'006'000, 1), moved_on(begin, 6e-3).position);
}

TEST(PastMotion, BeforeTheFirstNoteNothingMoved) {
    PastMotion past(3000);
    AxisMotions axes{};
    axes[0] = {.position = 5, .speed = 100};
    past.note(1000, axes);
    EXPECT_EQ(past.position(500, 0), 5);
    axes[0].position = 5.1;
    past.note(2000, axes);
    EXPECT_EQ(past.position(500, 0), 5);
    EXPECT_NEAR(past.position(1500, 0), 5.05, 1e-12);
}

}  // namespace
}  // namespace axg
