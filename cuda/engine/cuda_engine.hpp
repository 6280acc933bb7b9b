// SPDX-License-Identifier: Apache-2.0
// The CUDA engine behind the one narrow interface (core/collision/engine.hpp). create() reserves
// all memory and lists it in the memory plan; none is allocated later. A batch of queries is one
// launch of a graph; the host polls its results in pinned memory with a deadline. Any device fault
// or late result ends the engine: from then on every result is not_proven. This header has no CUDA
// types: a build without a CUDA compiler has it too, and create() then reports an absent engine.
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
/// Launches a kernel for pairs of leaves (cuda/bench/leaf_kernels.hpp); returns a cudaError_t.
using LaunchLeaves = int (*)(const DeviceBuffers& buffers, const Launch& launch) noexcept;

}  // namespace cuda

/// The fault of every create() here in a build without a CUDA compiler.
inline constexpr const char* kNoCudaInThisBuild =
    "this build has no CUDA engine; build it where nvcc is on the path, or use --engine cpu";

struct CudaOptions {
    // Queries of one launch, at most 544: 512 of a stage and 2 of the known-answer test. Further
    // queries run in further launches.
    std::uint32_t queries_max = 514;
    // Lists of a launch with a clearance query (its time has no bound) or with groups (their shares
    // bound it). Other launches use the lists of Capacities::batch. An overflow makes all queries
    // of the launch not_proven.
    std::uint32_t level_pairs = 1U << 16U, leaf_pairs = 1U << 17U;
    std::uint32_t candidates = 4096;      // per query: pairs of triangles that may set a clearance
    std::uint32_t listed = 64;            // per query: touching pairs listed by ids, at most
    std::uint32_t multiprocessors = 0;    // size of the partition (a green context); 0: all
    std::uint32_t deadline_us = 100'000;  // of one launch, from its start to its last result
    cuda::LaunchLeaves launch_leaves = nullptr;  // for measurements; null: the engine's own kernel
};

/// Memory that the engine reserves, in bytes.
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
    /// Builds the trees, reserves all memory and runs one warm-up batch of each kind. Returns
    /// nothing without a device or after a CUDA error; `fault` then names the cause and the remedy.
    /// `capacities.batch` applies only to launches without clearance queries and groups. Unusable
    /// meshes occupy an index too; queries about them return bad_query.
    [[nodiscard]] static std::optional<CudaEngine> create(std::span<const Mesh* const> meshes,
                                                          const Capacities& capacities,
                                                          const CudaOptions& options,
                                                          std::string& fault);
    CudaEngine(CudaEngine&&) noexcept;
    CudaEngine& operator=(CudaEngine&&) = delete;
    ~CudaEngine();

    /// Each launch may use all of `capacities.batch`.
    void run(std::span<const Query> queries, std::span<QueryResult> results) noexcept;
    /// As `Engine::run_groups`: limited by the shares of the groups, not by capacities.
    void run(std::span<const Query> queries, std::span<QueryResult> results,
             std::span<GroupWork> groups) noexcept;
    /// As `Engine::run_parts`. Precondition: all are float-only, and at most `parts_max` in total.
    void run(const PartQueries& parts, std::span<const Query> queries,
             std::span<QueryResult> results, std::span<GroupWork> groups) noexcept;
    [[nodiscard]] std::uint32_t parts_max() const noexcept;
    /// The interface that the guard uses: one call per stage.
    [[nodiscard]] Engine engine() noexcept;

    /// Why the engine gave up; null while it works. A dead engine never recovers.
    [[nodiscard]] const char* fault() const noexcept;
    [[nodiscard]] const CudaMemoryPlan& memory() const noexcept;
    [[nodiscard]] const CudaDevice& device() const noexcept;
    /// The most levels of pairs of nodes that a query about two of its meshes opens.
    [[nodiscard]] std::uint32_t tree_levels() const noexcept;

    struct Parts;  // the implementation: cuda/engine/engine_parts.hpp, only for cuda/ and its tests
    [[nodiscard]] Parts& parts() noexcept { return *parts_; }

  private:
    explicit CudaEngine(std::unique_ptr<Parts> parts) noexcept;

    std::unique_ptr<Parts> parts_;
};

}  // namespace axg
