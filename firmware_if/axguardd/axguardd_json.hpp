// SPDX-License-Identifier: Apache-2.0
// The documents that the commands of axguardd write with --json, as text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/time_histogram.hpp"
#include "firmware_if/axguardd/admission.hpp"

namespace axg {

struct AdmissionSubject;
struct LiveEnd;

/// @param waived  checks that may fail, by name
[[nodiscard]] std::string describe_admission(const AdmissionVerdict& verdict,
                                             const AdmissionFigures& figures,
                                             const AdmissionSubject& subject,
                                             const std::vector<std::string>& waived);

[[nodiscard]] std::string describe_findings(const std::vector<Finding>& findings);

struct LatencyReport {
    std::uint64_t count = 0;
    std::int64_t period_us = 0, fit_us = 0;
    const TimeHistogram& lateness;
    double rate = 1;  // at most so many of all are later, at 95 %
    bool is_fit = false;
    const std::vector<std::string>& refused;  // by the system: why
};
[[nodiscard]] std::string describe_latency(const LatencyReport& report);

struct RunSubject {
    const std::string &machine, &bus, &mode;
    bool compares_hashes = true;
};
[[nodiscard]] std::string describe_run(const RunSubject& subject, const LiveEnd& end);

}  // namespace axg
