// SPDX-License-Identifier: Apache-2.0
// Limits of a cycle: the entries of each list, and the stages of its queries. Every engine counts
// them the same way, so the longest cycle is every stage with every list full. Source:
// docs/theory/certificate.md, "Stages and groups".
#pragma once

#include <array>
#include <cstdint>

#include "core/base/host_device.hpp"

namespace axg {

/// Entries of each list. If several lists are full, the first in this order is reported.
struct WorkLists {
    std::uint32_t node_pairs = 0;  // two nodes below the roots, not both leaves; when listed
    std::uint32_t leaf_pairs = 0;  // by charged_leaves (core/collision/tree.hpp); when listed
    // A child of a against b's children if both nodes are opened, by charged_rows, and a triangle
    // of b against a's when leaves are clipped; before the row is tested.
    std::uint32_t box_rows = 0;
    // Left after clipping, in batches (charged_pairs); before the first of them is tested.
    std::uint32_t triangle_pairs = 0;
    std::uint32_t rechecks = 0;  // before each. A query in float only has none

    friend constexpr bool operator==(const WorkLists&, const WorkLists&) = default;
};

/// A list by the name that files and reports use.
struct WorkListName {
    const char* name;
    std::uint32_t WorkLists::*list;
};
/// All of them, in the order of WorkLists.
inline constexpr std::array<WorkListName, 5> kWorkLists{
    {{"node_pairs", &WorkLists::node_pairs},
     {"leaf_pairs", &WorkLists::leaf_pairs},
     {"box_rows", &WorkLists::box_rows},
     {"triangle_pairs", &WorkLists::triangle_pairs},
     {"rechecks", &WorkLists::rechecks}}};

/// `of` each list of both.
template <class Of>
[[nodiscard]] constexpr WorkLists of_each(const WorkLists& a, const WorkLists& b, Of of) noexcept {
    WorkLists out;
    for (const WorkListName& one : kWorkLists) {
        out.*one.list = of(a.*one.list, b.*one.list);
    }
    return out;
}
[[nodiscard]] constexpr WorkLists operator+(const WorkLists& a, const WorkLists& b) noexcept {
    return of_each(a, b, [](std::uint32_t x, std::uint32_t y) { return x + y; });
}

/// An engine tests as many pairs of triangles at a time as it has lanes, and a single one costs as
/// much as all. So every engine charges a pair of leaves whole batches of the widest engine's
/// lanes: a full share costs about the same, however its entries are spread over pairs of leaves.
inline constexpr std::uint32_t kTriangleBatch = 16;

/// The charge for a pair of leaves with `left` pairs of triangles after clipping.
[[nodiscard]] AXG_HD constexpr std::uint32_t charged_pairs(std::uint32_t left) noexcept {
    return (left + kTriangleBatch - 1) / kTriangleBatch * kTriangleBatch;
}

/// Work of a group, the queries of a pair with one tool. If they need more of any list than their
/// share, none of them is proven; other groups are not affected.
struct GroupWork {
    WorkLists share{};
    WorkLists used{};  // by all calls of a stage; the caller zeroes it when a stage begins
    // The caller needs every result to be far: after one that is not, an engine may skip the rest.
    bool needs_all = false;
    bool is_near = false;  // needs_all, and one result is not far
};

/// The share of each of `groups` groups in a stage's lists. It depends on their number, never on
/// the work of another group. Triangle pairs: whole batches. Precondition: groups > 0.
[[nodiscard]] constexpr WorkLists share_of(const WorkLists& lists, std::uint32_t groups) noexcept {
    WorkLists share;
    for (const WorkListName& one : kWorkLists) {
        share.*one.list = lists.*one.list / groups;
    }
    share.triangle_pairs = share.triangle_pairs / kTriangleBatch * kTriangleBatch;
    return share;
}

/// The unused entries of each list.
[[nodiscard]] constexpr WorkLists unused_of(const WorkLists& lists,
                                            const WorkLists& used) noexcept {
    return of_each(lists, used, [](std::uint32_t of, std::uint32_t without) {
        return of > without ? of - without : 0;
    });
}

/// The share of a group in stage 1, which may query each pair twice (short and long permit). Each
/// query is a group with its own share; those of the long permit may use as much again. If stage 1
/// is the only stage, both divide the lists.
/// @param groups  one for each pair
[[nodiscard]] constexpr WorkLists first_share_of(const WorkLists& lists, std::uint32_t groups,
                                                 bool is_only, bool asks_twice) noexcept {
    return share_of(lists, is_only && asks_twice ? 2 * groups : groups);
}

/// The known-answer test is a group of its own. Two tetrahedra are two leaves.
inline constexpr WorkLists kKnownAnswerShare{
    .node_pairs = 8, .leaf_pairs = 8, .box_rows = 32, .triangle_pairs = 64, .rechecks = 64};

/// The share of the one part that is queried before the last stage, in addition to that stage's.
/// Most parts near contact need no more (docs/measurements/gpu-fill.txt).
inline constexpr WorkLists kFirstPartShare{
    .node_pairs = 8, .leaf_pairs = 8, .box_rows = 32, .triangle_pairs = 192, .rechecks = 0};

/// Which boxes of a halving tree are queried.
enum class TreeForm : std::uint8_t {
    whole = 0,  // every box below the root, level by level
    leaves,     // those of the last level only: one level deeper for the same number of queries
};

inline constexpr std::uint32_t kStagesMax = 3;
inline constexpr std::uint32_t kStageDepthMax = 31;

/// Limits of one cycle. The argument that a proven box is safe does not depend on them.
struct CyclePlan {
    std::uint32_t stages = 2;  // 1 to kStagesMax
    // Of each stage, in addition to the known-answer test's two. The first has three queries a
    // pair: now the whole box, and later a longer permit, and full speed.
    std::array<std::uint32_t, kStagesMax> queries{};
    std::array<WorkLists, kStagesMax> lists{};
    TreeForm form = TreeForm::leaves;
    std::uint32_t depth_max = kStageDepthMax;  // of all stages together: halvings of a box

