// SPDX-License-Identifier: Apache-2.0
#include "core/certificate/staged_proof.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/fetch.hpp"
#include "core/certificate/box_queries.hpp"
#include "core/collision/known_answer.hpp"

namespace axg {
namespace {

constexpr std::uint32_t kAhead = 12;  // items between a prefetch and its write

/// Copies the proof of a larger box to its task.
void take_proofs(std::span<JointBoxResult> results, std::uint32_t own) noexcept {
    for (std::uint32_t i = 0; i < own; ++i) {
        JointBoxResult& wider = results[i + own];
        if (wider.proof == JointBoxProof::proven) {
            const std::uint32_t queries = results[i].queries + wider.queries;
            wider.queries = 0;  // they count once
            results[i] = wider;
            results[i].queries = queries;
        }
    }
}

}  // namespace

bool asks_first_part(const Machine& machine, const CyclePlan& plan) noexcept {
    const auto moves = [](const Body& body) { return body.joint.axis != kNoIndex; };
    return plan.stages > 1 && plan.form == TreeForm::leaves && lists_of(plan).rechecks == 0 &&
           std::count_if(machine.bodies.begin(), machine.bodies.end(), moves) <= kTreeJointsMax;
}

std::optional<StagedProver> StagedProver::create(const Machine& machine, std::uint32_t tasks,
                                                 const CyclePlan& plan,
                                                 std::uint32_t known_answer_mesh) {
    AXG_ASSERT(plan.stages >= 1 && plan.stages <= kStagesMax && tasks < UINT16_MAX);
    std::uint32_t queries = tasks;
    for (std::uint32_t stage = 1; stage < plan.stages; ++stage) {
        queries = std::max(queries, plan.queries[stage]);
    }
    const std::size_t nodes = std::size_t{2} * queries;  // trees with queries only of the leaves
    Arena arena(BoxQueries::size_bytes(tasks) + Arena::size_bytes<BoxQueries>(1) +
                Arena::size_bytes<BoxItem>(nodes) + Arena::size_bytes<Node>(nodes) +
                Arena::size_bytes<std::uint32_t>(queries) + Arena::size_bytes<Query>(queries + 2) +
                Arena::size_bytes<QueryResult>(queries + 2) +
                Arena::size_bytes<GroupWork>(tasks + 1) + Arena::size_bytes<QueryStatus>(tasks) +
                Arena::size_bytes<std::uint32_t>(tasks) + Arena::size_bytes<GroupRounds>(tasks) +
                Arena::size_bytes<WorkLists>(tasks) + Arena::size_bytes<QueryTree>(kQueryTreesMax) +
                Arena::size_bytes<BoxQueries::TreePlan>(kQueryTreesMax) +
                Arena::size_bytes<TreeRoot>(queries));
    if (!arena.ok()) {
        return std::nullopt;
    }
    StagedProver prover(plan, known_answer_mesh, std::move(arena));
    prover.asks_first_part_ = axg::asks_first_part(machine, plan);
    BoxQueries* const place = prover.arena_.take<BoxQueries>(1).data();
    prover.boxes_ =
        std::construct_at(place, machine, tasks, lists_of(plan).rechecks == 0, prover.arena_);
    prover.items_ = prover.arena_.take<BoxItem>(nodes);
    prover.nodes_ = prover.arena_.take<Node>(nodes);
    prover.asked_ = prover.arena_.take<std::uint32_t>(queries);
    prover.queries_ = prover.arena_.take<Query>(queries + 2);
    prover.results_ = prover.arena_.take<QueryResult>(queries + 2);
    prover.groups_ = prover.arena_.take<GroupWork>(tasks + 1);
    prover.full_ = prover.arena_.take<QueryStatus>(tasks);
    prover.group_of_ = prover.arena_.take<std::uint32_t>(tasks);
    prover.rounds_ = prover.arena_.take<GroupRounds>(tasks);
    prover.left_ = prover.arena_.take<WorkLists>(tasks);
    prover.trees_ = prover.arena_.take<QueryTree>(kQueryTreesMax);
    prover.tree_plans_ = prover.arena_.take<BoxQueries::TreePlan>(kQueryTreesMax);
    prover.roots_ = prover.arena_.take<TreeRoot>(queries);
    prover.arena_.seal();
    return prover;
}

/// Assigns a group with its share to each open task.
void StagedProver::deal_groups(std::uint32_t open, const WorkLists& lists) noexcept {
    std::fill(group_of_.begin(), group_of_.end(), kNoIndex);
    group_count_ = 0;
    for (const BoxItem& item : items_.first(open)) {
        if (group_of_[item.task] == kNoIndex) {
            group_of_[item.task] = group_count_++;
        }
    }
    const WorkLists share = group_count_ == 0 ? WorkLists{} : share_of(lists, group_count_);
    std::fill_n(groups_.begin(), group_count_, GroupWork{.share = share});
    std::fill_n(rounds_.begin(), group_count_, GroupRounds{0, 0, false});
}

/// Makes the open items the roots of the next queries.
void StagedProver::begin_round(std::uint32_t open) noexcept {
    std::fill_n(nodes_.begin(), open, Node{kNoIndex, QueryStatus::not_run, true, false, true});
    node_count_ = open;
}

/// Adds the halves of the nodes from `begin` on as nodes, except for groups that are done. If lazy,
/// skips proven nodes.
void StagedProver::grow_level(std::span<const JointBoxTask> tasks, std::uint32_t begin,
                              bool is_lazy) noexcept {
    const std::uint32_t end = node_count_;
    for (std::uint32_t i = begin; i < end; ++i) {
        const BoxItem& item = items_[i];
        if (item.widest_axis == kNoIndex || (is_lazy && nodes_[i].is_covered) ||
            rounds_[group_of_[item.task]].is_done) {
            continue;
        }
        nodes_[i].is_leaf = false;
        const JointBoxTask& task = tasks[item.task];
        for (const bool is_upper : {false, true}) {
            AXG_ASSERT(node_count_ < nodes_.size());
            fetch_to_write(items_, node_count_ + kAhead);
            boxes_->halve(task, item, is_upper, items_[node_count_]);
            if (!boxes_->is_proven_already(task, items_[node_count_].box)) {
                nodes_[node_count_++] = {i, QueryStatus::not_run, true, false, true};
            }
        }
    }
}

void StagedProver::ask(std::span<const JointBoxTask> tasks, std::uint32_t first,
                       std::uint32_t count) noexcept {
    AXG_ASSERT(query_count_ + count <= asked_.size());
    const std::span<Query> queries = queries_.subspan(query_count_, count);
    boxes_->pose(tasks, items_.subspan(first, count), queries);
    for (std::uint32_t i = 0; i < count; ++i) {
        queries[i].group = static_cast<std::uint16_t>(group_of_[items_[first + i].task]);
        asked_[query_count_++] = first + i;
    }
}

/// Adds the known-answer test's queries in a separate group.
std::span<Query> StagedProver::add_known_answer() noexcept {
    const std::uint32_t count = known_answer_mesh_ != kNoIndex ? 2 : 0;
    const std::span<Query> queries = queries_.subspan(query_count_, count);
    for (std::uint32_t i = 0; i < count; ++i) {
        queries[i] = known_answer_query(known_answer_mesh_, i != 0);
        queries[i].group = static_cast<std::uint16_t>(group_count_);
        queries[i].is_float_only = boxes_->are_float_only();
    }
    groups_[group_count_] = {.share = kKnownAnswerShare};
    return queries;
}

void StagedProver::note(QueryStatus status) noexcept {
    const bool is_lost = status == QueryStatus::not_run || status == QueryStatus::bad_rounding;
    lost_ = is_lost && lost_ == QueryStatus::ok ? status : lost_;
}

/// Checks the known-answer test's results, which follow those of `count` queries.
void StagedProver::judge_known_answer(const Engine& engine, std::uint32_t count,
                                      StagedWork& work) noexcept {
    if (known_answer_mesh_ == kNoIndex) {
        return;
    }
    const QueryResult &far = results_[count], &near = results_[count + 1];
    // In an engine without groups, all queries of a call share its lists.
    const bool is_full = engine.run_groups == nullptr && is_batch_lost(far, near);
    if (is_full) {
        std::fill_n(results_.begin(), count, far);
    }
    const std::uint16_t seen = is_full ? kKnownAnswerSignature : known_answer_signature(far, near);
    work.known_answer_signature = work.calls == 0 || work.known_answer_signature == seen ? seen : 0;
    note(far.status);
    note(near.status);
}

/// False: the engine is lost, and all its results in this cycle are void.
bool StagedProver::end_call(const Engine& engine, std::uint32_t queries,
                            StagedWork& work) noexcept {
    ++work.calls;
    work.batches += engine.prefers_batches ? 1 : 0;
    work.queries += queries;
    work.planned_queries += queries;
    return lost_ == QueryStatus::ok;
}

/// Runs the prepared queries. False: the engine is lost; all its results in this cycle are void.
bool StagedProver::run(const Engine& engine, StagedWork& work) noexcept {
    const auto all = static_cast<std::uint32_t>(query_count_ + add_known_answer().size());
    std::fill_n(results_.begin(), all, QueryResult{});  // a silent engine proves nothing
    engine(queries_.first(all), results_.first(all), groups_.first(group_count_ + 1));
    judge_known_answer(engine, query_count_, work);
    for (std::uint32_t i = 0; i < query_count_; ++i) {
        const QueryResult& result = results_[i];
        Node& node = nodes_[asked_[i]];
        node.status = result.status;
        node.is_covered = result.proof == Proof::far && result.status == QueryStatus::ok;
        node.may_be_split = may_help_to_split(result.status, queries_[i].r_mm);
        note(result.status);
    }
    return end_call(engine, std::exchange(query_count_, 0), work);
}

/// Plans the leaves of trees of this depth below the first `roots` nodes. False: the engine cannot
/// pose them.
bool StagedProver::plan_parts(std::span<const JointBoxTask> tasks, std::uint32_t roots,
                              std::uint32_t depth) noexcept {
    if (!boxes_->are_float_only() || plan_.form != TreeForm::leaves || depth > kTreeDepthOfParts) {
        return false;
    }
    const std::optional<std::uint32_t> trees =
        boxes_->plan_parts(tasks, items_.first(roots), depth, trees_, tree_plans_, roots_);
    if (!trees) {
        return false;
    }
    for (std::uint32_t i = 0; i < roots; ++i) {
        roots_[i].group = static_cast<std::uint16_t>(group_of_[items_[i].task]);
    }
    parts_ = {trees_.first(*trees), roots_.first(roots), depth};
    return true;
}

/// In the last stage one part that is not far loses the task, and near contact most parts are not.
/// So this queries the first part alone before all of them are posed. If the query exceeds its own
/// share, it decides nothing.
bool StagedProver::is_lost_by_first_part(const Engine& engine, std::span<const JointBoxTask> tasks,
                                         std::span<JointBoxResult> results, std::uint32_t depth,
                                         StagedWork& work) noexcept {
    if (engine.prefers_batches || !plan_parts(tasks, 1, depth)) {
        return false;
    }
    Query& query = queries_[0];
    query = Query{};
    if (part_query({trees_[0], roots_[0], depth, 0}, query)) {
        return false;
    }
    query.group = 0;
    GroupWork group{.share = kFirstPartShare};
    QueryResult& said = results_[0];
    said = QueryResult{};
    engine({&query, 1}, {&said, 1}, {&group, 1});
    note(said.status);
    work.used = work.used + group.used;
    if (said.proof == Proof::far || said.status != QueryStatus::ok ||
        first_full(group) != QueryStatus::ok) {
        return false;
    }
    const BoxItem& root = items_[0];
    BoxItem part;
    boxes_->make_part(tasks[root.task], root, tree_plans_[0], depth, 0, part);
    JointBoxResult& result = results[root.task];
    result = {JointBoxProof::budget_spent, said.status, result.queries + 1, part.box};
    ++work.queries;
    work.planned_queries += node_count_ << depth;
    return true;
}

/// Queries the planned parts; those that are not far become nodes. Returns as `run`.
bool StagedProver::run_parts(const Engine& engine, std::span<const JointBoxTask> tasks,
                             std::span<JointBoxResult> results, bool is_last,
                             StagedWork& work) noexcept {
    const auto count = static_cast<std::uint32_t>(parts_.count());
    const std::span<const Query> known_answer = add_known_answer();
    const std::span<QueryResult> said = results_.first(count + known_answer.size());
    std::fill(said.begin(), said.end(), QueryResult{});
    engine.run_parts(engine.self, parts_, known_answer, said, groups_.first(group_count_ + 1));
    judge_known_answer(engine, count, work);
    std::uint32_t last = kNoIndex;  // the newest open node that may be split
    for (std::uint32_t i = 0; i < count; ++i) {
        const QueryResult& result = results_[i];
        const std::uint32_t root = i >> parts_.depth;
        const TreeRoot& from = parts_.roots[root];
        note(result.status);
        nodes_[root].is_leaf = false;
        if (result.proof == Proof::far && result.status == QueryStatus::ok &&
            first_full(groups_[from.group]) == QueryStatus::ok) {
            ++results[items_[root].task].queries;
            continue;
        }
        const bool may_be_split = may_help_to_split(result.status, parts_.trees[from.tree].r_mm);
        if (is_last && may_be_split && last != kNoIndex && items_[last].task == items_[root].task) {
            ++results[items_[root].task].queries;
            nodes_[last].status = result.status;  // one open node represents the others
            continue;
        }
        boxes_->make_part(tasks[items_[root].task], items_[root], tree_plans_[from.tree],
                          parts_.depth, i & ((1U << parts_.depth) - 1), items_[node_count_]);
        last = may_be_split ? node_count_ : last;
        nodes_[node_count_++] = {root, result.status, true, false, may_be_split};
    }
    return end_call(engine, count, work);
}

/// Queries trees of this depth below the present nodes.
bool StagedProver::run_stage(const Engine& engine, std::span<const JointBoxTask> tasks,
                             std::span<JointBoxResult> results, std::uint32_t depth, bool is_last,
                             StagedWork& work) noexcept {
    const bool is_lazy = !engine.prefers_batches;
    const auto is_done = [](const GroupRounds& group) { return group.is_done; };
    const bool asks_all = std::none_of(rounds_.begin(), rounds_.begin() + group_count_, is_done);
    if (engine.run_parts != nullptr && asks_all && (node_count_ << depth) + 2 <= engine.parts_max &&
        plan_parts(tasks, node_count_, depth)) {
        return run_parts(engine, tasks, results, is_last, work);
    }
    std::uint32_t begin = 0;
    for (std::uint32_t level = 1; level <= depth; ++level) {
        const std::uint32_t first = node_count_;
        grow_level(tasks, begin, is_lazy);
        begin = first;
        const std::uint32_t count = node_count_ - first;
        if (plan_.form == TreeForm::whole || level == depth) {
            ask(tasks, first, count);
        } else {
            boxes_->pose(tasks, items_.subspan(first, count), {});
            for (std::uint32_t i = first; i < node_count_; ++i) {
                if (items_[i].widest_axis == kNoIndex) {  // its tree ends here
                    ask(tasks, i, 1);
                }
            }
        }
        // In the last stage one box of the last level that is not far loses the task.
        for (GroupWork& group : groups_.first(group_count_)) {
            group.needs_all = is_lazy && is_last && level == depth;
        }
        if ((is_lazy || level == depth) && query_count_ != 0 && !run(engine, work)) {
            return false;
        }
    }
    return true;
}

/// Queries the open boxes once more, in a part of the stage's lists: this proves most whole boxes
/// of pairs that are near, and not too near, without a cut. False: the engine is lost.
bool StagedProver::run_again(const Engine& engine, std::span<const JointBoxTask> tasks,
                             std::span<JointBoxResult> results, std::uint32_t& open,
                             StagedWork& work) noexcept {
    deal_groups(open, lists_of_whole_boxes(plan_));
    begin_round(open);
    ask(tasks, 0, open);
    if (!run(engine, work)) {
        return false;
    }
    for (const BoxItem& item : items_.first(open)) {  // one of each task
        const GroupWork& group = groups_[group_of_[item.task]];
        left_[item.task] = unused_of(group.share, group.used);
        work.used = work.used + group.used;
    }
    open = leave_open(results, open);
    deal_groups(open, lists_of_rounds(plan_));
    for (const BoxItem& item : items_.first(open)) {
        WorkLists& share = groups_[group_of_[item.task]].share;
        share = share + left_[item.task];
    }
    return true;
}

/// Selects the groups that halve once more: those with enough queries and an unspent share.
/// False: none.
bool StagedProver::plan_round(std::uint32_t open) noexcept {
    for (GroupRounds& group : rounds_.first(group_count_)) {
        group.open = 0;
    }
    for (const BoxItem& item : items_.first(open)) {
        ++rounds_[group_of_[item.task]].open;
    }
    bool is_any = false;
    for (std::uint32_t i = 0; i < group_count_; ++i) {
        GroupRounds& group = rounds_[i];
        const std::uint32_t queries = 2 * group.open;
        group.is_done = group.is_done || group.open == 0 || queries > group.queries ||
                        first_full(groups_[i]) != QueryStatus::ok;
        group.queries -= group.is_done ? 0 : queries;
        is_any = is_any || !group.is_done;
    }
    return is_any;
}

/// The second of three stages: after its first round, the depth of a group depends on its own open
/// boxes only. A round that exceeds the share is lost, earlier rounds remain valid. False: the
/// engine is lost.
bool StagedProver::run_rounds(const Engine& engine, std::span<const JointBoxTask> tasks,
                              std::span<JointBoxResult> results, std::uint32_t& open,
                              std::uint32_t& depth_left, StagedWork& work) noexcept {
    ++work.stages;
    if (!run_again(engine, tasks, results, open, work)) {
        return false;
    }
    const std::uint32_t queries = open == 0 ? 0 : plan_.queries[1] / group_count_;
    std::uint32_t depth = std::min(depth_left, first_round_depth(queries, plan_.form));
    for (GroupRounds& group : rounds_.first(group_count_)) {
        group.queries = queries - tree_queries(depth, plan_.form);
    }
    for (std::uint32_t round = 0; depth != 0; ++round) {
        depth_left -= depth;
        begin_round(open);
        if (!run_stage(engine, tasks, results, depth, false, work)) {
            return false;
        }
        open = leave_open(results, open);
        depth = round + 1 < kRoundsMax && depth_left != 0 && plan_round(open) ? 1 : 0;
    }
    for (const GroupWork& group : groups_.first(group_count_)) {
        work.used = work.used + group.used;
    }
    return true;
}

/// Queries the whole boxes of the first `own` tasks and those of the second half. An engine that
/// does not prefer batches skips a task whose larger box is far.
bool StagedProver::run_first(const Engine& engine, std::span<const JointBoxTask> tasks,
                             std::uint32_t own, StagedWork& work) noexcept {
    if (engine.prefers_batches || own == tasks.size()) {
        ask(tasks, 0, node_count_);
        return run(engine, work);
    }
    std::uint32_t first_wider = 0;
    while (first_wider < node_count_ && items_[first_wider].task < own) {
        ++first_wider;
    }
    const std::uint32_t wider = node_count_ - first_wider;
    ask(tasks, first_wider, wider);
    if (wider != 0 && !run(engine, work)) {
        return false;
    }
    std::uint32_t next = first_wider;
    for (std::uint32_t i = 0; i < first_wider; ++i) {
        const std::uint32_t twin = items_[i].task + own;
        while (next < node_count_ && items_[next].task < twin) {
            ++next;
        }
        const bool is_asked = next < node_count_ && items_[next].task == twin;
        nodes_[i].is_covered = is_asked && nodes_[next].is_covered &&
                               first_full(groups_[group_of_[twin]]) == QueryStatus::ok;
        if (!nodes_[i].is_covered) {
            ask(tasks, i, 1);
        }
    }
    return (query_count_ == 0 && wider != 0) || run(engine, work);
}

/// Ends the first stage: the proof of a larger box also proves its task. Drops unproven larger
/// boxes unless `halves_wider` is set and no task is open. Returns the number of open boxes.
std::uint32_t StagedProver::take_wider(std::span<JointBoxResult> results, std::uint32_t own,
                                       std::uint32_t open, bool halves_wider) const noexcept {
    for (const BoxItem& item : items_.first(open)) {
        if (item.task >= own) {
            results[item.task].proof = JointBoxProof::budget_spent;
        }
    }
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < open; ++i) {
        const std::uint32_t task = items_[i].task;
        if (task < own && results[task + own].proof != JointBoxProof::proven) {
            items_[kept++] = items_[i];
        }
    }
    take_proofs(results, own);
    if (!halves_wider || kept != 0) {
        return kept;
    }
    for (std::uint32_t i = 0; i < open; ++i) {  // all of them are larger boxes
        if (items_[i].task >= own) {
            results[items_[i].task].proof = JointBoxProof::proven;  // until it is left open
            items_[kept++] = items_[i];
        }
    }
    return kept;
}

