// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/drive/drive_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "core/base/sincos.hpp"
#include "core/guard/margin_advisory.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/explain/format_escapes.hpp"
#include "firmware_if/protocol/obeyed_by.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

constexpr double kWithinMm = 50.0;

/// Why the board stopped, in words.
std::string why_text(const DriveReport& report) {
    const DriveResult& result = report.result;
    if (report.bus && report.bus->wire.other_board_id != 0) {
        return fmt::format("no motion: another board sends on {}", report.bus->interface);
    }
    if (result.state == BoardState::waiting) {
        return "no motion: the guard sent no permit";
    }
    if (result.board_stop.why == BoardStop::person_said_stop) {
        return "the operator ended the program";
    }
    if (result.board_stop.why == BoardStop::guard_said_stop) {
        return "the guard ordered a stop";
    }
    return "the last permit expired without renewal";
}

void print_guard_stop(const DriveReport& report, Detail detail, std::FILE* words) {
    const DriveStop& stop = report.result.guard_stop;
    if (!has_reason(stop)) {
        return;
    }
    fmt::print(words, "  reason of the guard: {}", reason_text(stop));
    if (stop.pair != kNoIndex) {
        fmt::print(words, ", {}", pair_name(report.machine, stop.pair));
    }
    if (stop.reason == StopReason::input) {
        const FaultRow& row = fault_row(stop.fault);
        fmt::print(words, ", {}: {}", row.name, row.meaning);
    }
    fmt::print(words, ", at sample {}\n", stop.snapshot.sample);
    if (has_limit(stop.reason)) {
        fmt::print(words, "  {}\n", limit_text(stop.limit, stop.reason, report.machine));
    }
    if (stop.reason == StopReason::left_cap) {
        const std::uint32_t axis = stop.cap.axis;
        fmt::print(words, "  the board broke its cap: {}{}\n", to_text(stop.cap.kind),
                   axis == kNoIndex ? "" : ", axis " + report.machine.axes[axis].name);
    }
    if (report.why) {
        fmt::print(words, "{}", format_why(report.machine, *report.why, detail));
    }
}

/// Prints faults of the wire and the guard's emergency message.
void print_bus(const DriveReport& report, std::FILE* words) {
    const LiveWireReport& wire = report.bus->wire;
    if (wire.emergency) {
        fmt::print(words, "  emergency message of the guard: {}", to_text(wire.emergency->code));
        if (wire.emergency->pair < report.machine.pairs.size()) {
            fmt::print(words, ", {}", pair_name(report.machine, wire.emergency->pair));
        }
        fmt::print(words, "\n");
    }
    if (wire.is_lost) {
        fmt::print(words, "  {} went down or was removed\n", report.bus->interface);
    }
    fmt::print(words, "{}: {} of {} periods late, max {:.3f} ms\n", report.bus->interface,
               wire.late_periods, report.result.samples,
               static_cast<double>(wire.late_us_max) * 1e-3);
}

/// Prints the cost of each slow-down, the highest first; in brief only the total.
void print_caps(const DriveReport& report, Detail detail, std::FILE* words) {
    const std::size_t shown = detail == Detail::full ? 10 : 0;
    const DriveResult& result = report.result;
    fmt::print(words, "cap of {}: {} slow-downs, {:.3f} s lost; shortest permit {} samples\n",
               to_text(report.machine.guard.cap), result.slow_downs.size(), result.lost_s,
               result.samples_least);
    std::vector<SlowDown> dearest = result.slow_downs;
    std::stable_sort(dearest.begin(), dearest.end(),
                     [](const SlowDown& a, const SlowDown& b) { return a.lost_s > b.lost_s; });
    for (std::size_t i = 0; i < std::min(shown, dearest.size()); ++i) {
        const SlowDown& one = dearest[i];
        fmt::print(words, "  at {:.3f} s for {:.3f} s, down to {:.1f} % of rapid: {:.3f} s lost\n",
                   one.begin_s, one.seconds, 0.4 * one.least, one.lost_s);
    }
    if (result.cap_breaches != 0) {
        fmt::print(words, "  the simulated board exceeded its cap {} times\n", result.cap_breaches);
    }
}

void print_time(const DriveReport& report, Detail detail, std::FILE* words) {
    const DriveResult& result = report.result;
    if (result.state == BoardState::waiting) {
        return;
    }
    fmt::print(words, "machine time {:.3f} s", motion_s(result));
    if (report.free_s > 0) {
        fmt::print(words, ", {:.3f} s without the speed cap: {:+.1f} %", report.free_s,
                   100 * (motion_s(result) / report.free_s - 1));
    }
    if (report.has_cap) {
        fmt::print(words, "; lowest speed cap {:.1f} % of rapid", 0.4 * result.speed_cap);
    }
    if (has_clearance_levels(report.machine)) {
        fmt::print(words, "; slow for {} samples", result.slow_samples);
    }
    fmt::print(words, "\n");
    if (report.machine.guard.cap != CapPromise::none) {
        print_caps(report, detail, words);
    }
}

