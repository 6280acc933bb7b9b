// SPDX-License-Identifier: Apache-2.0
// What a cycle may use of each list, and in which stages it queries: counted the same way on every
// engine, so that the longest cycle is every stage with every list full. Source:
// docs/theory/certificate.md, "Stages and groups".
#pragma once

#include <array>
#include <cstdint>

#include "core/base/host_device.hpp"

namespace axg {

/// Entries of each list. Their order says which of several full lists is reported: the first.
struct WorkLists {
    std::uint32_t node_pairs = 0;  // two nodes below the roots, not both leaves; when listed
    std::uint32_t leaf_pairs = 0;  // by charged_leaves (core/collision/tree.hpp); when listed
    // A child of a against b's children where both nodes are opened, by charged_rows, and a
    // triangle of b against a's where leaves are clipped; before the row is tested.
    std::uint32_t box_rows = 0;
    // Left after clipping, in batches (charged_pairs); before the first of them is tested.
    std::uint32_t triangle_pairs = 0;
    std::uint32_t rechecks = 0;  // before each. A query in float alone has none

    friend constexpr bool operator==(const WorkLists&, const WorkLists&) = default;
};

/// Pairs of triangles are tested as many at a time as an engine has lanes, and a single one costs
/// as much as all. So each pair of leaves is charged whole batches of the widest engine's lanes,
/// whoever tests it: what a share allows costs about the same however it lies in pairs of leaves.
inline constexpr std::uint32_t kTriangleBatch = 16;

/// What a pair of leaves is charged of which so many pairs of triangles are left.
[[nodiscard]] AXG_HD constexpr std::uint32_t charged_pairs(std::uint32_t left) noexcept {
    return (left + kTriangleBatch - 1) / kTriangleBatch * kTriangleBatch;
}

/// Queries that stand or fall together, those of a pair with one tool: if they need more of any
/// list than their share, every one of them is not proven, and no other group notices.
struct GroupWork {
    WorkLists share{};
    WorkLists used{};  // by all calls of a stage; the caller zeroes it where a stage begins
    // Nobody needs the other results once one of them is not far: an engine may leave them out.
    bool needs_all = false;
    bool is_near = false;  // and one is not
};

/// What each of `groups` groups may use of a stage's lists: a matter of their number, never of
/// what another one used. Of triangles whole batches. Precondition: groups > 0.
[[nodiscard]] constexpr WorkLists share_of(const WorkLists& lists, std::uint32_t groups) noexcept {
    return {lists.node_pairs / groups, lists.leaf_pairs / groups, lists.box_rows / groups,
            lists.triangle_pairs / groups / kTriangleBatch * kTriangleBatch,
            lists.rechecks / groups};
}

/// Of the first stage, which may ask twice of each pair: each question is a group of its own, and
/// of what is asked of the longer permit as much may be used again. Where it is the only stage both
/// share.
/// @param groups  of the pairs
[[nodiscard]] constexpr WorkLists first_share_of(const WorkLists& lists, std::uint32_t groups,
                                                 bool is_only, bool asks_twice) noexcept {
    return share_of(lists, is_only && asks_twice ? 2 * groups : groups);
}

/// The known-answer test is a group of its own. Two tetrahedra are two leaves.
inline constexpr WorkLists kKnownAnswerShare{
    .node_pairs = 8, .leaf_pairs = 8, .box_rows = 32, .triangle_pairs = 64, .rechecks = 64};

/// What is asked of one part before the last stage has a share of its own, on top of that stage's.
/// It holds what most parts near contact come to (docs/measurements/gpu-fill.txt).
inline constexpr WorkLists kFirstPartShare{
    .node_pairs = 8, .leaf_pairs = 8, .box_rows = 32, .triangle_pairs = 192, .rechecks = 0};

/// Which boxes of a halving tree are queried.
enum class TreeForm : std::uint8_t {
    whole = 0,  // every box below the root, level by level
    leaves,     // those of the last level alone: one level deeper for the same number of queries
};

inline constexpr std::uint32_t kStagesMax = 3;
inline constexpr std::uint32_t kStageDepthMax = 31;

/// What one cycle may do. It is no part of the argument that a proven box is safe.
struct CyclePlan {
    std::uint32_t stages = 2;  // 1 to kStagesMax
    // Of each stage, on top of the known-answer test's two. The first has room for three queries a
    // pair: the whole box now, and later whether a permit holds longer, and at full speed.
    std::array<std::uint32_t, kStagesMax> queries{};
    std::array<WorkLists, kStagesMax> lists{};
    TreeForm form = TreeForm::leaves;
    std::uint32_t depth_max = kStageDepthMax;  // of all stages together: halvings of a box

