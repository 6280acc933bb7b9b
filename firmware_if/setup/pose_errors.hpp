// SPDX-License-Identifier: Apache-2.0
// The stated errors of joints and places as what they cost each pair, and what each costs the pair
// that pays most.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/text/config_fault.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {

/// For the machine's pairs, with the whole surfaces; the dearest tool counts. No errors stated: {}.
[[nodiscard]] PoseErrors find_pose_errors(const Machine& machine, const MachineMeshes& meshes);

/// One for each pair whose errors, with its simplified surfaces, are more than engines accept.
[[nodiscard]] std::vector<ConfigFault> pose_error_faults(const LoadedMachine& loaded);

struct PoseErrorPart {
    std::string key;  // "bodies.c.pivot_error_mm"
    double mm = 0;
};
struct WorstPoseError {
    std::uint32_t pair = 0;
    double mm = 0;
    std::vector<PoseErrorPart> parts;  // the dearest first; each by itself
};
/// Precondition: the machine has pairs and states errors.
[[nodiscard]] WorstPoseError worst_pose_error(const LoadedMachine& loaded);

}  // namespace axg
