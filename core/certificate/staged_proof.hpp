// SPDX-License-Identifier: Apache-2.0
// Proves that pairs of bodies are farther apart than their margin everywhere in a joint box, in the
// stages of a plan: first all whole boxes, then the halving trees of open boxes, as deep as the
// plan's queries allow. The cuts of a box do not depend on results. So a stage is one call for an
// engine that prefers batches, and the same proof, box by box, for another. With three stages the
// second queries the open boxes once more and cuts them in a few rounds, on every engine.
// Source: docs/theory/certificate.md, "Stages and groups".
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/arena.hpp"
#include "core/certificate/box_queries.hpp"
#include "core/certificate/joint_box_proof.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/cycle_work.hpp"
#include "core/machine/machine.hpp"

namespace axg {

/// Work of one call of `prove`, total of all tasks.
struct StagedWork {
    std::uint32_t stages = 0, calls = 0, queries = 0;  // without those of the known-answer test
    // `queries` plus those skipped when the first part failed. Skips depend on the engine; the
    // budget of the advisories must not.
    std::uint32_t planned_queries = 0;
    std::uint32_t batches = 0;                 // calls of an engine that prefers them
    std::uint16_t known_answer_signature = 0;  // kKnownAnswerSignature: correct in every call
    WorkLists used{};                          // by all groups except the known-answer test's
};

/// Whether the last stage may query the first part alone, for all pairs of a machine or for none:
/// the longest cycle has to include that query.
[[nodiscard]] bool asks_first_part(const Machine& machine, const CyclePlan& plan) noexcept;

class StagedProver {
  public:
    /// Reserves memory for at most `tasks` tasks per call. Empty: not enough memory.
    /// @param known_answer_mesh  kNoIndex: no known-answer test
    [[nodiscard]] static std::optional<StagedProver> create(const Machine& machine,
                                                            std::uint32_t tasks,
                                                            const CyclePlan& plan,
                                                            std::uint32_t known_answer_mesh);

    /// results[i] belongs to tasks[i]. Precondition: at most the number passed to `create`.
    /// Cost: at most the plan's queries and lists in each stage; with `has_wider` those of the
    /// first stage twice; with three stages one more query for each task open after the first.
    /// @param has_wider  the second half of the tasks are those of the first over larger boxes.
    ///     Stage 1 queries each of them whole, once; its proof also proves the task of the first
    /// @param halves_wider  if stage 1 leaves no task of the first half open, the later stages
    ///     halve the larger boxes that it left open, with the same bounds
    StagedWork prove(const Engine& engine, std::span<const JointBoxTask> tasks,
                     std::span<JointBoxResult> results, bool has_wider = false,
                     bool halves_wider = false) noexcept;

    [[nodiscard]] std::size_t memory_bytes() const noexcept { return arena_.size(); }

  private:
    /// State of the item at the same index.
    struct Node {
        std::uint32_t parent;  // kNoIndex: open at the start of the stage
        QueryStatus status;    // of its own query; not_run: it had none
        bool is_leaf;          // it has no parts with queries of their own
        bool is_covered;       // far, or part of a proven box
        bool may_be_split;     // if not covered
    };

    /// State of a group in the stage of several rounds.
    struct GroupRounds {
        std::uint32_t open, queries;  // open boxes; remaining queries
        bool is_done;                 // no more halving
    };

