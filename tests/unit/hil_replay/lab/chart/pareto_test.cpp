// SPDX-License-Identifier: Apache-2.0
// Which marks of a picture nothing beats.
#include <gtest/gtest.h>
#ifdef AXG_EXACT  // the chart is built with the exact judge alone
#include "hil_replay/lab/chart/scatter_picture.hpp"

namespace axg::chart {
namespace {

TEST(Pareto, HoldsWhatNothingBeatsFromLeftToRight) {
    const std::vector<ScatterMark> marks = {{.x = 5, .y = 1},  // slow and good
                                            {.x = 1, .y = 9},  // fast and bad
                                            {.x = 4, .y = 9},  // beaten by the second
                                            {.x = 2, .y = 4},
                                            {.x = 2, .y = 5}};  // beaten at the same time
    EXPECT_EQ(pareto_of(marks), (std::vector<std::size_t>{1, 3, 0}));
}

TEST(Pareto, LeavesPredictionsOut) {
    const std::vector<ScatterMark> marks = {{.x = 1, .y = 1, .style = MarkStyle::predicted},
                                            {.x = 2, .y = 2}};
    EXPECT_EQ(pareto_of(marks), std::vector<std::size_t>{1});
}

}  // namespace
}  // namespace axg::chart
#endif
