// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/replay/replay_csv.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <utility>

#include "core/base/sincos.hpp"
#include "firmware_if/cli/whole_file.hpp"
#include "hil_replay/replay/page_samples.hpp"

namespace axg {

std::string pair_name(const Machine& machine, std::uint32_t pair) {
    const Pair& p = machine.pairs[pair];
    return machine.bodies[p.a].name + "-" + machine.bodies[p.b].name;
}

ReplayCsv::ReplayCsv(const Machine& machine, std::string path, bool is_stoppable)
    : machine_(machine), path_(std::move(path)), is_stoppable_(is_stoppable) {
    text_ = "sample,latched_us,arrived_us";
    for (const Axis& axis : machine.axes) {
        text_ += fmt::format(",{}_{}", axis.name, axis.kind == AxisKind::rotary ? "deg" : "mm");
    }
    text_ += ",tool,permit,reason,not_proven";
    text_ += is_stoppable_ ? ",pair,questions,stages" : "";
    has_clearance_levels_ = has_clearance_levels(machine);
    text_ += has_clearance_levels_ ? ",level,level_pair" : "";
    for (std::uint32_t i = 0; i < machine.pairs.size(); ++i) {
        text_ += fmt::format(",{}_mm", pair_name(machine, i));
    }
    text_ += '\n';
}

void ReplayCsv::on_cycle(const ReplayCycle& cycle, std::span<const double> clearances_mm) {
    const auto out = std::back_inserter(text_);
    const AxisSnapshot& snapshot = cycle.snapshot;
    fmt::format_to(out, "{},{},{}", snapshot.sample, snapshot.latched_us, snapshot.arrived_us);
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
        const bool rotary = machine_.axes[i].kind == AxisKind::rotary;
        fmt::format_to(out, ",{:.6f}", snapshot.position[i] * (rotary ? 180.0 / kPi : 1.0));
    }
    fmt::format_to(out, ",{},{},{},{}", snapshot.tool, cycle.sent_permit ? 1 : 0,
                   to_text(cycle.result.reason), cycle.result.not_proven);
    if (is_stoppable_) {
        const bool has_pair = cycle.result.pair != kNoIndex;
        const StagedWork& work = cycle.stop_certificate->work();
        fmt::format_to(out, ",{},{},{}", has_pair ? pair_name(machine_, cycle.result.pair) : "",
                       work.queries, work.stages);
    }
    if (has_clearance_levels_) {
        const std::uint32_t worst = cycle.margin_advisory->worst();
        fmt::format_to(out, ",{},{}", to_text(cycle.clearance_level()),
                       worst != kNoIndex ? pair_name(machine_, worst) : "");
    }
    for (const double clearance_mm : clearances_mm) {
        text_ += ',';
        if (clearance_mm != kNotNear) {
            fmt::format_to(out, "{:.6f}", std::floor(clearance_mm * 1e6) * 1e-6);
        }
    }
    text_ += '\n';
}

bool ReplayCsv::finish(std::FILE* messages) {
    return write_whole_file(path_, text_, messages);
}

}  // namespace axg
