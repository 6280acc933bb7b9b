// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/axguardd/admission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware_if/axguardd/latency_command.hpp"
#include "firmware_if/setup/choose_engine.hpp"
#include "firmware_if/setup/format_plan.hpp"

namespace axg {
namespace {

constexpr double kMegabyte = 1e6;
constexpr double kRounding = 1e-9;  // 44 % is not 43.999...

AdmissionLine not_measured(AdmissionCheck check, const char* mend) {
    return {check, false, {}, "could not be measured", mend};
}

/// A line about a time that has so much room.
AdmissionLine timed(AdmissionCheck check, double used_us, double room_us, std::string found,
                    std::string mend) {
    const bool is_passed = used_us <= room_us;  // false for a NaN as well
    return {check, is_passed, 1 - used_us / room_us, std::move(found),
            is_passed ? std::string() : std::move(mend)};
}

AdmissionLine judge_system(const AdmissionFigures& figures) {
    if (!figures.system || figures.system->empty()) {
        return not_measured(AdmissionCheck::system, "axguardd doctor");
    }
    AdmissionLine line;
    std::array<int, 3> counts{};
    for (const Finding& finding : *figures.system) {
        ++counts[static_cast<std::size_t>(finding.fitness)];
        if (finding.fitness == Fitness::bad) {
            line.found += fmt::format("{}{}: {}", line.found.empty() ? "" : "; ", finding.subject,
                                      finding.found);
            line.mend += (line.mend.empty() ? "" : "; ") + finding.mend;
        }
    }
    if (!line.found.empty() && line.mend.empty()) {
        line.mend = "axguardd doctor";
    }
    line.is_passed = counts[static_cast<std::size_t>(Fitness::bad)] == 0;
    if (line.is_passed) {
        line.found = fmt::format("{} OK, {} warnings; see axguardd doctor",
                                 counts[static_cast<std::size_t>(Fitness::ok)],
                                 counts[static_cast<std::size_t>(Fitness::warn)]);
    }
    return line;
}

AdmissionLine judge_latency(const AdmissionFigures& figures) {
    if (!figures.wake_ups || figures.wake_ups->count == 0) {
        return not_measured(AdmissionCheck::latency, "run axguardd latency-test");
    }
    const WakeUpFigures& wake_ups = *figures.wake_ups;
    const double latest_us = static_cast<double>(wake_ups.latest_ns) * 1e-3;
    const double room_us = static_cast<double>(figures.times.period_us) / kWakeUpShare;
    return timed(
        AdmissionCheck::latency, latest_us, room_us,
        fmt::format("worst wake-up latency {1:.1f} us, limit {2:.1f} us ({0} samples)",
                    wake_ups.count, latest_us, room_us),
        fmt::format(
            "find the cause with axguardd doctor, or raise can.sample_us (latency allows {} us)",
            fit_period_us(wake_ups.latest_ns)));
}

/// The longest that has the deadline.
double timely_us(const CycleFigures& cycles) {
    return std::max(cycles.proven_us, cycles.worst_case_us);
}

bool has_cycles(const AdmissionFigures& figures) {
    return figures.cycles && figures.cycles->proven_count != 0;
}

AdmissionLine judge_engine(const AdmissionFigures& figures) {
    if (!has_cycles(figures)) {
        return not_measured(AdmissionCheck::engine, "check contacts and engine with axguard check");
    }
    const CycleFigures& cycles = *figures.cycles;
    const double room_us = figures.times.engine_us;
    const std::string full =
        cycles.worst_case_us > 0 ? fmt::format(", worst case {:.0f} us", cycles.worst_case_us) : "";
    const std::string plan = cycles.plan ? fmt::format(" ({})", format_plan(*cycles.plan)) : "";
    AdmissionLine line =
        timed(AdmissionCheck::engine, timely_us(cycles), room_us,
              fmt::format("{0}: longest proven cycle {2:.0f} us{3}{4}, limit {5:.0f} us ({1} "
                          "cycles); longest cycle {7} us ({6} not proven)",
                          cycles.engine, cycles.proven_count, cycles.proven_us, full, plan, room_us,
                          cycles.count - cycles.proven_count, std::ceil(cycles.longest_us)),
              fmt::format("raise deadline_us to {} or more, state fewer cycle.queries, simplify "
                          "meshes (simplify_mm), or on a GPU shorten capacities.batch",
                          std::ceil(timely_us(cycles) / kEngineShare)));
    if (!(cycles.longest_us < static_cast<double>(figures.times.least_permit_us))) {
        line.is_passed = false;
        line.found += fmt::format(", not below the permit's {} us", figures.times.least_permit_us);
        line.mend = "state fewer cycle.queries, or simplify meshes (simplify_mm)";
    }
    return line;
}

AdmissionLine judge_cycle(const AdmissionFigures& figures) {
    if (!has_cycles(figures) || !figures.wake_ups || figures.wake_ups->count == 0) {
        return not_measured(AdmissionCheck::cycle, "correct latency and engine first");
    }
    const double wake_us = 2e-3 * static_cast<double>(figures.wake_ups->latest_ns);
    const double used_us = wake_us + timely_us(*figures.cycles);
    return timed(
        AdmissionCheck::cycle, used_us, static_cast<double>(figures.times.deadline_us),
        fmt::format("two worst wake-ups and the longest proven cycle {:.0f} us, deadline {} us",
                    used_us, figures.times.deadline_us),
        fmt::format("raise deadline_us to {} or more (period {} us), or correct latency and engine",
                    std::ceil(used_us), figures.times.period_us));
}

AdmissionLine judge_known_answer(const AdmissionFigures& figures) {
    const bool is_passed = figures.passes_known_answer.value_or(false);
    if (!figures.passes_known_answer) {
        return not_measured(AdmissionCheck::known_answer, "run axguard check --engine");
    }
    return {AdmissionCheck::known_answer,
            is_passed,
            {},
            is_passed ? "both known-answer tests passed" : "known-answer test failed",
            is_passed ? "" : "use another processor or GPU; this one computes wrong results"};
}

AdmissionLine judge_memory(const AdmissionFigures& figures) {
    if (!figures.memory || figures.memory->available_bytes == 0) {
        return not_measured(AdmissionCheck::memory, "cat /proc/meminfo /proc/self/limits");
    }
    const MemoryFigures& memory = *figures.memory;
    const auto megabytes = [](std::uint64_t bytes) {
        return static_cast<double>(bytes) / kMegabyte;
    };
    const bool has_room = memory.more_bytes <= memory.available_bytes;
    const bool may_lock = memory.mapped_bytes <= memory.lock_limit_bytes &&
                          memory.more_bytes <= memory.lock_limit_bytes - memory.mapped_bytes;
    AdmissionLine line{AdmissionCheck::memory, has_room && may_lock, {}, {}, {}};
    line.found = fmt::format(
        "engine {:.1f} MB{}, further {:.1f} MB, available {:.0f} MB; to be locked {:.0f} MB{}",
        megabytes(memory.reserved_bytes),
        memory.device_bytes > 0
            ? fmt::format(", on the GPU {:.1f} MB", megabytes(memory.device_bytes))
            : "",
        megabytes(memory.more_bytes), megabytes(memory.available_bytes),
        megabytes(memory.mapped_bytes + memory.more_bytes),
        may_lock ? "" : fmt::format(", limit {:.1f} MB", megabytes(memory.lock_limit_bytes)));
    if (!line.is_passed) {
        line.mend = has_room ? "set ulimit -l unlimited, or LimitMEMLOCK=infinity in the unit"
                             : "close other programs";
    }
    return line;
}

}  // namespace

const char* to_text(AdmissionCheck check) noexcept {
    static_assert(kAdmissionNames.size() == kAdmissionCount);
    return kAdmissionNames[static_cast<std::size_t>(check)];
}

AdmissionGauge gauge_of(const AdmissionVerdict& verdict) noexcept {
    AdmissionGauge gauge{verdict.is_fit(), verdict.margin, 0};
    for (std::size_t i = 0; i < verdict.lines.size(); ++i) {
        gauge.failed |= verdict.lines[i].is_passed ? 0U : 1U << i;
    }
    return gauge;
}

bool AdmissionVerdict::is_fit() const noexcept {
    return std::all_of(lines.begin(), lines.end(),
                       [](const AdmissionLine& line) { return line.is_passed; });
}

bool AdmissionVerdict::is_waived_by(const std::vector<std::string>& names) const {
    return std::all_of(lines.begin(), lines.end(), [&names](const AdmissionLine& line) {
        return line.is_passed ||
               std::find(names.begin(), names.end(), to_text(line.check)) != names.end();
    });
}

AdmissionVerdict judge_admission(const AdmissionFigures& figures) {
    AdmissionVerdict verdict{
        {judge_system(figures), judge_latency(figures), judge_engine(figures), judge_cycle(figures),
         judge_known_answer(figures), judge_memory(figures)},
        figures.times.period_us,
        0};
    if (verdict.is_fit()) {
        verdict.margin = 1;
        for (const AdmissionLine& line : verdict.lines) {
            verdict.margin = std::min(verdict.margin, line.margin.value_or(1));
        }
    }
    return verdict;
}

std::string to_text(const AdmissionVerdict& verdict) {
    const double rate_hz = 1e6 / static_cast<double>(verdict.sample_us);
    std::string names;
    for (const AdmissionLine& line : verdict.lines) {
        const bool is_named = verdict.is_fit() ? line.margin == verdict.margin : !line.is_passed;
        if (is_named) {
            names += (names.empty() ? "" : ", ") + std::string(to_text(line.check));
        }
    }
    return verdict.is_fit() ? fmt::format("fit for {:.0f} Hz with margin {:.0f} % ({})", rate_hz,
                                          std::floor(100 * verdict.margin + kRounding), names)
                            : fmt::format("not fit for {:.0f} Hz: {}", rate_hz, names);
}

}  // namespace axg
