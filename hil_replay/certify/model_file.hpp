// SPDX-License-Identifier: Apache-2.0
// A machine as the proofs about a program see it, in a file: joints, surfaces, pairs with margins,
// tools, exclusions. Source: docs/reference/certificate-file.md, "Model".
#pragma once

#include <string>

#include "hil_replay/certify/certify_tasks.hpp"

namespace axg {

/// The bytes of the file. The same machine gives the same bytes.
[[nodiscard]] std::string model_file(const LoadedMachine& loaded, const CertifyTasks& tasks);

}  // namespace axg
