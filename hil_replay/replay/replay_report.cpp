// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/replay_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/explain/format_escapes.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"
#include "firmware_if/setup/format_plan.hpp"
#include "hil_replay/replay/limit_table.hpp"
#include "hil_replay/replay/pairs_at_stop.hpp"
#include "hil_replay/replay/replay_brief.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

std::string axes_text(const Machine& machine, const AxisSnapshot& snapshot) {
    if (snapshot.axis_count == 0) {
        return "no complete sample before it";
    }
    std::string text;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const bool rotary = machine.axes[i].kind == AxisKind::rotary;
        text += fmt::format("{}{} {:.4f}{}", text.empty() ? "" : ", ", machine.axes[i].name,
                            snapshot.position[i] * (rotary ? 180.0 / kPi : 1.0),
                            rotary ? " deg" : " mm");
    }
    return text;
}

std::string first_line(const ReplayReport& report, const StopEvent& stop, const char* title) {
    std::string text =
        fmt::format("{} {:.6f} s, sample {}: {}", title, static_cast<double>(stop.time_us) * 1e-6,
                    stop.snapshot.sample, reason_text(stop));
    if (stop.pair != kNoIndex) {
        text += ", " + pair_name(report.loaded.machine, stop.pair);
    }
    if (stop.reason == StopReason::input) {
        const FaultRow& row = fault_row(stop.fault);
        text += fmt::format(", {}: {}", row.name, row.meaning);
        if (stop.fault == ReceiverFault::sync_period) {
            text += fmt::format(" (measured {:.3f} us, used {} us)",
                                static_cast<double>(stop.measured_period_ns) / 1000,
                                report.loaded.machine.can.sample_us);
        }
    }
    return text;
}

void print_stop(const ReplayReport& report, const StopEvent& stop, const char* title, Detail detail,
                std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    fmt::print(words, "\n{}\n", first_line(report, stop, title));
    if (has_limit(stop.reason)) {
        fmt::print(words, "  {}\n", limit_text(stop.limit, stop.reason, machine));
    }
    fmt::print(words, "{}  {}\n", format_step_at(report.lines, stop.snapshot.arrived_us),
               axes_text(machine, stop.snapshot));
    const auto why = report.whys.find(&stop);
    const bool has_why = why != report.whys.end();
    std::string reason = has_why ? format_why(machine, why->second, detail) : "";
    if (!is_about_distance(stop.reason)) {
        fmt::print(words, "{}", reason);
        return;
    }
    if (detail == Detail::full) {
        for (const PairAtStop& pair : pairs_at(report, stop)) {
            print_pair(machine, pair, detail, words);
        }
    } else if (print_brief_pairs(report, stop, has_why, words)) {
        reason.clear();  // a contact needs no further reason
    }
    fmt::print(words, "{}", reason);
    const std::string escapes = format_escapes(machine, escapes_at(report, stop), detail);
    if (!escapes.empty()) {
        fmt::print(words, "  {}\n", escapes);
    }
}

/// The first stop as a block; in brief the next ones as lines.
void print_stops(const ReplayReport& report, Detail detail, std::FILE* words) {
    constexpr std::size_t kBriefStops = 5;
    const std::span<const StopEvent> stops = report.run.stops();
    const bool is_full = detail == Detail::full;
    const std::size_t shown = is_full ? stops.size() : std::min(stops.size(), kBriefStops);
    for (std::size_t i = 0; i < shown; ++i) {
        if (is_full || i == 0) {
            print_stop(report, stops[i], "STOP at", detail, words);
        } else {
            fmt::print(words, "{}\n", first_line(report, stops[i], "STOP at"));
        }
    }
    const std::uint64_t count = report.run.stop_count();
    if (!is_full && count > 1) {
        fmt::print(words, "{} stops in all\n", count);
    } else if (count > shown) {
        fmt::print(words, "\n... and {} more\n", count - shown);
    }
}

void print_times(const ReplayReport& report, std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    fmt::print(words, "\nus per query      {:>9} {:>9} {:>9} {:>9}   samples not proven\n", "AVG",
               "MIN", "MAX", "p99");
    const auto line = [words](const std::string& name, const TimeHistogram& t) {
        fmt::print(words, "{:<17} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f}", name, t.mean_ns() * 1e-3,
                   us_of(t.least_ns()), us_of(t.most_ns()), us_of(t.at_share_ns(0.99)));
    };
    double sum_ns = 0;
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const PairStatistics& pair = report.run.pairs()[i];
        if (pair.time.count() == 0) {  // of some machines with travel proofs, or an empty spindle
            fmt::print(words, "{:<17} not queried\n", pair_name(machine, i));
            continue;
        }
        line(pair_name(machine, i), pair.time);
        fmt::print(words, "   {}\n", pair.not_proven);
        sum_ns += pair.time.mean_ns();
    }
    line("cycle", report.run.cycles());
    fmt::print(words, "   sum of averages {:.3f}\n", sum_ns * 1e-3);
}

