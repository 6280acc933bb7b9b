// SPDX-License-Identifier: Apache-2.0
// The CUDA engine behind the one narrow interface (core/collision/engine.hpp). Everything is
// reserved when it is made, printed by its memory plan, then sealed; a batch of queries is one
// launch of a graph, and its results are polled in pinned memory with a deadline. Any fault of the
// device, or a result that is late, ends the engine: from then on every result is not_proven. No
// CUDA type shows here, and a build without a CUDA compiler has this header too: create() then says
// so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/collision/engine.hpp"
#include "core/collision/query_tree.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"

namespace axg {

namespace cuda {

struct DeviceBuffers;
struct Launch;
/// Launches a kernel for pairs of leaves (cuda/bench/leaf_kernels.hpp); a cudaError_t.
using LaunchLeaves = int (*)(const DeviceBuffers& buffers, const Launch& launch) noexcept;

}  // namespace cuda

/// The fault of everything here in a build without a CUDA compiler.
inline constexpr const char* kNoCudaInThisBuild =
    "this build has no CUDA engine; build it where nvcc is on the path, or use --engine cpu";

struct CudaOptions {
    // Of one launch; more are run in turn. A stage's 512 and the known-answer test's, at most 544.
    std::uint32_t queries_max = 514;
    // Lists of a launch with a clearance query, whose time has no bound, or with groups, which
    // their shares bound; others have those of Capacities::batch. An overflow makes all queries of
    // the launch not_proven.
    std::uint32_t level_pairs = 1U << 16U, leaf_pairs = 1U << 17U;
    std::uint32_t candidates = 4096;      // a query: pairs of triangles that may set a clearance
    std::uint32_t listed = 64;            // a query: touching pairs told by name, at most
    std::uint32_t multiprocessors = 0;    // a partition of so many (a green context); 0: all
    std::uint32_t deadline_us = 100'000;  // of one launch, from its start to its last result
    cuda::LaunchLeaves launch_leaves = nullptr;  // of a measurement; null: the engine's own kernel
};

/// What the engine reserves, byte by byte.
struct CudaMemoryPlan {
    std::size_t trees_bytes = 0, lists_bytes = 0, pinned_bytes = 0;

    [[nodiscard]] std::size_t device_bytes() const noexcept { return trees_bytes + lists_bytes; }
};

struct CudaDevice {
    std::string name;
    unsigned multiprocessors = 0, multiprocessors_used = 0;
    int driver = 0, runtime = 0;  // as CUDA numbers them: 13000 is 13.0
    unsigned clock_khz = 0;
};

class CudaEngine {
  public:
    /// `capacities.batch` holds for launches that query proofs and counts alone.
    /// Builds the trees, reserves everything and runs a warm-up batch. Empty, with `fault` set:
    /// there is no device, or it refused; `fault` says what and what to do. Meshes that are not
    /// usable keep their index and return bad_query.
    [[nodiscard]] static std::optional<CudaEngine> create(std::span<const Mesh* const> meshes,
                                                          const Capacities& capacities,
                                                          const CudaOptions& options,
                                                          std::string& fault);
    CudaEngine(CudaEngine&&) noexcept;
    CudaEngine& operator=(CudaEngine&&) = delete;
    ~CudaEngine();

    /// Each launch has all that `capacities.batch` allows.
    void run(std::span<const Query> queries, std::span<QueryResult> results) noexcept;
    /// As `Engine::run_groups`: what shares allow, and no capacity.
    void run(std::span<const Query> queries, std::span<QueryResult> results,
             std::span<GroupWork> groups) noexcept;
    /// As `Engine::run_parts`. Precondition: all of them in float alone, at most `parts_max`.
    void run(const PartQueries& parts, std::span<const Query> queries,
             std::span<QueryResult> results, std::span<GroupWork> groups) noexcept;
    [[nodiscard]] std::uint32_t parts_max() const noexcept;
    /// As the guard sees it: a stage is a call.
    [[nodiscard]] Engine engine() noexcept;

    /// Why the engine gave up; null while it lives. Nothing revives it.
    [[nodiscard]] const char* fault() const noexcept;
    [[nodiscard]] const CudaMemoryPlan& memory() const noexcept;
    [[nodiscard]] const CudaDevice& device() const noexcept;
    /// Of pairs of nodes that two of its bodies may take to open.
    [[nodiscard]] std::uint32_t tree_levels() const noexcept;

    struct Parts;  // what lies behind; cuda/engine/engine_parts.hpp, for cuda/ and its tests alone
    [[nodiscard]] Parts& parts() noexcept { return *parts_; }

  private:
    explicit CudaEngine(std::unique_ptr<Parts> parts) noexcept;

    std::unique_ptr<Parts> parts_;
};

}  // namespace axg