    friend constexpr bool operator==(const CyclePlan&, const CyclePlan&) = default;
};

/// Largest depth of trees below `open` boxes within a stage's queries; 0: not one level fits.
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

/// Queries of one such tree.
[[nodiscard]] constexpr std::uint32_t tree_queries(std::uint32_t depth, TreeForm form) noexcept {
    const std::uint32_t leaves = 1U << depth;
    return depth == 0 ? 0 : form == TreeForm::whole ? 2 * leaves - 2 : leaves;
}

/// Depth of the first round of a group that has `queries` queries for all of its rounds.
[[nodiscard]] constexpr std::uint32_t first_round_depth(std::uint32_t queries,
                                                        TreeForm form) noexcept {
    return queries < 2 ? 0 : tree_depth(queries < 16 ? 2 : queries / 8, 1, form);
}

inline constexpr std::uint32_t kQueriesAPair = 3;  // room in the first stage

/// Sixteenths of a list for each stage but the last, which has the rest. The second of three
/// queries the near boxes, which need pairs of leaves and triangles. The last one queries many far
/// boxes, and each needs a few rows. Measured: docs/measurements/bounded-cycle.md,
/// "Asked again, then in rounds". Node pairs go with rows, rechecks with leaf pairs.
inline constexpr std::array<std::uint32_t, kStagesMax - 1> kSixteenthsOfRows{1, 3};
inline constexpr std::array<std::uint32_t, kStagesMax - 1> kSixteenthsOfLeaves{1, 12};
inline constexpr std::array<std::uint32_t, kStagesMax - 1> kSixteenthsOfTriangles{1, 14};

/// The part of a cycle's lists for stage `stage` of `stages`; it depends on these numbers only.
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
    return {part(cycle.node_pairs, kSixteenthsOfRows), part(cycle.leaf_pairs, kSixteenthsOfLeaves),
            part(cycle.box_rows, kSixteenthsOfRows),
            part(cycle.triangle_pairs, kSixteenthsOfTriangles),
            part(cycle.rechecks, kSixteenthsOfLeaves)};
}

/// Most rounds of the second of three stages. It first queries each open whole box once more,
/// within a quarter of its lists. Then rounds query parts of the boxes still open; each group has
/// its share of the rest, plus its unused part of that quarter. The first round has an eighth of
/// the queries, each of the others halves the open boxes. Measured:
/// docs/measurements/bounded-cycle.md.
inline constexpr std::uint32_t kRoundsMax = 4;
[[nodiscard]] constexpr bool asks_again(std::uint32_t stage, const CyclePlan& plan) noexcept {
    return stage == 1 && plan.stages == 3;
}
/// The lists of the second of three stages: a quarter for the boxes that are queried once more, the
/// rest for their parts.
[[nodiscard]] constexpr WorkLists lists_of_whole_boxes(const CyclePlan& plan) noexcept {
    return share_of(plan.lists[1], 4);
}
[[nodiscard]] constexpr WorkLists lists_of_rounds(const CyclePlan& plan) noexcept {
    return unused_of(plan.lists[1], lists_of_whole_boxes(plan));
}

/// The second of three stages queries this many times fewer boxes. If all of them stay open, the
/// last stage still reaches the same depth as by itself: both counts are powers of two.
inline constexpr std::uint32_t kLastForSecond = 16;

/// @param queries  of the last stage. A power of two: with TreeForm::leaves one less costs a level
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
        sum = sum + stage;
    }
    return sum;
}

/// Lists for the snapshot at which a jog begins, which gets no certificate: no more than a cycle of
/// the plan's stages. The last of three stages has most of the rows, which whole boxes need, and
/// the second most of the pairs of leaves and triangles, which queries about a near pair need.
struct JogLists {
    WorkLists margins;  // one query for each pair
    WorkLists rungs;    // all rungs of the pairs that have less than their margin
};
[[nodiscard]] constexpr JogLists jog_lists(const CyclePlan& plan) noexcept {
    if (plan.stages == 1) {
        const WorkLists half = share_of(plan.lists[0], 2);
        return {half, half};
    }
    return {plan.lists[plan.stages == 2 ? 0 : 2], plan.lists[1]};
}

/// The keys of a machine file for a cycle's plan (core/machine/cycle_plan.hpp).
struct CycleRules {
    bool is_pinned = false;  // false: another plan may be chosen at start
    // Defaults that prove most of the example programs for their work
    // (docs/measurements/bounded-cycle.md).
    std::uint32_t stages = 3;
    std::uint32_t queries = 512;  // of the last stage
    // No rechecks: those of box queries never decided a sample.
    WorkLists lists{.node_pairs = 192,
                    .leaf_pairs = 240,
                    .box_rows = 2816,
                    .triangle_pairs = 2240,
                    .rechecks = 0};

    friend constexpr bool operator==(const CycleRules&, const CycleRules&) = default;
};

}  // namespace axg