    friend constexpr bool operator==(const CyclePlan&, const CyclePlan&) = default;
};

/// How deep trees below `open` boxes may be within a stage's queries; 0: not one level fits.
[[nodiscard]] constexpr std::uint32_t tree_depth(std::uint32_t queries, std::uint32_t open,
                                                 TreeForm form) noexcept {
    std::uint32_t depth = 0;
    for (std::uint32_t next = 1; open != 0 && next <= kStageDepthMax; ++next) {
        const std::uint64_t leaves = std::uint64_t{1} << next;
        if (open * (form == TreeForm::whole ? 2 * leaves - 2 : leaves) > queries) {
            break;
        }
        depth = next;
    }
    return depth;
}

inline constexpr std::uint32_t kQueriesAPair = 3;  // room in the first stage

/// Sixteenths of a list for each stage but the last, which has the rest. The second of three meets
/// the boxes that are near, and they need pairs of leaves and triangles. The last one queries many
/// boxes that are far, and each needs a few rows. Measured: docs/measurements/bounded-cycle.md,
/// "Groups and stages".
inline constexpr std::array<std::uint32_t, kStagesMax - 1> kSixteenthsOfRows{1, 3};  // and nodes
inline constexpr std::array<std::uint32_t, kStagesMax - 1> kSixteenthsOfPairs{1, 12};

/// What stage `stage` of `stages` may use of a cycle's lists: a matter of those numbers alone.
/// Precondition: stage < stages <= kStagesMax.
[[nodiscard]] constexpr WorkLists lists_of_stage(const WorkLists& cycle, std::uint32_t stage,
                                                 std::uint32_t stages) noexcept {
    const auto part = [stage, stages](std::uint32_t list,
                                      const std::array<std::uint32_t, kStagesMax - 1>& of) {
        std::uint32_t left = list;
        for (std::uint32_t i = 0; i + 1 < stages; ++i) {
            const auto here = static_cast<std::uint32_t>(std::uint64_t{list} * of[i] / 16);
            if (i == stage) {
                return here;
            }
            left -= here;
        }
        return left;
    };
    return {part(cycle.node_pairs, kSixteenthsOfRows), part(cycle.leaf_pairs, kSixteenthsOfPairs),
            part(cycle.box_rows, kSixteenthsOfRows), part(cycle.triangle_pairs, kSixteenthsOfPairs),
            part(cycle.rechecks, kSixteenthsOfPairs)};
}

/// Of three stages the second queries so many times fewer boxes. Where all of them stay open, the
/// last stage still gets as deep as it would by itself: both counts are powers of two.
inline constexpr std::uint32_t kLastForSecond = 16;

/// @param queries  of the last stage. A power of two: with leaves alone, one less costs a level
/// Precondition: 1 <= stages <= kStagesMax.
[[nodiscard]] constexpr CyclePlan plan_of(std::uint32_t stages, std::uint32_t pairs,
                                          std::uint32_t queries, const WorkLists& lists) noexcept {
    CyclePlan plan;
    plan.stages = stages;
    for (std::uint32_t stage = 0; stage < stages; ++stage) {
        plan.queries[stage] = stage + 1 == stages ? queries : queries / kLastForSecond;
        plan.lists[stage] = lists_of_stage(lists, stage, stages);
    }
    plan.queries[0] = kQueriesAPair * pairs;
    return plan;
}

/// Queries and lists of all stages together.
[[nodiscard]] constexpr std::uint32_t queries_of(const CyclePlan& plan) noexcept {
    return plan.queries[0] + plan.queries[1] + plan.queries[2];
}
[[nodiscard]] constexpr WorkLists lists_of(const CyclePlan& plan) noexcept {
    WorkLists sum;
    for (const WorkLists& stage : plan.lists) {
        sum.node_pairs += stage.node_pairs;
        sum.leaf_pairs += stage.leaf_pairs;
        sum.box_rows += stage.box_rows;
        sum.triangle_pairs += stage.triangle_pairs;
        sum.rechecks += stage.rechecks;
    }
    return sum;
}

/// What the snapshot where a jog begins may use, which is proven nothing of: no more than a cycle
/// of the plan's stages. Of three the last has most of the rows, which whole boxes need, and the
/// second most of the pairs of leaves and triangles, which queries about a near pair need.
struct JogLists {
    WorkLists margins;  // a query a pair
    WorkLists rungs;    // all rungs of the pairs that have less than their margin
};
[[nodiscard]] constexpr JogLists jog_lists(const CyclePlan& plan) noexcept {
    if (plan.stages == 1) {
        const WorkLists half = share_of(plan.lists[0], 2);
        return {half, half};
    }
    return {plan.lists[plan.stages == 2 ? 0 : 2], plan.lists[1]};
}

/// What a machine file says of a cycle's plan (core/machine/cycle_plan.hpp).
struct CycleRules {
    bool is_pinned = false;  // else whoever starts the guard may choose another
    // What proves most of the example programs for its work (docs/measurements/bounded-cycle.md).
    std::uint32_t stages = 3;
    std::uint32_t queries = 512;  // of the last stage
    std::uint32_t depth_max = kStageDepthMax;
    // What box queries decide in double never decided a sample.
    WorkLists lists{.node_pairs = 192,
                    .leaf_pairs = 240,
                    .box_rows = 3072,
                    .triangle_pairs = 1024,
                    .rechecks = 0};

    friend constexpr bool operator==(const CycleRules&, const CycleRules&) = default;
};

}  // namespace axg