/// Marks the parts of far boxes as proven; a group that spent its share proves nothing.
void StagedProver::cover(std::span<JointBoxResult> results) noexcept {
    for (std::uint32_t i = 0; i < node_count_; ++i) {
        Node& node = nodes_[i];
        JointBoxResult& result = results[items_[i].task];
        const QueryStatus full = full_[group_of_[items_[i].task]];
        result.queries += node.status == QueryStatus::not_run ? 0 : 1;
        node.is_covered =
            full == QueryStatus::ok &&
            (node.is_covered || (node.parent != kNoIndex && nodes_[node.parent].is_covered));
        if (!node.is_covered && node.status != QueryStatus::not_run) {
            result.status = full == QueryStatus::ok ? node.status : full;
        }
    }
}

/// Evaluates a stage. Its open boxes become the roots of the next: the unproven leaves or, for a
/// group that spent its share, the roots of this stage. Returns their number.
std::uint32_t StagedProver::leave_open(std::span<JointBoxResult> results,
                                       std::uint32_t roots) noexcept {
    const auto is_spent = [this](const BoxItem& item) {
        return full_[group_of_[item.task]] != QueryStatus::ok;
    };
    std::transform(groups_.begin(), groups_.begin() + group_count_, full_.begin(), first_full);
    cover(results);
    for (std::uint32_t i = 0; i < node_count_; ++i) {
        JointBoxResult& result = results[items_[i].task];
        const bool is_open = nodes_[i].is_leaf && !nodes_[i].is_covered && !is_spent(items_[i]);
        if (!is_open || result.proof != JointBoxProof::proven) {
            continue;
        }
        if (!nodes_[i].may_be_split || items_[i].widest_axis == kNoIndex) {
            result.proof =
                nodes_[i].may_be_split ? JointBoxProof::budget_spent : JointBoxProof::engine_failed;
            result.open = items_[i].box;
        }
    }
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < node_count_; ++i) {
        const bool is_left =
            is_spent(items_[i]) ? i < roots : nodes_[i].is_leaf && !nodes_[i].is_covered;
        if (is_left && results[items_[i].task].proof == JointBoxProof::proven) {
            items_[open++] = items_[i];
        }
    }
    return open;
}

