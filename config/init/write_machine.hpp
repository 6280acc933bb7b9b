// SPDX-License-Identifier: Apache-2.0
// Writes a first machine file for a folder of meshes: it loads at once and marks each guessed line.
#pragma once

#include <string>
#include <vector>

#include "config/init/guess_roles.hpp"
#include "config/init/linuxcnc_ini.hpp"
#include "config/mesh/survey_mesh.hpp"

namespace axg {

/// Marks every line that a person still has to confirm; `axguard check` lists these lines.
inline constexpr const char* kGuessMark = "# GUESS";
/// Prefix of the placeholder reasons of exclusions.
inline constexpr const char* kReviewMark = "REVIEW:";

/// A pair that the file shall not check, and why; a < b.
struct ProposedExclusion {
    std::uint32_t a = 0, b = 0;  // of the roles
    std::string reason;
};

/// @param meshes  without faults, file names as the machine file shall contain them
/// @param roles   of exactly these meshes
/// @param ini     limits of axes; others are guessed. Axes that no body has are listed too. A
/// period
///                that it does not state leaves can.sample_us at its default
/// @param exclusions  the only pairs that are not checked; null: those that the roles suggest
/// @return        commented YAML; parse_machine() accepts it (two surfaces at least)
[[nodiscard]] std::string machine_file_text(
    const std::string& name, const std::vector<SurveyedMesh>& meshes,
    const std::vector<RoleGuess>& roles, const IniAxes& ini = {},
    const std::vector<ProposedExclusion>* exclusions = nullptr);

}  // namespace axg
