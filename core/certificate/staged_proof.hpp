// SPDX-License-Identifier: Apache-2.0
// Proves that pairs of bodies keep their margin everywhere in a joint box, in the stages of a plan:
// first all whole boxes, then the halving trees of those left open, as deep as the plan's queries
// fit. How a box is cut is known before any result, so a stage is one call for an engine that
// prefers batches, and the same proof, box by box, for one that does not.
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

/// What a call of `prove` came to, all tasks together.
struct StagedWork {
    std::uint32_t stages = 0, calls = 0, queries = 0;  // the known-answer test's do not count
    // And those that a lost task left out: how many that are is a matter of the engine, and what
    // advisories may ask is not.
    std::uint32_t planned_queries = 0;
    std::uint32_t batches = 0;                 // calls of an engine that prefers them
    std::uint16_t known_answer_signature = 0;  // kKnownAnswerSignature: right in every call
    WorkLists used{};                          // of every group but the known-answer test's
};

/// Whether the first part of the last stage may be asked alone, of a machine's every pair or none:
/// the longest cycle has to have it.
[[nodiscard]] bool asks_first_part(const Machine& machine, const CyclePlan& plan) noexcept;

class StagedProver {
  public:
    /// Reserves everything for at most `tasks` tasks at a time. Empty: not that much memory.
    /// @param known_answer_mesh  kNoIndex: no known-answer test
    [[nodiscard]] static std::optional<StagedProver> create(const Machine& machine,
                                                            std::uint32_t tasks,
                                                            const CyclePlan& plan,
                                                            std::uint32_t known_answer_mesh);

    /// results[i] belongs to tasks[i]. Precondition: at most the number passed to `create`.
    /// Cost: at most the plan's queries and lists, stage by stage; those of the first stage once
    /// more where `has_wider`.
    /// @param has_wider  the second half of the tasks are those of the first over larger boxes.
    ///     Each is queried whole, once, in the first stage; proven, it is the first one's proof too
    /// @param halves_wider  where the first stage leaves none of the first half open, the larger
    ///     boxes that it leaves open have the stages behind it, with the same bounds
    StagedWork prove(const Engine& engine, std::span<const JointBoxTask> tasks,
                     std::span<JointBoxResult> results, bool has_wider = false,
                     bool halves_wider = false) noexcept;

    [[nodiscard]] std::size_t memory_bytes() const noexcept { return arena_.size(); }

  private:
    /// Of the item in its place.
    struct Node {
        std::uint32_t parent;  // kNoIndex: open when the stage began
        QueryStatus status;    // of its own query; not_run: there was none
        bool is_leaf;          // nothing of it is queried by itself
        bool is_covered;       // far, or proven with what it is a part of
        bool may_be_split;     // if it is not
    };

    StagedProver(const CyclePlan& plan, std::uint32_t known_answer_mesh, Arena arena) noexcept
        : plan_(plan), known_answer_mesh_(known_answer_mesh), arena_(static_cast<Arena&&>(arena)) {}
    void deal_groups(std::uint32_t open) noexcept;
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
    [[nodiscard]] bool run_first(const Engine& engine, std::span<const JointBoxTask> tasks,
                                 std::uint32_t own, StagedWork& work) noexcept;
    [[nodiscard]] std::uint32_t take_wider(std::span<JointBoxResult> results, std::uint32_t own,
                                           std::uint32_t open, bool halves_wider) const noexcept;
    void cover(std::span<JointBoxResult> results) noexcept;
    std::uint32_t leave_open(std::span<JointBoxResult> results, std::uint32_t roots) noexcept;

    CyclePlan plan_;
    std::uint32_t known_answer_mesh_;
    bool asks_first_part_ = false;
    Arena arena_;
    BoxQueries* boxes_ = nullptr;        // in the arena
    std::span<BoxItem> items_;           // a stage's trees, level by level
    std::span<Node> nodes_;              // likewise
    std::span<std::uint32_t> asked_;     // which node a query is about
    std::span<Query> queries_;           // and two of the known-answer test
    std::span<QueryResult> results_;     // likewise
    std::span<GroupWork> groups_;        // [tasks] and the known-answer test's
    std::span<QueryStatus> full_;        // [tasks] of each group, when a stage is judged
    std::span<std::uint32_t> group_of_;  // [tasks]
    std::span<QueryTree> trees_;         // [kQueryTreesMax] of a stage that an engine poses
    std::span<BoxQueries::TreePlan> tree_plans_;  // likewise
    std::span<TreeRoot> roots_;                   // [queries] likewise
    PartQueries parts_;
    QueryStatus lost_ = QueryStatus::ok;  // what an engine that is lost said in this cycle
    std::uint32_t node_count_ = 0, query_count_ = 0, group_count_ = 0;
};

}  // namespace axg