/// Prints where the axes rest and how far each pair is from contact; in brief only the pairs in
/// contact, or the nearest one.
void print_rest(const DriveReport& report, Detail detail, std::FILE* words) {
    const Machine& machine = report.machine;
    fmt::print(words, "at rest:");
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        fmt::print(words, "{} {} {:.4f}{}", i == 0 ? "" : ",", axis.name,
                   in_file_units(axis, report.result.rest[i].position),
                   axis.kind == AxisKind::rotary ? " deg" : " mm");
    }
    fmt::print(words, "\n");
    const std::vector<PairAtRest> pairs = pairs_at_rest(report);
    std::size_t shown = 0;
    for (const PairAtRest& pair : pairs) {
        if (detail == Detail::brief && shown != 0 && !pair.is_touching) {
            continue;
        }
        ++shown;
        const std::string name = pair_name(machine, pair.pair);
        if (pair.is_touching) {
            fmt::print(words, "  {:<18} TOUCHES\n", name);
        } else {
            fmt::print(words, "  {:<18} clearance at least {:.4f} mm, margin {:g} mm\n", name,
                       pair.clearance_mm, machine.pairs[pair.pair].margin_mm);
        }
    }
    if (pairs.size() > shown) {
        fmt::print(words, "  and {} more pairs within {:g} mm: --details\n", pairs.size() - shown,
                   kWithinMm);
    }
}

}  // namespace

double in_file_units(const Axis& axis, double value) {
    return value * (axis.kind == AxisKind::rotary ? 180.0 / kPi : 1.0);
}

double motion_s(const DriveResult& result) {
    return static_cast<double>(result.ended_us - result.moving_since_us) * 1e-6;
}

std::vector<PairAtRest> pairs_at_rest(const DriveReport& report) {
    const AxisSnapshot snapshot = snapshot_at_rest(report.machine, report.result);
    const auto pair_queries = std::make_unique<PairQueries>();
    make_contact_queries(report.machine, snapshot, *pair_queries);
    std::vector<PairAtRest> pairs;
    for (std::uint32_t i = 0; pair_queries->status == SnapshotStatus::ok && i < pair_queries->count;
         ++i) {
        Query query = pair_queries->queries[i];
        QueryResult query_result, touch;
        query.kind = QueryKind::clearance;
        query.r_mm = kWithinMm;
        report.engine({&query, 1}, {&query_result, 1});
        query = pair_queries->queries[i];
        query.r_mm = 0;
        report.engine({&query, 1}, {&touch, 1});
        if (query_result.clearance_mm < kWithinMm) {
            pairs.push_back(
                {pair_queries->pair[i], query_result.clearance_mm, touch.proof != Proof::far});
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const PairAtRest& a, const PairAtRest& b) {
        return a.clearance_mm < b.clearance_mm;
    });
    return pairs;
}

std::int64_t stopped_at_us(const DriveResult& result) noexcept {
    return has_reason(result.guard_stop) ? result.guard_stop.snapshot.latched_us
                                         : result.board_stop.asked_us;
}

void print_drive(const DriveReport& report, Detail detail, std::FILE* words) {
    const DriveResult& result = report.result;
    const Machine& machine = report.machine;
    fmt::print(words, "{}: {} samples, {} permits, {} frames {}, {} {}, seed {}\n", report.program,
               result.samples, result.permits, result.frames_lost, report.bus ? "refused" : "lost",
               report.bus ? "bus" : "mode", report.bus ? report.bus->interface : report.mode,
               report.seed);
    if (const std::string refusal = obeyed_by_refusal(machine); !refusal.empty()) {
        fmt::print(words, "{}\n", refusal);
    }
    if (result.state == BoardState::finished) {
        fmt::print(words, "the program ran to its end\n");
    } else if (result.is_held) {
        fmt::print(
            words,
            "HELD: the cap keeps the axes where they stand, since not even a crawl is proven "
            "ahead\n");
    } else {
        fmt::print(words, "STOP: {}\n{}", why_text(report),
                   format_step_at(report.lines, stopped_at_us(result)));
        print_guard_stop(report, detail, words);
    }
    if (report.bus) {
        print_bus(report, words);
    }
    if (result.state == BoardState::stopped) {
        const BoardStopRecord& stop = result.board_stop;
        const auto after_ms = [&stop](std::int64_t at_us) {
            return static_cast<double>(at_us - stop.certified_us) * 1e-3;
        };
        fmt::print(words,
                   "  after the last sample with a permit: braking after {:.3f} ms, at rest after "
                   "{:.3f} ms\n",
                   after_ms(stop.brake_us), after_ms(stop.rest_us));
    }
    if (report.contact) {
        fmt::print(words, "CONTACT in motion, {:.4f} s after the start: {}\n",
                   seconds_after_start(*report.contact), pair_name(machine, report.contact->pair));
    }
    print_time(report, detail, words);
    print_rest(report, detail, words);
    const std::string escapes = format_escapes(machine, report.escapes, detail);
    if (result.state != BoardState::finished && !escapes.empty()) {
        fmt::print(words, "{}\n", escapes);
    }
    if (report.jogs) {
        fmt::print(words, "{}\n", jog_out_text(machine, *report.jogs));
    }
}

}  // namespace axg
