// SPDX-License-Identifier: Apache-2.0
// The verdict of an admission, stored and printed: one file per interface next to the latch, which
// is there only while the newest start was judged.
#pragma once

#include <string>

#include "firmware_if/axguardd/admission.hpp"

namespace axg {

/// The guard that the verdict is about.
struct AdmissionSubject {
    std::string machine, configuration_sha256, bus, mode;
    std::string state_dir;
};

[[nodiscard]] std::string admission_path(const std::string& state_dir, const std::string& bus);

/// One line a check, and what to change.
/// @param only_failed  those that passed are left out
[[nodiscard]] std::string table_of(const AdmissionVerdict& verdict, bool only_failed);

}  // namespace axg
