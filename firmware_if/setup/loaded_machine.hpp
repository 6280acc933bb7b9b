// SPDX-License-Identifier: Apache-2.0
// A machine with its meshes, read from a machine file or from a compiled one, and everything proven
// about it that the machine file asks for.
#pragma once

#include <cstdio>
#include <functional>
#include <string>

#include "config/compiled/compiled_machine.hpp"

namespace axg {

/// `source` is the machine file, for a compiled machine too.
using LoadedMachine = CompiledMachine;

/// The line behind the faults of a machine file: their number, and what to do. Empty where there is
/// no such file.
[[nodiscard]] std::string fault_summary(const std::string& file, std::size_t faults);

/// Called now and then with the share that is done, 0 to 1, while travel proofs are made.
using LoadProgress = std::function<void(double share)>;

/// Reads the machine file, then the meshes it names; or a compiled machine, which needs no other
/// file. False after faults: prints all of them on `messages`, one a line, then their number;
/// `out` is untouched.
/// @param mesh_root  folder that the machine file's meshes are named from; empty: its own
[[nodiscard]] bool load(const std::string& file, const std::string& mesh_root, LoadedMachine& out,
                        std::FILE* messages, const LoadProgress& progress = {});

}  // namespace axg