/// For whole batches, in which a pair has no time of its own.
void print_not_proven(const ReplayReport& report, std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    fmt::print(words, "samples not proven\n");
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        fmt::print(words, "  {:<17} {}\n", pair_name(machine, i), report.run.pairs()[i].not_proven);
    }
}

void print_cycles(const ReplayReport& report, std::FILE* words) {
    const TimeHistogram& t = report.run.cycles();
    fmt::print(words, "us per cycle: median {:.1f}, p99 {:.1f}, max {:.1f}\n",
               us_of(t.at_share_ns(0.5)), us_of(t.at_share_ns(0.99)), us_of(t.most_ns()));
}

void print_batches(const ReplayReport& report, std::FILE* words) {
    fmt::print(words, "\nall pairs of a sample in one batch\n");
    print_not_proven(report, words);
    print_cycles(report, words);
}

void print_proofs(const ReplayReport& report, std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    const ProofStatistics& proofs = report.run.proofs();
    if (obeyed_by_refusal(machine).empty()) {
        fmt::print(words, "\nproven to standstill, at most {:.3f} ms after each sample\n",
                   free_seconds(machine, machine.can.permit_samples.least) * 1e3);
    }
    fmt::print(words, "plan: {}\n", format_plan(report.run.plan()));
    print_not_proven(report, words);
    const auto line = [words](const char* name, const CountTable& table, std::uint32_t most) {
        fmt::print(words, "{} per cycle: median {}, p99 {}, max {}\n", name, table.at_share(0.5),
                   table.at_share(0.99), most);
    };
    line("queries", proofs.queries, proofs.queries_most);
    line("stages", proofs.stages, proofs.stages_most);
    print_cycles(report, words);
    if (proofs.withheld != 0) {
        fmt::print(words, "the permit was withheld for {} samples without a stop\n",
                   proofs.withheld);
    }
}

void print_clearance_levels(const ReplayReport& report, std::FILE* words) {
    const Machine& machine = report.loaded.machine;
    const ClearanceLevelStatistics& clearance_levels = report.run.clearance_levels();
    fmt::print(words, "samples              {:>9} {:>9}\n", "slow", "warn");
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        const PairStatistics& pair = report.run.pairs()[i];
        fmt::print(words, "  {:<17}  {:>9} {:>9}\n", pair_name(machine, i), pair.slow, pair.warn);
    }
    fmt::print(words, "  {:<17}  {:>9} {:>9}   queries per sample: median {}, p99 {}, max {}\n",
               "worst of all", clearance_levels.slow, clearance_levels.warn,
               clearance_levels.queries.at_share(0.5), clearance_levels.queries.at_share(0.99),
               clearance_levels.queries_most);
}

/// What a proof of the trace proves: the program's motion only as it was read.
std::string proven_of(const ProgramLines& lines) {
    return lines.read_as.empty()  // a matched program need not be the one that ran
               ? "  of this trace, whatever program made it\n"
               : fmt::format("  of {}, {}\n", escaped(lines.program, 4096), lines.read_as);
}

const char* format_no_stop(bool is_stoppable, bool is_obeyed) {
    if (!is_stoppable) {
        return "\nno stop: every checked pair keeps its margin at all {} samples (proven)\n";
    }
    return is_obeyed ? "\nno stop: every checked pair keeps its margin to standstill, at all {} "
                       "samples with a permit (proven)\n"
                     : "\nno stop at {} samples with a permit; no pair is proven to keep its "
                       "margin to standstill, because no device obeys the permits\n";
}

void print_deadline(const ReplayReport& report, std::FILE* words) {
    fmt::print(words, "{}\n", deadline_text(report));
    for (const SlowCycle& slow : report.run.slowest()) {
        if (slow.spent_ns > report.deadline_us * 1000) {
            fmt::print(words, "  {:.1f} us at {:.6f} s: {}\n", us_of(slow.spent_ns),
                       static_cast<double>(slow.snapshot.arrived_us) * 1e-6,
                       axes_text(report.loaded.machine, slow.snapshot));
        }
    }
}

void print_faults(const ReplayReport& report, std::FILE* words) {
    const ReceiverCounters counters = report.run.input();
    for (std::uint32_t i = 1; i < kReceiverFaults; ++i) {
        if (counters.faults[i] != 0) {
            const FaultRow& row = fault_row(static_cast<ReceiverFault>(i));
            fmt::print(words, "  {:<16} {:>8}   {} ({})\n", row.name, counters.faults[i],
                       row.meaning, to_text(row.severity));
        }
    }
}

