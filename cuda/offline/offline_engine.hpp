// SPDX-License-Identifier: Apache-2.0
// Batches of up to 65,536 queries on a GPU, offline: for tables, plans and proofs of a whole
// travel, where no cycle waits. Two kernels a batch: a thread a query makes the pose, a warp a
// query answers it, with the arithmetic of the cycle's engine. A query whose lists are full, or
// that is not of kind `farther`, is answered by the CPU engine instead, and counted. So results are
// as core/collision/engine.hpp promises, for the same capacities per query. A fault of the device
// ends the engine: from then on every result is not_run. No CUDA type is in this header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/certificate/posed_queries.hpp"
#include "core/collision/engine.hpp"
#include "core/machine/machine.hpp"
#include "core/mesh/mesh.hpp"
#include "cuda/engine/cuda_engine.hpp"

namespace axg {

inline constexpr std::uint32_t kOfflineQueriesMax = 1U << 16U;

struct OfflineOptions {
    std::uint32_t queries_max = kOfflineQueriesMax;  // of one batch
    // Batches under way at once: the host fills one and reads another while the device works.
    std::uint32_t batches = 2;
    std::uint32_t deadline_us = 10'000'000;  // of one batch
    bool measures = false;                   // fills OfflineWork's times of the device
};

/// Work and times of all calls so far. Times of the device overlap each other and the host's.
struct OfflineWork {
    std::uint64_t queries = 0, batches = 0, again = 0;  // again: answered by the CPU engine
    double fill_s = 0, launch_s = 0, wait_s = 0, check_s = 0, again_s = 0;  // of the host
    double to_device_s = 0, pose_s = 0, answer_s = 0, to_host_s = 0;        // if it measures
};

class OfflineEngine {
  public:
    /// Builds the trees and reserves all memory. Empty without a device, without a lane set for
    /// the CPU engine, or after a CUDA error; `fault` then names the cause.
    /// @param chains, pairs  of posed queries; empty: none are run
    [[nodiscard]] static std::optional<OfflineEngine> create(std::span<const Mesh* const> meshes,
                                                             const Capacities& capacities,
                                                             const MachineChains& chains,
                                                             std::span<const PosedPair> pairs,
                                                             const OfflineOptions& options,
                                                             std::string& fault);
    OfflineEngine(OfflineEngine&&) noexcept;
    OfflineEngine& operator=(OfflineEngine&&) = delete;
    ~OfflineEngine();

    /// results[i] belongs to queries[i]; any number of them.
    void run(std::span<const Query> queries, std::span<QueryResult> results) noexcept;
    /// The same, posed on the device.
    void run(const PosedQueries& posed, std::span<QueryResult> results) noexcept;
    /// For measurements: repeats the last batch of each slot on the device so many times, with both
    /// copies, and reads no answer. Returns its queries a second; 0 after a fault or before a call.
    [[nodiscard]] double repeat(std::uint32_t times) noexcept;
    /// Without groups.
    [[nodiscard]] Engine engine() noexcept;

    /// Why the engine gave up; null while it works. A dead engine never recovers.
    [[nodiscard]] const char* fault() const noexcept;
    [[nodiscard]] const OfflineWork& work() const noexcept;
    [[nodiscard]] const CudaDevice& device() const noexcept;
    [[nodiscard]] const CudaMemoryPlan& memory() const noexcept;

    struct Parts;  // the implementation: cuda/offline/offline_parts.hpp, only for cuda/ and tests
    [[nodiscard]] Parts& parts() noexcept { return *parts_; }

  private:
    explicit OfflineEngine(std::unique_ptr<Parts> parts) noexcept;

    std::unique_ptr<Parts> parts_;
};

}  // namespace axg
