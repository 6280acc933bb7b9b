// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/commands/verify_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "firmware_if/cli/exit_codes.hpp"

namespace axg {
namespace {

constexpr std::size_t kEventsShown = 5;  // of each kind, in all runs together
constexpr std::size_t kBlockLetters = 28;

/// A whole number, and nothing else.
bool read_percent(std::string_view word, int& percent) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), percent);
    return error == std::errc() && end == word.data() + word.size() && percent >= kOverrideLeast &&
           percent <= kOverrideMost;
}

/// "30, 100 and 150 %"
std::string percents(std::span<const int> overrides) {
    std::string text;
    for (std::size_t i = 0; i < overrides.size(); ++i) {
        text += i == 0 ? "" : i + 1 == overrides.size() ? " and " : ", ";
        text += std::to_string(overrides[i]);
    }
    return text + " %";
}

std::string place_of(const VerifyEvent& event) {
    if (event.line == 0) {
        return "before the first line";
    }
    const bool is_long = event.block.size() > kBlockLetters;
    return fmt::format("line {}: {}{}", event.line, event.block.substr(0, kBlockLetters),
                       is_long ? ".." : "");
}

/// Prints the first few events of all runs; none: nothing.
void print_events(const VerifiedProgram& program, const char* title,
                  std::vector<VerifyEvent> VerifyRun::*events, std::FILE* words) {
    std::size_t count = 0;
    for (const VerifyRun& run : program.runs) {
        for (const VerifyEvent& event : run.*events) {
            if (count++ < kEventsShown) {
                fmt::print(words, "{:<7} at {:>3} %, {:.3f} s, {}: {}\n", title,
                           run.override_percent, event.time_s, place_of(event), event.what);
            }
        }
    }
    if (count > kEventsShown) {
        fmt::print(words, "{:<7} and {} more\n", title, count - kEventsShown);
    }
}

struct Nearest {
    const VerifyRun* run;
    const VerifyEvent* event;
};

/// The nearest of all runs, one for each tool.
std::vector<Nearest> nearest_of_tools(const VerifiedProgram& program) {
    std::vector<Nearest> out;
    for (const VerifyRun& run : program.runs) {
        for (const VerifyEvent& event : run.nearest) {
            const auto same = std::find_if(out.begin(), out.end(), [&event](const Nearest& one) {
                return one.event->tool == event.tool;
            });
            if (same == out.end()) {
                out.push_back({&run, &event});
            } else if (event.clearance_mm < same->event->clearance_mm) {
                *same = {&run, &event};
            }
        }
    }
    std::stable_sort(out.begin(), out.end(), [](const Nearest& a, const Nearest& b) {
        return a.event->clearance_mm < b.event->clearance_mm;
    });
    return out;
}

void print_nearest(const VerifiedProgram& program, std::FILE* words) {
    const std::vector<Nearest> all = nearest_of_tools(program);
    for (std::size_t i = 0; i < std::min(all.size(), kEventsShown); ++i) {
        const VerifyEvent& event = *all[i].event;
        if (!std::isfinite(event.clearance_mm)) {
            fmt::print(words, "nearest tool {}: every pair beyond 50 mm\n", event.tool);
            continue;
        }
        fmt::print(words, "nearest tool {}: {:.3f} mm, {}, at {} %, {:.3f} s, {}\n", event.tool,
                   event.clearance_mm, event.what, all[i].run->override_percent, event.time_s,
                   place_of(event));
    }
    if (all.size() > kEventsShown) {
        fmt::print(words, "nearest and {} more tools\n", all.size() - kEventsShown);
    }
}

/// What the exit code of one run means.
const char* result_of(const VerifyRun& run) {
    return run.exit_code == kExitClean ? "clear"
           : !run.contacts.empty()     ? "CONTACT"
           : run.stop_count != 0       ? "STOP"
           : run.is_unproven           ? "NO PERMIT"
                                       : "NOT VERIFIED";
}

}  // namespace

