// SPDX-License-Identifier: Apache-2.0
// The longest cycle of a plan on the CPU: every stage with as many queries as it may have, and
// every list of every group full to its last place, with entries that cause the most work. Replaces
// the machine's engine in a cycle that is otherwise real: the parts that pose queries, test
// containment and decide work as always, and this engine replaces each query by one over
// constructed trees. Source: docs/theory/certificate.md, "The longest cycle".
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

/// How the work of a group is distributed.
enum class CycleLayout : std::uint8_t {
    even,         // batches of triangles dealt out to all pairs of leaves
    heaped,       // in whole leaves, and rows in the clipping
    rows,         // in whole leaves, and rows in the opening: each moves a leaf of its own
    sparse,       // one pair to a pair of leaves, charged as a batch, and the rest in whole leaves
    overflowing,  // twice the size of the lists
};
inline constexpr std::array kCycleLayouts{CycleLayout::even, CycleLayout::heaped, CycleLayout::rows,
                                          CycleLayout::sparse, CycleLayout::overflowing};
[[nodiscard]] const char* name_of(CycleLayout layout) noexcept;

/// Names one of the cycles that fill a plan.
struct CycleShape {
    CycleLayout layout = CycleLayout::even;
    std::uint32_t tasks = 1;  // posed in the first stage
    bool asks_twice = false;  // and again with a longer permit, which proves none of them
    std::uint32_t open = 1;   // of them not proven there: groups of the second stage
    std::uint32_t kept = 1;   // of those, open after their repeat in the second of three stages
    std::uint32_t parts = 1;  // boxes of each that the second stage leaves to the third
};

/// Work of one stage, without the known-answer test.
struct StageWork {
    std::uint32_t queries = 0, groups = 0;
    WorkLists lists{};

    friend constexpr bool operator==(const StageWork&, const StageWork&) = default;
};
using CycleWork = std::array<StageWork, kStagesMax>;
[[nodiscard]] WorkLists sum_of(const CycleWork& work) noexcept;
[[nodiscard]] std::uint32_t queries_of(const CycleWork& work) noexcept;

/// Returns the shapes of every layout: 1, 4 and all groups, and the number with the most queries.
/// With three stages also each of these with the number of open parts that has the most queries,
/// and all groups, one of which stays open in the repeat.
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
    /// Empty, with `fault` set: inconsistent lists, no such lanes, or no memory.
    [[nodiscard]] static std::optional<LongestCycle> create(const CyclePlan& plan,
                                                            const CycleShape& wanted,
                                                            const Options& options,
                                                            std::string& fault);

    /// Before each cycle.
    void begin() noexcept;
    /// The object must not move after this call.
    [[nodiscard]] Engine engine() noexcept;

    /// The planned work; with an overflowing layout, the most work there is.
    [[nodiscard]] const CycleWork& planned() const noexcept { return planned_; }
    /// Work of the cycle since `begin`, as the engine charged it.
    [[nodiscard]] const CycleWork& done() const noexcept { return done_; }
    /// Whether the cycle posed other queries than planned: then its measurement is not valid.
    [[nodiscard]] bool is_other() const noexcept { return is_other_ || call_ != calls_.size(); }
    /// Whether the cycle posed the first `stages` stages as planned, and no others: another engine
    /// received the later ones.
    [[nodiscard]] bool did_stages(std::uint32_t stages) const noexcept;
    [[nodiscard]] std::string_view lanes() const noexcept { return engine_->lanes(); }
    /// The memory of all trees, as dense as in an engine.
    [[nodiscard]] std::span<const std::byte> trees() const noexcept { return tree_bytes_; }

  private:
    /// Queries of one stage that share its lists in the same way.
    struct Deal {
        std::uint32_t stage = 0, groups = 0, each = 0;  // each: queries of a group
        WorkLists share{};
    };
    struct Call {
        std::uint32_t stage = 0, count = 0;
        std::uint32_t groups = 0;  // with queries in this call
        std::size_t deal = 0;      // deals_
        bool ends_deal = false;
        bool is_first_part = false;         // a call for the first part of the last stage only
        WorkLists lists{};                  // of the first part, which has its own share
        std::vector<std::uint32_t> bodies;  // [count] the first of the two of each query
        std::vector<std::uint32_t> open;    // results to set to not proven
    };
    LongestCycle() = default;
    void plan_calls(const CyclePlan& plan, const CycleShape& shape, bool asks_first_part);
    [[nodiscard]] std::string make_queries(const CycleShape& shape, const Options& options);
    [[nodiscard]] bool place_trees();
    void run(std::span<const Query> queries, std::span<QueryResult> results,
             std::span<GroupWork> groups) noexcept;

    TreeBodies bodies_;  // until they are placed
    std::optional<Arena> arena_;
    std::span<const std::byte> tree_bytes_;
    std::vector<Tree> trees_;
    bool is_float_only_ = true;
    std::optional<CpuEngine> engine_;
    std::vector<Deal> deals_;
    std::vector<Call> calls_;
    std::uint32_t known_answer_mesh_ = 0, own_known_answer_mesh_ = 0;
    CycleWork planned_{}, done_{};
    std::size_t call_ = 0;
    bool is_other_ = false;
};

}  // namespace axg
