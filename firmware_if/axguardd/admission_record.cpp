// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/admission_record.hpp"

#include <fmt/format.h>

namespace axg {

std::string admission_path(const std::string& state_dir, const std::string& bus) {
    return state_dir + "/" + bus + ".admission.json";
}

std::string table_of(const AdmissionVerdict& verdict, bool only_failed) {
    std::string out;
    for (const AdmissionLine& line : verdict.lines) {
        if (line.is_passed && only_failed) {
            continue;
        }
        out += fmt::format("{:<5} {:<8} {}\n", line.is_passed ? "OK" : "BAD", to_text(line.check),
                           line.found);
        if (!line.mend.empty()) {
            out += fmt::format("{:<14} -> {}\n", "", line.mend);
        }
    }
    return out;
}

}  // namespace axg
