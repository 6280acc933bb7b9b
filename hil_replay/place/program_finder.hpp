// SPDX-License-Identifier: Apache-2.0
// The lines of a program that a recorded trace ran, found by matching its positions with the
// program's path: for a trace without a table of them. docs/guide/report.md.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "core/machine/machine.hpp"
#include "firmware_if/receiver/axis_receiver.hpp"
#include "hil_replay/gcode/gcode_arguments.hpp"
#include "hil_replay/place/path_match.hpp"
#include "hil_replay/trace/program_lines.hpp"

namespace axg {

class ProgramFinder {
  public:
    /// Arguments and machine must outlive it.
    ProgramFinder(const GcodeArguments& arguments, const Machine& machine, ProgramSettings settings)
        : arguments_(arguments), machine_(machine), settings_(std::move(settings)) {}

    /// Checks the options and the program's file, before the first sample. False: stderr has the
    /// fault.
    [[nodiscard]] bool open();
    /// In order of time. The program starts at the first one, unless --start is passed.
    void add(const AxisSnapshot& snapshot);
    /// After the last sample: without steps where nothing matched, or the program was rejected.
    /// stderr has how much matched.
    [[nodiscard]] ProgramLines finish();
    /// The program could not be used: stderr has the reason.
    [[nodiscard]] bool is_rejected() const noexcept { return is_read_ && !match_; }

  private:
    void read(const AxisSnapshot& first);

    const GcodeArguments& arguments_;
    const Machine& machine_;
    const ProgramSettings settings_;
    GcodeOptions options_;
    std::string text_;
    bool is_read_ = false;
    std::optional<PathMatch> match_;
};

}  // namespace axg
