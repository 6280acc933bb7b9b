// SPDX-License-Identifier: Apache-2.0
// The result of `axguard certify`: on one screen, and as a document.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

#include "hil_replay/certify/prove_program.hpp"

namespace axg {

struct CertifyReport {
    const Machine& machine;
    const CertifyTasks& tasks;
    const ChordPath& path;
    const ProgramProof& proof;
    std::string program{}, certificate{}, model{};  // files; empty: not written
    std::string model_sha256{};
    std::uint32_t override_percent = 100;
    bool covers_lower = true;  // lower overrides take the same path
    std::uint64_t certificate_bytes = 0;
    double spent_s = 0;
};

void print_certify(const CertifyReport& report, std::FILE* out);
[[nodiscard]] std::string describe_certify(const CertifyReport& report);

/// "12" or "12-15".
[[nodiscard]] std::string lines_text(const ChordPath& path, const OpenStretch& open);
/// "cutter (tool 3) and table".
[[nodiscard]] std::string pair_text(const Machine& machine, const CertifyTask& task);
/// The axes in the middle of the box, mm and degrees: "X 1.000 A 30.000".
[[nodiscard]] std::string position_text(const Machine& machine, const UnitBox& box);

}  // namespace axg
