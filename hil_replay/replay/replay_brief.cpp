// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/replay_brief.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware_if/protocol/obeyed_by.hpp"
#include "hil_replay/replay/limit_table.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

constexpr std::size_t kPairsShown = 3;  // in contact: more are counted

std::string triangles_text(const PairAtStop& pair) {
    std::string text;
    for (const TriangleIds& t : pair.triangles) {
        text += fmt::format("{}{}/{}", text.empty() ? "" : " ", t.a, t.b);
    }
    return text + (pair.touching > pair.triangles.size() ? " ..." : "");
}

/// Axes and figures that broke a declared limit; empty: none did.
std::string exceeded_text(const ReplayReport& report) {
    const Machine& machine = report.loaded.machine;
    std::string text;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        for (const LimitRow& row : limit_rows(machine.axes[i], report.run.limits().axes()[i])) {
            if (row.peak.samples_above != 0) {
                text += fmt::format("{}{} {}", text.empty() ? "" : ", ", machine.axes[i].name,
                                    row.name);
            }
        }
    }
    return text;
}

}  // namespace

std::string proven_text(const ReplayReport& report) {
    const ReplayRun& run = report.run;
    if (!obeyed_by_refusal(report.loaded.machine).empty()) {
        return fmt::format("{} permits given, obeyed by no device", run.permits());
    }
    return fmt::format(
        "{} of {} samples proven{}{}", run.proven(), run.cycles().count(),
        run.early() == 0 ? "" : fmt::format(", {} too early to know a speed", run.early()),
        run.stop_count() == 1 ? ", then the stop" : "");
}

std::string cycle_text(const ReplayReport& report) {
    const TimeHistogram& t = report.run.cycles();
    return fmt::format("us per cycle on this computer: median {:.1f}, p99 {:.1f}, longest {:.1f}",
                       us_of(t.at_share_ns(0.5)), us_of(t.at_share_ns(0.99)), us_of(t.most_ns()));
}

std::string deadline_text(const ReplayReport& report) {
    const ReplayRun& run = report.run;
    return fmt::format("deadline {} us: {} of {} cycles late{}", report.deadline_us, run.overruns(),
                       run.cycles().count(),
                       report.is_realtime || run.overruns() == 0
                           ? ""
                           : ", on this computer; counted, not judged (--realtime judges them)");
}

void print_summary(const ReplayReport& report, std::FILE* words) {
    const ReplayRun& run = report.run;
    fmt::print(words, "{}\n{}\n{}\n", proven_text(report), cycle_text(report),
               deadline_text(report));
    if (const std::string exceeded = exceeded_text(report); !exceeded.empty()) {
        fmt::print(words, "above the declared limit: {}\n", exceeded);
    }
    if (run.has_clearance_levels()) {
        const ClearanceLevelStatistics& levels = run.clearance_levels();
        fmt::print(words, "clearance level: slow at {} samples, warn at {}\n", levels.slow,
                   levels.warn);
    }
    fmt::print(words, "tables, plan and parts of each distance: --details\n");
}

void print_pair(const Machine& machine, const PairAtStop& pair, Detail detail, std::FILE* words) {
    const std::string name = pair_name(machine, pair.pair);
    if (pair.touching != 0) {
        fmt::print(words, "  {:<18} {}{} pairs of triangles touch{}\n", name,
                   pair.is_cut_short ? "at least " : "", pair.touching,
                   detail == Detail::full ? ": " + triangles_text(pair) : "");
    } else if (is_contained(pair)) {
        const auto [inner, outer] = nested_names(machine, pair);
        fmt::print(words, "  {:<18} {} is inside {}, their surfaces at least {:.4f} mm apart\n",
                   name, inner, outer, pair.clearance_mm);
    } else {
        fmt::print(words, "  {:<18} clearance at least {:.4f} mm, margin {:g} mm\n", name,
                   pair.clearance_mm, pair.margin_mm);
    }
}

bool print_brief_pairs(const ReplayReport& report, const StopEvent& stop, bool has_why,
                       std::FILE* words) {
    std::vector<PairAtStop> pairs = pairs_at(report, stop);  // the nearest first
    const auto end = std::stable_partition(pairs.begin(), pairs.end(), [](const PairAtStop& pair) {
        return pair.touching != 0 || is_contained(pair);
    });
    const auto in_contact = static_cast<std::size_t>(end - pairs.begin());
    const std::size_t wanted = in_contact == 0 && !has_why ? 1 : in_contact;
    for (std::size_t i = 0; i < std::min({wanted, kPairsShown, pairs.size()}); ++i) {
        print_pair(report.loaded.machine, pairs[i], Detail::brief, words);
    }
    if (in_contact > kPairsShown) {
        fmt::print(words, "  and {} more pairs in contact\n", in_contact - kPairsShown);
    }
    return std::any_of(pairs.begin(), end, [&stop](const PairAtStop& pair) {
        return pair.pair == stop.pair && pair.touching != 0;
    });
}

}  // namespace axg
