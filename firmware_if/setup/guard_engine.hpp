// SPDX-License-Identifier: Apache-2.0
// Creates the engines over a machine's surfaces (firmware_if/setup/surface_list.hpp), and the parts
// that use them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/certificate/stop_certificate.hpp"
#include "core/collision/containment.hpp"
#include "core/collision/cpu_engine.hpp"
#include "cuda/engine/cuda_engine.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// Empty: this processor has no lane set (kNoLaneSet), or memory ran out.
[[nodiscard]] std::optional<CpuEngine> make_engine(const LoadedMachine& loaded);

/// The engine on a GPU over the same surfaces. Empty: the reason is in `fault`.
/// @param multiprocessors  size of the GPU partition (CudaOptions); 0: all
[[nodiscard]] std::optional<CudaEngine> make_gpu_engine(const LoadedMachine& loaded,
                                                        std::string& fault,
                                                        std::uint32_t multiprocessors = 0);

/// Upper bound of the tree levels in a traversal of two of the machine's surfaces.
[[nodiscard]] std::uint32_t tree_levels_of(const LoadedMachine& loaded);

/// Tests the whole surfaces, on the trees of `engine`, which must outlive it. Empty: memory
/// ran out.
/// @param engine  of make_engine
[[nodiscard]] std::optional<ContainmentTest> make_containment_test(const LoadedMachine& loaded,
                                                                   const CpuEngine& engine);
inline constexpr std::string_view kNoMemoryForContainment =
    "out of memory for the containment test. Close other programs, or use coarser meshes.";

/// The certificate of the always-stoppable mode, for these frames and surfaces. Empty: memory ran
/// out.
[[nodiscard]] std::optional<StopCertificate> make_stop_certificate(
    const LoadedMachine& loaded, const std::optional<CyclePlan>& plan = {});
inline constexpr std::string_view kNoMemoryForProofs =
    "out of memory for the proofs of joint boxes. State fewer cycle.queries.";

}  // namespace axg
