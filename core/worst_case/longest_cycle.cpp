// SPDX-License-Identifier: Apache-2.0
#include "core/worst_case/longest_cycle.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "core/collision/known_answer.hpp"
#include "core/collision/query_tree.hpp"
#include "core/worst_case/query_deal.hpp"

namespace axg {
namespace {

// Just below the distance of kBeside: float cannot prove that pair apart, and double can.
constexpr double kMarginMm = 1.0 - 0x1p-23;

constexpr std::size_t kInPlace = 16;  // queries that are replaced at once

/// Queries of a stage, the same for each group. depth 0: the open boxes themselves.
struct Stage {
    std::uint32_t index = 0;  // of the plan's
    std::uint32_t groups = 0, parts = 0, depth = 0;
    bool is_whole = false;
    std::uint32_t calls = 1;              // of depth 0: each for other groups
    std::uint32_t kept = 0, left = 0;     // groups that stay open after it, and parts of each
    std::uint32_t halvings = 0;           // of its rounds, if it repeats boxes
    std::vector<std::uint32_t> rounds{};  // queries of each open group, a call each

    /// Queries of a group on one level of its trees.
    [[nodiscard]] std::uint32_t on_level(std::uint32_t level) const {
        return is_whole || level == depth ? parts << level : 0;
    }
    [[nodiscard]] std::uint32_t of_group() const {
        std::uint32_t sum = depth == 0 ? parts : 0;
        for (std::uint32_t level = 1; level <= depth; ++level) {
            sum += on_level(level);
        }
        return sum;
    }
    /// Queries of a group that stays open, in all rounds.
    [[nodiscard]] std::uint32_t of_rounds() const {
        return std::accumulate(rounds.begin(), rounds.end(), 0U);
    }
    [[nodiscard]] std::uint32_t queries() const {
        return calls * groups * of_group() + kept * of_rounds();
    }
};

/// Queries of at most `rounds` rounds, each of halves of boxes of the round before: their sum is
/// `queries` where possible, and the last round is as large as possible.
std::vector<std::uint32_t> halving_rounds(std::uint32_t boxes, std::uint32_t queries,
                                          std::uint32_t rounds) {
    std::vector<std::uint32_t> made;
    for (std::uint32_t left = rounds; left != 0 && queries >= 2; --left) {
        // The later rounds, each twice as large, use the rest.
        const std::uint32_t units = (1U << left) - 1;
        boxes = 2 * std::min(boxes, (queries / 2 + units - 1) / units);
        queries -= boxes;
        made.push_back(boxes);
    }
    return made;
}

/// The stage that repeats boxes. `shape.parts` parts stay open after its rounds, or all. Of the
/// numbers of rounds that allow this, it has the one with most queries. A group that overflows has
/// one round.
Stage stage_again(const CyclePlan& plan, const CycleShape& shape, std::uint32_t depth_left) {
    Stage stage{.index = 1, .groups = shape.open, .parts = 1, .kept = shape.kept, .left = 1};
    const std::uint32_t queries = plan.queries[1] / shape.kept;
    const std::uint32_t depth = std::min(depth_left, first_round_depth(queries, plan.form));
    for (std::uint32_t level = plan.form == TreeForm::whole ? 1 : depth; level <= depth; ++level) {
        if (level != 0) {
            stage.rounds.push_back(1U << level);
        }
    }
    stage.halvings = depth;
    if (depth == 0 || shape.layout == CycleLayout::overflowing) {
        return stage;
    }
    const std::uint32_t behind = std::min(kRoundsMax - 1, depth_left - depth);
    std::vector<std::uint32_t> most;
    std::uint32_t most_queries = 0;
    stage.left = std::min(shape.parts, 1U << depth);
    for (std::uint32_t rounds = 1; rounds <= behind; ++rounds) {
        const std::vector<std::uint32_t> made =
            halving_rounds(1U << depth, queries - tree_queries(depth, plan.form), rounds);
        const std::uint32_t left = made.empty() ? 0 : std::min(shape.parts, made.back());
        const std::uint32_t sum = std::accumulate(made.begin(), made.end(), 0U);
        if (left > stage.left || (left == stage.left && sum > most_queries)) {
            stage.left = left;
            most = made;
            most_queries = sum;
        }
    }
    stage.rounds.insert(stage.rounds.end(), most.begin(), most.end());
    stage.halvings += static_cast<std::uint32_t>(most.size());
    return stage;
}

/// Returns the same stages as StagedProver.
std::vector<Stage> stages_of(const CyclePlan& plan, const CycleShape& shape) {
    std::vector<Stage> stages{{.index = 0,
                               .groups = shape.tasks,
                               .parts = 1,
                               .calls = shape.asks_twice ? 2U : 1U,
                               .kept = shape.open,
                               .left = 1}};
    std::uint32_t depth_left = plan.depth_max;
    for (std::uint32_t i = 1; i < plan.stages; ++i) {
        if (asks_again(i, plan)) {
            stages.push_back(stage_again(plan, shape, depth_left));
            depth_left -= stages.back().halvings;
            continue;
        }
        const std::uint32_t groups = stages.back().kept, parts = stages.back().left;
        const std::uint32_t depth =
            std::min(depth_left, tree_depth(plan.queries[i], groups * parts, plan.form));
        if (depth == 0) {
            continue;  // the prover leaves this stage out
        }
        depth_left -= depth;
        stages.push_back({.index = i,
                          .groups = groups,
                          .parts = parts,
                          .depth = depth,
                          .is_whole = plan.form == TreeForm::whole,
                          .kept = groups,
                          .left = parts << depth});
    }
    return stages;
}

std::uint32_t query_count(const CyclePlan& plan, const CycleShape& shape) {
    std::uint32_t sum = 0;
    for (const Stage& stage : stages_of(plan, shape)) {
        sum += stage.queries();
    }
    return sum;
}

/// Whether the prover may query the first part of this stage separately.
bool has_first_part(const CyclePlan& plan, const Stage& stage) noexcept {
    return stage.index != 0 && stage.index + 1 == plan.stages && stage.groups == 1 &&
           stage.depth <= kTreeDepthOfParts;
}

/// Work done for a group: at most its share.
WorkLists done_of(const GroupWork& group) noexcept {
    return of_each(group.used, group.share,
                   [](std::uint32_t used, std::uint32_t share) { return std::min(used, share); });
}

/// As many corners as a leaf may have at the charge of one: its own, and copies. A leaf with more,
/// moved as vertices, costs less per charge.
LeafCorners most_corners(const TreeLeaf& leaf) noexcept {
    LeafCorners corners = corners_of(leaf);
    corners.count = kNodeWidth;
    return corners;
}

}  // namespace

const char* name_of(CycleLayout layout) noexcept {
    constexpr const char* kNames[] = {"even", "heaped", "rows", "sparse", "overflowing"};
    return kNames[static_cast<unsigned>(layout)];
}

WorkLists sum_of(const CycleWork& work) noexcept {
    WorkLists sum;
    for (const StageWork& stage : work) {
        sum = sum + stage.lists;
    }
    return sum;
}

std::uint32_t queries_of(const CycleWork& work) noexcept {
    std::uint32_t sum = 0;
    for (const StageWork& stage : work) {
        sum += stage.queries;
    }
    return sum;
}

std::vector<CycleShape> cycle_shapes(const CyclePlan& plan, std::uint32_t tasks, bool asks_twice) {
    const auto most = [&plan](CycleShape shape, std::uint32_t CycleShape::*field,
                              std::uint32_t last) {
        CycleShape best = shape;
        for (shape.*field = 1; shape.*field <= last; ++(shape.*field)) {
            best = query_count(plan, shape) > query_count(plan, best) ? shape : best;
        }
        return best;
    };
    std::vector<std::uint32_t> opens{1, std::min(4U, tasks), tasks};
    opens.push_back(most({.tasks = tasks}, &CycleShape::open, tasks).open);
    std::sort(opens.begin(), opens.end());
    opens.erase(std::unique(opens.begin(), opens.end()), opens.end());
    std::vector<CycleShape> shapes;
    for (const std::uint32_t open : opens) {
        const CycleShape one{.tasks = tasks, .asks_twice = asks_twice, .open = open, .kept = open};
        shapes.push_back(one);
        if (plan.stages > 2) {
            const CycleShape many = most(one, &CycleShape::parts, plan.queries[2] / open);
            if (many.parts != 1) {
                shapes.push_back(many);
            }
        }
    }
    if (plan.stages > 2 && tasks > 1) {
        const CycleShape one{.tasks = tasks, .asks_twice = asks_twice, .open = tasks, .kept = 1};
        shapes.push_back(most(one, &CycleShape::parts, plan.queries[2]));
    }
    return shapes;
}

/// Plans the queries of each call, and which of them stay open; make_queries constructs them later.
void LongestCycle::plan_calls(const CyclePlan& plan, const CycleShape& shape,
                              bool asks_first_part) {
    const std::vector<Stage> stages = stages_of(plan, shape);
    // The first parts of each group stay open.
    const auto add = [this](const Stage& stage, std::uint32_t groups, std::uint32_t each,
                            std::uint32_t open_groups, std::uint32_t open_parts, bool ends_deal) {
        Call call;
        call.stage = stage.index;
        call.count = groups * each;
        call.groups = groups;
        call.deal = deals_.size() - 1;
        call.ends_deal = ends_deal;
        for (std::uint32_t query = 0; query < call.count; ++query) {
            if (query / each < open_groups && query % each < open_parts) {
                call.open.push_back(query);
            }
        }
        calls_.push_back(std::move(call));
    };
    for (std::uint32_t i = 0; i < stages.size(); ++i) {
        const Stage& stage = stages[i];
        const bool is_last = i + 1 == stages.size();
        const std::uint32_t kept = is_last ? 0 : stage.kept;
        if (asks_first_part && has_first_part(plan, stage)) {
            Call call;
            call.stage = stage.index - 1;  // whose engine receives it
            call.count = call.groups = 1;
            call.is_first_part = true;
            calls_.push_back(std::move(call));
        }
        const std::uint32_t groups = stage.calls * stage.groups;
        planned_[stage.index] = {.queries = stage.queries(), .groups = groups};
        if (asks_again(stage.index, plan)) {
            deals_.push_back({1, groups, 1, share_of(lists_of_whole_boxes(plan), groups)});
            add(stage, groups, 1, stage.rounds.empty() ? kept : stage.kept, 1, true);
            if (!stage.rounds.empty()) {
                deals_.push_back({1, stage.kept, stage.of_rounds(),
                                  share_of(lists_of_rounds(plan), stage.kept)});
            }
            for (std::size_t round = 0; round < stage.rounds.size(); ++round) {
                const bool ends = round + 1 == stage.rounds.size();
                const std::uint32_t left = ends ? stage.left : stage.rounds[round + 1] / 2;
                add(stage, stage.kept, stage.rounds[round], ends ? kept : stage.kept, left, ends);
            }
            continue;
        }
        deals_.push_back({stage.index, groups, stage.of_group(),
                          stage.index == 0 ? first_share_of(plan.lists[0], shape.tasks,
                                                            plan.stages == 1, shape.asks_twice)
                                           : share_of(plan.lists[stage.index], groups)});
        for (std::uint32_t more = 1; more < stage.calls; ++more) {  // the longer permit goes first
            add(stage, stage.groups, 1, stage.groups, 1, false);
        }
        for (std::uint32_t level = std::min(1U, stage.depth); level <= stage.depth; ++level) {
            const std::uint32_t each = stage.depth == 0 ? stage.parts : stage.on_level(level);
            if (each != 0) {
                const bool ends = level == stage.depth;
                add(stage, stage.groups, each, ends ? kept : stage.groups, ends ? stage.left : each,
                    ends);
            }
        }
    }
}

/// Returns an empty string, or the reason for a failure.
std::string LongestCycle::make_queries(const CycleShape& shape, const Options& options) {
    std::map<QueryDeal, std::vector<std::uint32_t>> kinds;  // first of the two bodies of each
    std::map<QueryDeal, std::size_t> uses;
    std::size_t bytes = 0;
    const bool overflows = shape.layout == CycleLayout::overflowing;
    std::vector<QueryDeal> deals;
    std::vector<std::uint32_t> taken;
    std::size_t deal = deals_.size();
    std::uint32_t first_group = 0;
    for (Call& call : calls_) {
        if (call.is_first_part) {
            std::string fault =
                deal_group(overflows ? kFirstPartShare + kFirstPartShare : kFirstPartShare, 1,
                           shape.layout, deals);
            if (!fault.empty()) {
                return fault;
            }
            call.bodies.push_back(static_cast<std::uint32_t>(bodies_.trees.size()));
            call.lists = work_of(deals.front());
            bytes += make_bodies(deals.front(), bodies_);
            continue;
        }
        const Deal& of = deals_[call.deal];
        if (call.deal != deal) {
            deal = call.deal;
            WorkLists share = of.share;
            share.rechecks = options.is_float_only ? 0 : share.rechecks;
            std::string fault =
                deal_group(overflows ? share + share : share, of.each, shape.layout, deals);
            if (!fault.empty()) {
                return fault;
            }
            taken.assign(of.groups, 0);
            first_group = 0;
        }
        const std::uint32_t each = call.count / call.groups;
        for (std::uint32_t i = 0; i < call.count; ++i) {
            const QueryDeal& query = deals[taken[first_group + i / each]++];
            std::vector<std::uint32_t>& bodies = kinds[query];
            if (bodies.empty() || bytes < options.memory_bytes) {
                bodies.push_back(static_cast<std::uint32_t>(bodies_.trees.size()));
                bytes += make_bodies(query, bodies_);
            }
            const std::uint32_t body = bodies[uses[query]++ % bodies.size()];
            call.bodies.push_back(body);
            planned_[of.stage].lists = planned_[of.stage].lists + work_of(query);
        }
        first_group += call.groups < of.groups ? call.groups : 0;
    }
    return {};
}

/// False: no memory.
bool LongestCycle::place_trees() {
    std::size_t bytes = 0;
    for (const TreeData& tree : bodies_.trees) {
        bytes += Arena::size_bytes<TreeNode>(tree.nodes.size()) +
                 Arena::size_bytes<TreeLeaf>(tree.leaves.size()) +
                 Arena::size_bytes<LeafCorners>(tree.leaves.size());
    }
    arena_.emplace(bytes);
    if (!arena_->ok()) {
        return false;
    }
    for (std::size_t i = 0; i < bodies_.trees.size(); ++i) {
        const TreeData& tree = bodies_.trees[i];
        const std::span<TreeNode> nodes = arena_->take<TreeNode>(tree.nodes.size());
        const std::span<TreeLeaf> leaves = arena_->take<TreeLeaf>(tree.leaves.size());
        const std::span<LeafCorners> corners = arena_->take<LeafCorners>(tree.leaves.size());
        std::copy(tree.nodes.begin(), tree.nodes.end(), nodes.begin());
        std::copy(tree.leaves.begin(), tree.leaves.end(), leaves.begin());
        std::transform(leaves.begin(), leaves.end(), corners.begin(), most_corners);
        trees_.push_back({nodes, leaves, bodies_.reach_mm[i], corners});
    }
    tree_bytes_ = {reinterpret_cast<const std::byte*>(trees_.front().nodes.data()), bytes};
    bodies_ = {};
    return true;
}

std::optional<LongestCycle> LongestCycle::create(const CyclePlan& plan, const CycleShape& wanted,
                                                 const Options& options, std::string& fault) {
    LongestCycle out;
    CycleShape shape = wanted;
    if (shape.layout == CycleLayout::overflowing) {  // a group that overflows stays open as a whole
        shape.open = shape.kept = shape.tasks;
        shape.parts = 1;
    }
    out.plan_calls(plan, shape, options.asks_first_part);
    fault = out.make_queries(shape, options);
    if (!fault.empty()) {
        return std::nullopt;
    }
    const Mesh known = known_answer_mesh();
    out.known_answer_mesh_ = options.known_answer_mesh;
    out.own_known_answer_mesh_ = static_cast<std::uint32_t>(out.bodies_.trees.size());
    out.bodies_.trees.push_back(build_tree(known));
    out.bodies_.reach_mm.push_back(reach_of(known));
    if (!out.place_trees()) {
        fault = "not enough memory for the trees of the longest cycle";
        return std::nullopt;
    }
    out.is_float_only_ = options.is_float_only;
    std::optional<CpuEngine> engine =
        CpuEngine::over_trees(out.trees_, Capacities{}, options.lanes);
    if (!engine) {
        fault = kNoLaneSet;
        return std::nullopt;
    }
    out.engine_.emplace(std::move(*engine));
    return out;
}

void LongestCycle::begin() noexcept {
    call_ = 0;
    is_other_ = false;
    done_ = {};
}

void LongestCycle::run(std::span<const Query> queries, std::span<QueryResult> results,
                       std::span<GroupWork> groups) noexcept {
    std::size_t count = queries.size();
    while (count != 0 && queries[count - 1].mesh_a == known_answer_mesh_ &&
           queries[count - 1].mesh_b == known_answer_mesh_) {
        --count;
    }
    if (call_ == calls_.size() || count != calls_[call_].count || queries.size() > count + 2) {
        is_other_ = true;
        return;
    }
    const Call& call = calls_[call_++];
    // A few at a time, so that the replacements of queries use no room in the caches.
    std::array<Query, kInPlace> own;
    for (std::size_t first = 0; first < queries.size(); first += kInPlace) {
        const std::size_t end = std::min(queries.size(), first + kInPlace);
        for (std::size_t i = first; i < end; ++i) {
            Query& query = own[i - first] = queries[i];
            const bool is_known_answer = i >= count;
            query.mesh_a = is_known_answer ? own_known_answer_mesh_ : call.bodies[i];
            query.mesh_b = is_known_answer ? own_known_answer_mesh_ : call.bodies[i] + 1;
            if (!is_known_answer) {
                query.is_float_only = is_float_only_;
                query.r_mm = kMarginMm;
                query.pose_error_mm = 0;
                query.pose = {};
            }
        }
        engine_->run({own.data(), end - first}, results.subspan(first, end - first), groups);
    }
    for (const std::uint32_t open : call.open) {
        results[open].proof = Proof::not_proven;
    }
    if (call.is_first_part && results[0].proof == Proof::far) {
        is_other_ = is_other_ || groups[0].used != call.lists;
    }
    if (call.ends_deal) {
        const auto groups_asked = static_cast<std::uint32_t>(groups.size()) - 1;
        StageWork& done = done_[call.stage];
        done.queries = planned_[call.stage].queries;
        done.groups = std::max(done.groups, groups_asked);
        for (const GroupWork& group : groups.first(groups_asked)) {
            done.lists = done.lists + done_of(group);
        }
    }
}

bool LongestCycle::did_stages(std::uint32_t stages) const noexcept {
    const auto is_behind = [stages](const Call& call) { return call.stage >= stages; };
    const auto planned = std::find_if(calls_.begin(), calls_.end(), is_behind) - calls_.begin();
    return !is_other_ && call_ == static_cast<std::size_t>(planned) &&
           std::equal(planned_.begin(), planned_.begin() + stages, done_.begin());
}

Engine LongestCycle::engine() noexcept {
    return {.self = this,
            .run =
                [](void* self, std::span<const Query>, std::span<QueryResult>) noexcept {
                    static_cast<LongestCycle*>(self)->is_other_ = true;  // outside of every group
                },
            .run_groups =
                [](void* self, std::span<const Query> queries, std::span<QueryResult> results,
                   std::span<GroupWork> groups) noexcept {
                    static_cast<LongestCycle*>(self)->run(queries, results, groups);
                }};
}

}  // namespace axg
