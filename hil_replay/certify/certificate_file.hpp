// SPDX-License-Identifier: Apache-2.0
// A proof of a program's path as a file, and back. Source: docs/reference/certificate-file.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hil_replay/certify/prove_program.hpp"
#include "hil_replay/certify/section_file.hpp"

namespace axg {

/// Sums of everything a certificate depends on, by name, in the order of the file.
using CertificateSources = std::vector<std::pair<std::string, Sha256>>;

/// The bytes of the file.
/// @param version  of axguard
[[nodiscard]] std::string certificate_file(const Machine& machine, const ChordPath& path,
                                           const ProgramProof& proof,
                                           const CertificateSources& sources,
                                           const std::string& version);

struct ReadCertificate {
    std::string version;
    StopPromise promise = StopPromise::independent;
    bool is_partial = false;
    CertificateSources sources;
    ChordPath path;
    std::vector<std::vector<ProvenStretch>> tasks;
};
/// Reads what certificate_file() wrote. Judges sums and lengths, not proofs: that is the task of
/// a checker. Empty: no such file.
[[nodiscard]] std::optional<ReadCertificate> read_certificate(std::string_view file);

}  // namespace axg
