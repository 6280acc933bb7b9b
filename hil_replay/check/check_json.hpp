// SPDX-License-Identifier: Apache-2.0
// The document of `axguard check --json`, as text.
#pragma once

#include <string>

#include "core/machine/configuration_hashes.hpp"
#include "hil_replay/check/check_report.hpp"

namespace axg {

struct CheckedFile {
    const std::string &file, &configuration_sha256;
    const ConfigurationHashes& hashes;
    bool is_compiled = false;
};

/// @param report  after all its sections
[[nodiscard]] std::string describe_check(const CheckedFile& checked, const CheckReport& report);

}  // namespace axg
