// SPDX-License-Identifier: Apache-2.0
// Losses of a group in the order of the steps, and what is told of a group that is lost.
#include "core/collision/group_work.hpp"

#include <gtest/gtest.h>

namespace axg {
namespace {

TEST(GroupSums, LossesComeInTheOrderOfTheSteps) {
    EXPECT_LT(loss_of_rows(0), loss_of_nodes(0));
    EXPECT_LT(loss_of_nodes(0), loss_of_leaves(0));
    EXPECT_LT(loss_of_leaves(0), loss_of_rows(1));
    EXPECT_LT(loss_of_leaves(kLevelsOfLoss - 1), kLossOfClipping);
    EXPECT_LT(kLossOfClipping, kLossOfTriangles);
    EXPECT_LT(kLossOfTriangles, kLossOfRechecks);
    EXPECT_LT(kLossOfRechecks, kNotLost);
}

TEST(GroupSums, ALossNamesItsList) {
    for (const std::uint32_t level : {0U, 1U, kLevelsOfLoss - 1}) {
        EXPECT_EQ(status_of_loss(loss_of_rows(level)), QueryStatus::too_many_box_rows);
        EXPECT_EQ(status_of_loss(loss_of_nodes(level)), QueryStatus::too_many_node_pairs);
        EXPECT_EQ(status_of_loss(loss_of_leaves(level)), QueryStatus::too_many_leaf_pairs);
    }
    EXPECT_EQ(status_of_loss(kLossOfClipping), QueryStatus::too_many_box_rows);
    EXPECT_EQ(status_of_loss(kLossOfTriangles), QueryStatus::too_many_triangle_pairs);
    EXPECT_EQ(status_of_loss(kLossOfRechecks), QueryStatus::too_many_rechecks);
}

TEST(GroupSums, WhatIsTakenBackIsWhatWasUsedOrTheWholeShareAndTheListThatWasFull) {
    GroupWork group{.share = {10, 20, 30, 40, 50}, .used = {1, 2, 3, 4, 5}};
    GroupSums sums = sums_of(group, 7);
    EXPECT_EQ(sums.sequence, 7U);
    EXPECT_EQ(sums.lost, kNotLost);
    for (std::uint32_t i = 0; i < kWorkListCount; ++i) {
        EXPECT_EQ(sums.share[i], 10 * (i + 1));
        EXPECT_EQ(sums.used[i]++, i + 1);
    }
    take_sums(sums.used, kNotLost, group);
    EXPECT_EQ(group.used, (WorkLists{2, 3, 4, 5, 6}));
    EXPECT_EQ(first_full(group), QueryStatus::ok);
    for (const std::uint32_t loss : {loss_of_rows(1), loss_of_nodes(0), loss_of_leaves(2),
                                     kLossOfTriangles, kLossOfRechecks}) {
        take_sums(sums.used, loss, group);
        EXPECT_EQ(first_full(group), status_of_loss(loss));
        EXPECT_EQ(group.share, (WorkLists{10, 20, 30, 40, 50}));
    }
}

}  // namespace
}  // namespace axg
