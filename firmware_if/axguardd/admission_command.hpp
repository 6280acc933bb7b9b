// SPDX-License-Identifier: Apache-2.0
// Admission, by itself (axguardd admit) and at the start of a guard.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "firmware_if/axguardd/admission_figures.hpp"
#include "firmware_if/axguardd/admission_record.hpp"

namespace axg {

class Command;
class CommandLine;

struct AdmissionOptions {
    double seconds = 2;
    std::vector<std::string> waived;  // names of checks that may fail
};
/// @param name  of the option
void add_seconds_option(const Command& command, const std::string& name, AdmissionOptions& options);

/// --mode, --engine and --state-dir: `run` and `admit` judge the same guard.
void add_guard_options(const Command& command, std::string& mode, std::string& engine,
                       std::string& state_dir);

/// --bus: a name that an interface can have. Files of the state folder are called after it.
void add_bus_option(const Command& command, std::string& bus);

/// Whether a guard may run live on this machine at all; prints each reason why not.
[[nodiscard]] bool may_run(const std::string& machine_file, const Machine& machine);

/// Removes the verdict of an earlier start. False: it still exists, and
/// the reason is in `messages`.
[[nodiscard]] bool forget_admission(const std::string& state_dir, const std::string& bus,
                                    std::FILE* messages);

struct Admission {
    AdmissionVerdict verdict;
    std::string document;  // as written
    bool is_written = false;
};
/// Measures, judges, and writes the verdict down.
[[nodiscard]] Admission admit(const AdmissionRun& run, const AdmissionOptions& options,
                              const AdmissionSubject& subject, const LoadedMachine& loaded,
                              LiveEngines& engines);

void add_admit(CommandLine& line);

}  // namespace axg