/// Prints the end of a trace without a stop.
void print_end(const ReplayReport& report, Detail detail, std::FILE* words) {
    const ReplayRun& run = report.run;
    if (!run.armed_us()) {
        fmt::print(words, "\nNO PERMIT: the guard was never armed: {}\n",
                   run.was_ready() ? "--arm-at is after the last sample at which it was ready"
                                   : "it was not ready for ten samples in a row");
    }
    if (run.end_in_motion().samples != 0) {
        print_stop(report, run.end_in_motion(), "THE TRACE ENDS IN MOTION at", detail, words);
        if (run.end_in_motion().cause != GuardFault::none) {
            fmt::print(words, "  without further frames the guard stops at {:.6f} s\n",
                       static_cast<double>(run.end_in_motion().stop_us) * 1e-6);
        }
        return;
    }
    if (run.stop_count() == 0 && run.permits() != 0 && report.end.fault.empty()) {
        const bool is_obeyed = obeyed_by_refusal(report.loaded.machine).empty();
        fmt::print(words, fmt::runtime(format_no_stop(run.is_stoppable(), is_obeyed)),
                   run.is_stoppable() ? run.permits() : run.cycles().count());
        if (is_obeyed || !run.is_stoppable()) {
            fmt::print(words, "{}", proven_of(report.lines));
        }
    }
}

/// Printed last, so that no reader misses it.
void print_cut(const TraceEnd& end, std::FILE* words) {
    if (!end.fault.empty()) {
        fmt::print(words, "\nTHE TRACE IS TRUNCATED: the rest is not proven\n  {}\n", end.fault);
    }
}

void print_tables(const ReplayReport& report, std::FILE* words) {
    const ReplayRun& run = report.run;
    (run.is_stoppable()   ? print_proofs
     : report.gpu.empty() ? print_times
                          : print_batches)(report, words);
    if (run.has_clearance_levels()) {
        print_clearance_levels(report, words);
    }
    print_limits(report.loaded.machine, run.limits(), words);
    print_deadline(report, words);
}

/// Prints how much was read, and its faults.
void print_input(const ReplayReport& report, std::FILE* words) {
    const ReplayRun& run = report.run;
    const std::string plan =
        report.plan_of.empty() ? "the machine file" : escaped(report.plan_of, 4096);
    fmt::print(words, "{}: {} frames, {} samples, {} lost, mode {}, engine {} {}{}\n", report.trace,
               run.frame_count(), run.cycles().count(), run.input().samples_lost,
               run.is_stoppable() ? "stoppable" : "contact", report.gpu.empty() ? "cpu" : "cuda",
               report.gpu.empty() ? report.engine.lanes() : report.gpu,
               run.is_stoppable() ? ", plan of " + plan : "");
    if (report.end.lines_skipped != 0) {
        fmt::print(words, "{} lines skipped, the first: {}\n", report.end.lines_skipped,
                   report.end.first_skipped);
    }
    if (report.loaded.machine.can.hashes_in_id != 0 && run.hashes_heard() < int{kHashParts}) {
        fmt::print(words, "hashes: the trace contains {} of {}; the others are not compared\n",
                   run.hashes_heard(), kHashParts);
    }
    print_faults(report, words);
}

void print_run(const ReplayReport& report, Detail detail, std::FILE* words) {
    const ReplayRun& run = report.run;
    const Machine& machine = report.loaded.machine;
    print_input(report, words);
    if (run.input().snapshots == 0 && run.stop_count() == 0) {
        fmt::print(words,
                   "no complete sample of this machine's axes. Compare the ids, format and data "
                   "ids under 'can:' in the machine file with the trace.\n");
        return;
    }
    if (const std::string refusal = obeyed_by_refusal(machine); !refusal.empty()) {
        fmt::print(words, "\n{}\n", refusal);
    }
    if (run.is_stoppable() && machine.guard.cap != CapPromise::none) {
        fmt::print(words,
                   "guard.cap: {}: not used, since the board of a trace cannot obey; axguard drive "
                   "shows it\n",
                   to_text(machine.guard.cap));
    }
    if (run.input().snapshots != 0) {
        (detail == Detail::full ? print_tables : print_summary)(report, words);
    }
    if (run.withheld().samples != 0) {
        print_stop(report, run.withheld(), "NO PERMIT from", detail, words);
        fmt::print(words, "  withheld for {} samples: the machine would not have moved\n",
                   run.withheld().samples);
    }
    print_end(report, detail, words);
    print_stops(report, detail, words);
}

}  // namespace

void explain_stops(ReplayReport& report) {
    const WhySources sources{report.loaded, report.engine.engine(), &report.run.limits()};
    const auto explain = [&](const StopEvent& stop) {
        if (auto why = why_of(sources, {stop.reason, stop.pair, stop.snapshot, stop.unproven})) {
            report.whys.emplace(&stop, std::move(*why));
        }
    };
    if (report.run.withheld().samples != 0) {
        explain(report.run.withheld());
    }
    for (const StopEvent& stop : report.run.stops()) {
        explain(stop);
    }
}

void print_replay(const ReplayReport& report, Detail detail, std::FILE* words) {
    print_run(report, detail, words);
    print_cut(report.end, words);
}

}  // namespace axg
