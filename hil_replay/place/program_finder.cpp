// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/place/program_finder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "config/text/quote_text.hpp"

namespace axg {

bool ProgramFinder::open() {
    return make_gcode_options(arguments_, machine_, settings_, options_) &&
           read_program_text(arguments_.program, text_);
}

void ProgramFinder::read(const AxisSnapshot& first) {
    is_read_ = true;
    if (arguments_.start.empty()) {
        std::copy_n(first.position.begin(), machine_.axes.size(), options_.start.begin());
    }
    const GcodeResult reading = read_gcode(text_, machine_, options_);
    print_messages(arguments_.program, reading);
    if (!reading.faults.empty()) {
        fmt::print(stderr,
                   "{}: no program lines: the program was rejected{}. Correct it, or see "
                   "docs/reference/gcode.md.\n",
                   escaped(arguments_.program, 4096),
                   arguments_.start.empty() ? ", started from the trace's first sample. Where the "
                                              "program starts elsewhere, pass --start"
                                            : "");
        return;
    }
    ProgramPath path = make_program_path(reading.program, machine_);
    if (path.size() == 0) {
        fmt::print(stderr, "{}: no program lines: its path has more than {} chords\n",
                   escaped(arguments_.program, 4096), kPathPointsMax);
        return;
    }
    match_.emplace(std::move(path), machine_);
}

void ProgramFinder::add(const AxisSnapshot& snapshot) {
    if (snapshot.axis_count < machine_.axes.size()) {
        return;
    }
    if (!is_read_) {
        read(snapshot);
    }
    if (match_) {
        match_->add(snapshot.arrived_us, {snapshot.position.data(), machine_.axes.size()});
    }
}

ProgramLines ProgramFinder::finish() {
    ProgramLines lines;
    if (!match_) {
        return lines;
    }
    for (const PathMatch::Mark& mark : match_->finish()) {
        lines.steps.push_back({mark.time_us, mark.line, {}});
    }
    lines.program = arguments_.program;
    add_blocks(lines, text_);
    const char* const hint =
        2 * match_->matched() < match_->samples()
            ? ". Check --work-offset, --tool and --start, or whether this program ran."
        : match_->is_repeated() ? ". Passes that are alike: lines are those of the first."
                                : "";
    fmt::print(stderr, "{}: {} of {} samples are on its path{}\n",
               escaped(arguments_.program, 4096), match_->matched(), match_->samples(), hint);
    return lines;
}

}  // namespace axg
