// SPDX-License-Identifier: Apache-2.0
// The documents of `axguard-lab bench --json`, as text; for --paper see paper_benchmark.hpp.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "cuda/bench/measure_worst_case.hpp"
#include "cuda/engine/cuda_engine.hpp"
#include "firmware_if/setup/measure_cycle.hpp"
#include "hil_replay/lab/bench/offline_benchmark.hpp"
#include "hil_replay/lab/bench/pose_benchmark.hpp"

namespace axg {

struct SceneMeasurement {
    std::vector<double> cycle_us;
    std::size_t per_cycle = 0, far = 0, not_ok = 0;  // queries; results of all cycles
    std::optional<CudaDevice> device;
    CudaMemoryPlan memory;
    std::string lanes;
};

/// @param kind  of the queries: hit, count or clearance
[[nodiscard]] std::string describe_scene(const SceneMeasurement& m, const std::string& kind);

/// @param passes  number of passes; m.us is their least time
[[nodiscard]] std::string describe_poses(const PoseMeasurement& m, std::uint32_t passes);

/// Measured with one kernel for pairs of leaves (cuda/bench/leaf_kernels.hpp).
struct NamedMeasurement {
    std::string name;
    WorstCaseMeasurement measured;
};

/// One document; several measurements become its columns.
[[nodiscard]] std::string describe_worst_case(const std::vector<NamedMeasurement>& all);

[[nodiscard]] std::string describe_offline(const OfflineMeasurement& m);

[[nodiscard]] std::string describe_cycles(const CycleMeasurement& m);

}  // namespace axg