std::vector<int> read_overrides(std::string_view word) {
    const std::size_t dots = word.find("..");
    int least = 0, most = 0;
    if (!read_percent(word.substr(0, dots), least)) {
        return {};
    }
    if (dots == std::string_view::npos) {
        return {least};
    }
    if (!read_percent(word.substr(dots + 2), most) || least > most) {
        return {};
    }
    std::vector<int> out{least};
    if (least < 100 && most > 100) {
        out.push_back(100);
    }
    if (most != least) {
        out.push_back(most);
    }
    return out;
}

int VerifyReport::exit_code() const {
    int code = kExitClean;
    for (const VerifiedProgram& program : programs) {
        code = std::max(code, program.exit_code);
    }
    return code;
}

void print_program(const VerifyReport& report, const VerifiedProgram& program, std::FILE* words) {
    fmt::print(words, "{} on {}\n", program.file, report.machine);
    if (!program.read_as.empty()) {
        fmt::print(words, "{}\n", program.read_as);
    }
    print_events(program, "CONTACT", &VerifyRun::contacts, words);
    print_events(program, "STOP", &VerifyRun::stops, words);
    print_nearest(program, words);
    for (const VerifyRun& run : program.runs) {
        fmt::print(words, "{:>3} % of the feeds: {}, {:.3f} s, {:.1f} mm of path, {} samples\n",
                   run.override_percent, result_of(run), run.program_s, run.path_mm, run.samples);
    }
    print_table_end(report, words);
}

void print_table_head(std::FILE* words) {
    fmt::print(words, "{:<40} {:>5} {:>9} {:<12} {:>10}  {}\n", "program", "feeds", "s", "result",
               "nearest mm", "place");
}

void print_table_row(const VerifiedProgram& program, std::FILE* words) {
    const std::string& file = program.file;
    const std::string name =
        file.size() > 40 ? ".." + file.substr(file.size() - 38) : file;  // its end differs
    if (program.runs.empty()) {
        fmt::print(words, "{:<40} {:>5} {:>9} NOT VERIFIED\n", name, "", "");
    }
    for (const VerifyRun& run : program.runs) {
        double nearest_mm = HUGE_VAL;
        for (const VerifyEvent& event : run.nearest) {
            nearest_mm = std::min(nearest_mm, event.clearance_mm);
        }
        const VerifyEvent* const first = !run.contacts.empty() ? &run.contacts.front()
                                         : !run.stops.empty()  ? &run.stops.front()
                                                               : nullptr;
        fmt::print(words, "{:<40} {:>3} % {:>9.3f} {:<12} {:>10}  {}\n", name, run.override_percent,
                   run.program_s, result_of(run),
                   std::isfinite(nearest_mm) ? fmt::format("{:.3f}", nearest_mm) : "over 50",
                   first != nullptr ? fmt::format("line {}", first->line) : "");
    }
    std::fflush(words);
}

void print_table_end(const VerifyReport& report, std::FILE* words) {
    const auto clear = static_cast<std::size_t>(
        std::count_if(report.programs.begin(), report.programs.end(),
                      [](const VerifiedProgram& one) { return one.exit_code == kExitClean; }));
    fmt::print(words, "{} of {} programs clear at {} of the feeds{}; G0 at axis speed\n", clear,
               report.programs.size(), percents(report.overrides),
               report.overrides.size() > 1 ? " (not proven between them)" : "");
    if (report.cut_mm_min > 0) {
        fmt::print(
            words,
            "feeds above {:g} mm/min ran at that speed, not higher: program_speed_mm_min of the "
            "machine file is to be the control's largest feed, override included\n",
            report.cut_mm_min);
    }
    if (!report.not_obeyed.empty()) {
        fmt::print(words, "{}\n", report.not_obeyed);
    }
}

}  // namespace axg
