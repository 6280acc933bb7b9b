// SPDX-License-Identifier: Apache-2.0
// Texts of the faults of a surface: what was found, and what was expected.
#pragma once

#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "core/mesh/mesh_check.hpp"
#include "core/mesh/solid_of_revolution.hpp"
#include "core/mesh/stl.hpp"

namespace axg {

struct MeshFault {
    std::string got, wanted;
};

/// `file` as it is written in the machine file; control characters are escaped.
[[nodiscard]] MeshFault describe(const StlFault& fault, const std::string& file);
[[nodiscard]] MeshFault describe(const RevolutionResult& result, std::uint32_t segments);

/// Judges a report against what the machine file allows by name.
///
/// @param subject   what the messages call the surface: its file, or "the profile"
/// @param notes     out: allowed oddities, one sentence each
[[nodiscard]] std::vector<MeshFault> judge(const MeshReport& report, const MeshSource& source,
                                           const std::string& subject,
                                           std::vector<std::string>& notes);

/// Printable form of foreign text: control and non-ASCII bytes as \xNN.
[[nodiscard]] std::string printable(const std::string& text);

}  // namespace axg
