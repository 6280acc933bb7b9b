// SPDX-License-Identifier: Apache-2.0
// The verdict of an admission, written down and said: one file an interface beside the latch, which
// is there only while the newest start was judged.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "firmware_if/axguardd/admission.hpp"

namespace axg {

/// Whose verdict it is.
struct AdmissionSubject {
    std::string machine, configuration_sha256, bus, mode;
    std::string state_dir;
};

[[nodiscard]] std::string admission_path(const std::string& state_dir, const std::string& bus);

/// @param waived  checks that may fail, by name
[[nodiscard]] nlohmann::ordered_json describe(const AdmissionVerdict& verdict,
                                              const AdmissionFigures& figures,
                                              const AdmissionSubject& subject,
                                              const std::vector<std::string>& waived);

/// One line a check, and what to change.
/// @param only_failed  those that passed are left out
[[nodiscard]] std::string table_of(const AdmissionVerdict& verdict, bool only_failed);

}  // namespace axg
