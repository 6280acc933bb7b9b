// SPDX-License-Identifier: Apache-2.0
// Work of a group on an engine that opens all pairs of a tree level together. The engine charges
// the same work as the CPU, with the same functions (charged_rows, charged_leaves, charged_pairs).
// A group's demand is a sum over its own entries, so no order of threads changes it. After a list
// is full, entries are missing, and which ones depends on that order. So the first step that
// overflowed identifies a loss: every sum is complete up to there. Source:
// docs/theory/certificate.md, "Stages and groups".
#pragma once

#include <cstdint>

#include "core/base/host_device.hpp"
#include "core/base/limits.hpp"
#include "core/collision/engine.hpp"

namespace axg {

/// The lists of WorkLists as places of an array.
enum WorkListPlace : std::uint32_t {
    kNodePairsPlace = 0,
    kLeafPairsPlace,
    kBoxRowsPlace,
    kTrianglePairsPlace,
    kRechecksPlace,
    kWorkListCount
};

/// Share, use and loss of a group in a batch. Zeroed memory has room for nothing.
struct alignas(16) GroupSums {
    std::uint32_t sequence;  // of the batch it was filled for
    std::uint32_t lost;      // the first loss, or kNotLost
    std::uint32_t share[kWorkListCount], used[kWorkListCount];
};
static_assert(sizeof(GroupSums) == 48);

/// Losses in the order of the steps. In each tree level the rows are first: the engine counts them
/// for every pair that it opens there, but finds pairs only in rows that it tested.
inline constexpr std::uint32_t kNotLost = 0xffffffffU;
inline constexpr std::uint32_t kLossesOfALevel = 3;
inline constexpr std::uint32_t kLevelsOfLoss = kTreeDepthMax + 1;
[[nodiscard]] AXG_HD constexpr std::uint32_t loss_of_rows(std::uint32_t level) noexcept {
    return kLossesOfALevel * level;
}
[[nodiscard]] AXG_HD constexpr std::uint32_t loss_of_nodes(std::uint32_t level) noexcept {
    return kLossesOfALevel * level + 1;
}
[[nodiscard]] AXG_HD constexpr std::uint32_t loss_of_leaves(std::uint32_t level) noexcept {
    return kLossesOfALevel * level + 2;
}
inline constexpr std::uint32_t kLossOfClipping = kLossesOfALevel * kLevelsOfLoss;
inline constexpr std::uint32_t kLossOfTriangles = kLossOfClipping + 1;
inline constexpr std::uint32_t kLossOfRechecks = kLossOfClipping + 2;

/// The list that a loss is about. Precondition: not kNotLost.
[[nodiscard]] AXG_HD constexpr WorkListPlace list_of_loss(std::uint32_t loss) noexcept {
    if (loss >= kLossOfClipping) {
        return loss == kLossOfClipping    ? kBoxRowsPlace
               : loss == kLossOfTriangles ? kTrianglePairsPlace
                                          : kRechecksPlace;
    }
    const std::uint32_t step = loss % kLossesOfALevel;
    return step == 0 ? kBoxRowsPlace : step == 1 ? kNodePairsPlace : kLeafPairsPlace;
}

[[nodiscard]] AXG_HD constexpr QueryStatus status_of_loss(std::uint32_t loss) noexcept {
    switch (list_of_loss(loss)) {
        case kNodePairsPlace:
            return QueryStatus::too_many_node_pairs;
        case kLeafPairsPlace:
            return QueryStatus::too_many_leaf_pairs;
        case kBoxRowsPlace:
            return QueryStatus::too_many_box_rows;
        case kTrianglePairsPlace:
            return QueryStatus::too_many_triangle_pairs;
        default:
            return QueryStatus::too_many_rechecks;
    }
}

/// The sums of a group at the start of a batch.
[[nodiscard]] constexpr GroupSums sums_of(const GroupWork& group, std::uint32_t sequence) noexcept {
    const WorkLists &share = group.share, &used = group.used;
    return {
        sequence,
        kNotLost,
        {share.node_pairs, share.leaf_pairs, share.box_rows, share.triangle_pairs, share.rechecks},
        {used.node_pairs, used.leaf_pairs, used.box_rows, used.triangle_pairs, used.rechecks}};
}

/// Stores the work of the batch in its group. A lost group has used its whole share of each list,
/// and more of the first full list: its true work is unknown.
constexpr void take_sums(const std::uint32_t (&used)[kWorkListCount], std::uint32_t lost,
                         GroupWork& group) noexcept {
    constexpr std::uint32_t WorkLists::*kLists[kWorkListCount] = {
        &WorkLists::node_pairs, &WorkLists::leaf_pairs, &WorkLists::box_rows,
        &WorkLists::triangle_pairs, &WorkLists::rechecks};
    for (std::uint32_t i = 0; i < kWorkListCount; ++i) {
        const std::uint32_t share = group.share.*kLists[i];
        const bool is_full = lost != kNotLost && list_of_loss(lost) == i;
        group.used.*kLists[i] = lost == kNotLost ? used[i] : share + (is_full ? 1U : 0U);
    }
}

}  // namespace axg
