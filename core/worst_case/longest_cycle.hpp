// SPDX-License-Identifier: Apache-2.0
// The longest cycle of a plan on the CPU: every stage with as many queries as it may have, and
// every list of every group full to its last place, with entries that take the longest way. Stands
// in for the machine's engine in a cycle that is otherwise real: who poses, tests containment and
// decides does what it always does, and each query that it poses is replaced by one over trees
// made by hand. Source: docs/theory/certificate.md, "The longest cycle".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/arena.hpp"
#include "core/collision/cpu_engine.hpp"
#include "core/collision/engine.hpp"
#include "core/collision/tree.hpp"
#include "core/machine/cycle_work.hpp"

namespace axg {

/// How the work of a group lies.
enum class CycleLayout : std::uint8_t {
    even,         // batches of triangles dealt out to all pairs of leaves
    heaped,       // in whole leaves, and rows in the clipping
    rows,         // in whole leaves, and rows in the opening: each moves a leaf of its own
    sparse,       // one pair to a pair of leaves, charged as a batch, and the rest in whole leaves
    overflowing,  // twice what the lists hold
};
inline constexpr std::array kCycleLayouts{CycleLayout::even, CycleLayout::heaped, CycleLayout::rows,
                                          CycleLayout::sparse, CycleLayout::overflowing};
[[nodiscard]] const char* name_of(CycleLayout layout) noexcept;

/// Which of the cycles that fill a plan.
struct CycleShape {
    CycleLayout layout = CycleLayout::even;
    std::uint32_t tasks = 1;  // posed in the first stage
    bool asks_twice = false;  // and again with a longer permit, which proves none of them
    std::uint32_t open = 1;   // of them not proven there: groups of the second stage
    std::uint32_t parts = 1;  // boxes of each that the second stage leaves to the third
};

/// What one stage came to, known-answer test apart.
struct StageWork {
    std::uint32_t queries = 0, groups = 0;
    WorkLists lists{};

    friend constexpr bool operator==(const StageWork&, const StageWork&) = default;
};
using CycleWork = std::array<StageWork, kStagesMax>;
[[nodiscard]] WorkLists sum_of(const CycleWork& work) noexcept;
[[nodiscard]] std::uint32_t queries_of(const CycleWork& work) noexcept;

/// Whatever the layout: groups 1, 4, all, and as many as make most queries; in three stages the
/// same once more with as many open parts as make most queries.
[[nodiscard]] std::vector<CycleShape> cycle_shapes(const CyclePlan& plan, std::uint32_t tasks,
                                                   bool asks_twice = false);

class LongestCycle {
  public:
    struct Options {
        std::uint32_t known_answer_mesh = 0;  // as the queries name it
        std::size_t memory_bytes = 0;  // of trees that queries do not share, at least one of a kind
        bool is_float_only = true;
        bool asks_first_part = false;  // asks_first_part (core/certificate/staged_proof.hpp)
        LaneSet lanes = LaneSet::widest;
    };
    /// Empty, with `fault` set: lists that do not go together, no such lanes, or no memory.
    [[nodiscard]] static std::optional<LongestCycle> create(const CyclePlan& plan,
                                                            const CycleShape& wanted,
                                                            const Options& options,
                                                            std::string& fault);

    /// Before each cycle.
    void begin() noexcept;
    /// It must stay where it is.
    [[nodiscard]] Engine engine() noexcept;

    /// What it was made for; of an overflowing layout, what there is at most.
    [[nodiscard]] const CycleWork& planned() const noexcept { return planned_; }
    /// Of the cycle since `begin`, as the engine charged it.
    [[nodiscard]] const CycleWork& done() const noexcept { return done_; }
    /// The cycle asked for other queries than the plan allows for: what was measured is not it.
    [[nodiscard]] bool is_other() const noexcept { return is_other_ || call_ != calls_.size(); }
    /// Whether it asked for the first stages as planned, and for no other: those behind them went
    /// to another engine.
    [[nodiscard]] bool did_stages(std::uint32_t stages) const noexcept;
    [[nodiscard]] std::string_view lanes() const noexcept { return engine_->lanes(); }
    /// All trees, as close together as an engine has its own.
    [[nodiscard]] std::span<const std::byte> trees() const noexcept { return tree_bytes_; }

  private:
    struct Call {
        std::uint32_t stage = 0, count = 0;
        std::uint32_t groups = 0;  // that it asks of
        bool ends_stage = false;
        bool is_first_part = false;         // of the last stage, asked alone
        WorkLists lists{};                  // of that: it has a share of its own
        std::vector<std::uint32_t> bodies;  // [count] the first of the two of each query
        std::vector<std::uint32_t> open;    // which results say not proven
    };
    LongestCycle() = default;
    void plan_calls(const CyclePlan& plan, const CycleShape& shape, bool asks_first_part);
    [[nodiscard]] std::string make_queries(const CyclePlan& plan, const CycleShape& shape,
                                           const Options& options);
    [[nodiscard]] bool place_trees();
    void run(std::span<const Query> queries, std::span<QueryResult> results,
             std::span<GroupWork> groups) noexcept;

    TreeBodies bodies_;  // until they are placed
    std::optional<Arena> arena_;
    std::span<const std::byte> tree_bytes_;
    std::vector<Tree> trees_;
    bool is_float_only_ = true;
    std::optional<CpuEngine> engine_;
    std::vector<Call> calls_;
    std::uint32_t known_answer_mesh_ = 0, own_known_answer_mesh_ = 0;
    CycleWork planned_{}, done_{};
    std::size_t call_ = 0;
    bool is_other_ = false;
};

}  // namespace axg