    StagedProver(const CyclePlan& plan, std::uint32_t known_answer_mesh, Arena arena) noexcept
        : plan_(plan), known_answer_mesh_(known_answer_mesh), arena_(static_cast<Arena&&>(arena)) {}
    void deal_groups(std::uint32_t open, const WorkLists& lists) noexcept;
    void begin_round(std::uint32_t open) noexcept;
    void grow_level(std::span<const JointBoxTask> tasks, std::uint32_t begin,
                    bool is_lazy) noexcept;
    void ask(std::span<const JointBoxTask> tasks, std::uint32_t first,
             std::uint32_t count) noexcept;
    [[nodiscard]] std::span<Query> add_known_answer() noexcept;
    void judge_known_answer(const Engine& engine, std::uint32_t count, StagedWork& work) noexcept;
    void note(QueryStatus status) noexcept;
    [[nodiscard]] bool end_call(const Engine& engine, std::uint32_t queries,
                                StagedWork& work) noexcept;
    [[nodiscard]] bool run(const Engine& engine, StagedWork& work) noexcept;
    [[nodiscard]] bool plan_parts(std::span<const JointBoxTask> tasks, std::uint32_t roots,
                                  std::uint32_t depth) noexcept;
    [[nodiscard]] bool is_lost_by_first_part(const Engine& engine,
                                             std::span<const JointBoxTask> tasks,
                                             std::span<JointBoxResult> results, std::uint32_t depth,
                                             StagedWork& work) noexcept;
    [[nodiscard]] bool run_parts(const Engine& engine, std::span<const JointBoxTask> tasks,
                                 std::span<JointBoxResult> results, bool is_last,
                                 StagedWork& work) noexcept;
    [[nodiscard]] bool run_stage(const Engine& engine, std::span<const JointBoxTask> tasks,
                                 std::span<JointBoxResult> results, std::uint32_t depth,
                                 bool is_last, StagedWork& work) noexcept;
    [[nodiscard]] bool run_again(const Engine& engine, std::span<const JointBoxTask> tasks,
                                 std::span<JointBoxResult> results, std::uint32_t& open,
                                 StagedWork& work) noexcept;
    [[nodiscard]] bool plan_round(std::uint32_t open) noexcept;
    [[nodiscard]] bool run_rounds(const Engine& engine, std::span<const JointBoxTask> tasks,
                                  std::span<JointBoxResult> results, std::uint32_t& open,
                                  std::uint32_t& depth_left, StagedWork& work) noexcept;
    [[nodiscard]] bool run_first(const Engine& engine, std::span<const JointBoxTask> tasks,
                                 std::uint32_t own, StagedWork& work) noexcept;
    [[nodiscard]] std::uint32_t take_wider(std::span<JointBoxResult> results, std::uint32_t own,
                                           std::uint32_t open, bool halves_wider) const noexcept;
    void cover(std::span<JointBoxResult> results) noexcept;
    void lose(std::span<JointBoxResult> results) const noexcept;
    std::uint32_t leave_open(std::span<JointBoxResult> results, std::uint32_t roots) noexcept;

    CyclePlan plan_;
    std::uint32_t known_answer_mesh_;
    bool asks_first_part_ = false;
    Arena arena_;
    BoxQueries* boxes_ = nullptr;        // in the arena
    std::span<BoxItem> items_;           // a stage's trees, level by level
    std::span<Node> nodes_;              // likewise
    std::span<std::uint32_t> asked_;     // the node of each query
    std::span<Query> queries_;           // plus two for the known-answer test
    std::span<QueryResult> results_;     // likewise
    std::span<GroupWork> groups_;        // [tasks] plus the known-answer test's
    std::span<QueryStatus> full_;        // [tasks] of each group, at the end of a stage
    std::span<std::uint32_t> group_of_;  // [tasks]
    std::span<GroupRounds> rounds_;      // [tasks] of each group
    std::span<WorkLists> left_;          // [tasks] the unused part of each share
    std::span<QueryTree> trees_;         // [kQueryTreesMax] of a stage that an engine poses
    std::span<BoxQueries::TreePlan> tree_plans_;  // likewise
    std::span<TreeRoot> roots_;                   // [queries] likewise
    PartQueries parts_;
    QueryStatus lost_ = QueryStatus::ok;  // status of a lost engine in this cycle
    std::uint32_t node_count_ = 0, query_count_ = 0, group_count_ = 0;
};

}  // namespace axg
