// SPDX-License-Identifier: Apache-2.0
// The pairs that a certificate of a program is about: each with each tool, and with unpruned
// surfaces, so that a proof about them depends on nothing else.
#pragma once

#include <cstdint>
#include <vector>

#include "core/certificate/joint_box_proof.hpp"
#include "core/certificate/joint_path.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/setup/surface_list.hpp"

namespace axg {

struct CertifyTask {
    JointBoxTask task;
    std::uint32_t pair = 0, tool = kNoIndex;  // of the machine
    const Mesh *surface_a = nullptr, *surface_b = nullptr;
    const Mesh *whole_a = nullptr, *whole_b = nullptr;  // for containment
};

/// All pairs of a machine, in its order, each with each tool.
struct CertifyTasks {
    std::vector<BodyExtent> extents;  // [surfaces]
    std::vector<CertifyTask> tasks;
};
/// `loaded` must outlive it.
[[nodiscard]] CertifyTasks certify_tasks(const LoadedMachine& loaded);

}  // namespace axg
