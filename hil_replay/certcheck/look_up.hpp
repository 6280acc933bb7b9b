// SPDX-License-Identifier: Apache-2.0
// Positions of a table looked up in a certificate's tube.
#pragma once

#include <string>
#include <vector>

#include "hil_replay/certcheck/certificate.hpp"

namespace axg::certcheck {

struct LookUp {
    std::uint64_t positions = 0, outside = 0;
    std::uint64_t first_outside = 0;  // line of the table
};

/// Looks each position up in the tubes of segments that are in no hole.
/// @throws Refusal 12 for a table that does not name every axis, or has no number for one
[[nodiscard]] LookUp look_up(const std::string& name, const std::string& table, const Model& model,
                             const Certificate& certificate, const std::vector<bool>& is_hole);

}  // namespace axg::certcheck