/// A lost engine proves nothing in this cycle.
void StagedProver::lose(std::span<JointBoxResult> results) const noexcept {
    for (JointBoxResult& result : results) {
        if (result.proof != JointBoxProof::bad_box) {
            result.proof = JointBoxProof::engine_failed;
            result.status = lost_;
        }
    }
}

StagedWork StagedProver::prove(const Engine& engine, std::span<const JointBoxTask> tasks,
                               std::span<JointBoxResult> results, bool has_wider,
                               bool halves_wider) noexcept {
    AXG_ASSERT(results.size() >= tasks.size() && tasks.size() <= group_of_.size());
    AXG_ASSERT(!has_wider || tasks.size() % 2 == 0);
    const auto own = static_cast<std::uint32_t>(has_wider ? tasks.size() / 2 : tasks.size());
    StagedWork work;
    lost_ = QueryStatus::ok;
    query_count_ = 0;
    std::uint32_t open = boxes_->find_roots(tasks, results, items_);
    std::uint32_t depth_left = plan_.depth_max;
    const bool fits = open <= plan_.queries[0];
    for (std::uint32_t stage = 0; fits && stage < plan_.stages; ++stage) {
        const bool is_first = stage == 0;
        const Engine here = engine.of_stage(stage);
        if (asks_again(stage, plan_)) {
            if (open != 0 && !run_rounds(here, tasks, results, open, depth_left, work)) {
                lose(results.first(tasks.size()));
                return work;
            }
            continue;
        }
        const std::uint32_t depth =
            is_first ? 0 : std::min(depth_left, tree_depth(plan_.queries[stage], open, plan_.form));
        if (is_first ? open == 0 && known_answer_mesh_ == kNoIndex : depth == 0) {
            continue;  // a later stage may have enough queries for a level of all trees
        }
        depth_left -= depth;
        deal_groups(open, plan_.lists[stage]);
        if (is_first && has_wider && group_count_ != 0) {
            const std::uint32_t pairs = (group_count_ + 1) / 2;
            const WorkLists share =
                first_share_of(plan_.lists[0], pairs, plan_.stages == 1, has_wider);
            std::fill_n(groups_.begin(), group_count_, GroupWork{.share = share});
        }
        begin_round(open);
        ++work.stages;
        const bool is_last = stage + 1 == plan_.stages;
        if (asks_first_part_ && is_last && !is_first && group_count_ == 1 &&
            is_lost_by_first_part(engine.of_stage(stage - 1), tasks, results, depth, work)) {
            break;
        }
        if (lost_ != QueryStatus::ok ||
            !(is_first ? run_first(here, tasks, own, work)
                       : run_stage(here, tasks, results, depth, is_last, work))) {
            lose(results.first(tasks.size()));
            return work;
        }
        for (const GroupWork& group : groups_.first(group_count_)) {
            work.used = work.used + group.used;
        }
        open = leave_open(results, open);
        open = is_first && has_wider ? take_wider(results, own, open, halves_wider) : open;
    }
    for (const BoxItem& item : items_.first(open)) {
        JointBoxResult& result = results[item.task];
        if (result.proof == JointBoxProof::proven) {
            result.proof = JointBoxProof::budget_spent;
            result.open = item.box;
        }
    }
    if (has_wider && halves_wider) {
        take_proofs(results, own);
    }
    return work;
}

}  // namespace axg
