// SPDX-License-Identifier: Apache-2.0
// The CPU engine: the 32-wide trees traversed with the widest float lanes the processor has.
// Reference for the other engines, fallback, and the engine of hosts without a GPU. One arena,
// sealed; nothing allocates in a query.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/arena.hpp"
#include "core/collision/engine.hpp"
#include "core/collision/lane_kernels.hpp"
#include "core/collision/tree.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

enum class LaneSet : std::uint8_t { widest, avx512, avx2, neon };

/// Memory that an engine reserves for its meshes, in bytes.
struct MemoryPlan {
    std::size_t trees_bytes = 0, lists_bytes = 0;

    [[nodiscard]] std::size_t total_bytes() const noexcept { return trees_bytes + lists_bytes; }
};

class CpuEngine {
  public:
    /// Builds the trees and reserves everything. A mesh without triangles, or with a
    /// coordinate that is not finite or beyond kCoordinateMmMax, still has its index, and its
    /// queries return bad_query. Empty: this processor lacks the lane set (message: kNoLaneSet),
    /// or memory ran out.
    [[nodiscard]] static std::optional<CpuEngine> create(std::span<const Mesh* const> meshes,
                                                         const Capacities& capacities,
                                                         LaneSet lanes = LaneSet::widest);

    /// Over trees that come from no mesh; they must outlive the engine. Empty as above.
    [[nodiscard]] static std::optional<CpuEngine> over_trees(std::span<const Tree> trees,
                                                             const Capacities& capacities,
                                                             LaneSet lanes = LaneSet::widest);

    CpuEngine(CpuEngine&&) noexcept = default;

    void run(std::span<const Query> queries, std::span<QueryResult> results) noexcept;
    /// As `Engine::run_groups`.
    void run(std::span<const Query> queries, std::span<QueryResult> results,
             std::span<GroupWork> groups) noexcept;
    /// For tests: calls with groups make no early exit, and charge as much as an engine without
    /// early exits. No capacity bounds their work then.
    void set_counts_all(bool counts_all) noexcept { lists_.counts_all = counts_all; }
    [[nodiscard]] Engine engine() noexcept;
    [[nodiscard]] const MemoryPlan& memory() const noexcept { return memory_plan_; }
    [[nodiscard]] std::string_view lanes() const noexcept { return kernels_->name; }
    [[nodiscard]] std::span<const Tree> trees() const noexcept { return trees_; }

  private:
    CpuEngine(Arena arena, const LaneKernels* kernels) noexcept;
    void take_lists(const Capacities& capacities) noexcept;

    Arena arena_;
    const LaneKernels* kernels_;
    MemoryPlan memory_plan_;
    std::span<Tree> trees_;
    TraversalLists lists_;
};

/// Whether this processor and build can run the lane set.
[[nodiscard]] bool has_lane_set(LaneSet lanes) noexcept;

/// The kernels of a lane set, for queries about bare pairs of triangles. Null where this
/// processor or build lacks it.
[[nodiscard]] const LaneKernels* lane_kernels(LaneSet lanes) noexcept;

/// Message if the processor supports none of them.
inline constexpr std::string_view kNoLaneSet =
    "this processor has neither AVX2 with FMA nor AArch64 Advanced SIMD: the certified test needs "
    "fused multiply-add; run axguard on a processor from 2013 (x86-64) or any AArch64";

}  // namespace axg
