// SPDX-License-Identifier: Apache-2.0
// Functions of both kinds of `axguard drive`: with the guard in the process, and with --bus.
#pragma once

#include <cstdint>
#include <string>

#include "core/collision/containment.hpp"
#include "firmware_if/cli/json_output.hpp"
#include "firmware_if/cli/machine_options.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/drive/drive_report.hpp"
#include "hil_replay/gcode/gcode_arguments.hpp"
#include "hil_replay/gcode/gcode_reader.hpp"
#include "hil_replay/replay/page_samples.hpp"

namespace axg {

struct DriveArguments {
    MachineOptions machine;
    GcodeArguments gcode;
    std::string engine, mode = "stoppable", faults, csv, report, bus;
    bool obeys_cap = false, jogs_out = false, has_details = false;
    double advice_s = 60;
    std::uint64_t seed = 1;
    JsonOutput json;
};

/// Machine, options and program. An exit code where one of them is refused.
[[nodiscard]] int read_inputs(const DriveArguments& arguments, LoadedMachine& loaded,
                              DriveOptions& options, GcodeOptions& gcode, GcodeResult& reading);

/// 0: the program ran to its end, and nothing touched.
[[nodiscard]] int exit_code_of(const DriveArguments& arguments, const Machine& machine,
                               const DriveResult& result, bool has_contact);

/// From where the axes rest; and out, if so wished.
void look_for_ways_out(const DriveArguments& arguments, const LoadedMachine& loaded,
                       const ContainmentTest& containment_test, const DriveOptions& options,
                       DriveReport& report);

/// False: `--report` could not be written; the reason is printed.
[[nodiscard]] bool write_page(const DriveArguments& arguments, const LoadedMachine& loaded,
                              const DriveReport& report, const PageSamples& samples);

/// The head of the table of --csv up to the axes, and the columns of the axes of a line.
[[nodiscard]] std::string csv_head(const Machine& machine);
[[nodiscard]] std::string csv_axes(const Machine& machine, std::span<const double> positions);

/// `axguard drive --bus`.
[[nodiscard]] int run_bus_drive(const DriveArguments& arguments);

}  // namespace axg
