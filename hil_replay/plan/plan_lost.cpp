// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/plan/plan_lost.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"
#include "hil_replay/replay/replay_csv.hpp"

namespace axg {
namespace {

const char* what_of(LostResult::Kind kind) {
    return kind == LostResult::Kind::contact ? "contact"
           : kind == LostResult::Kind::rest  ? "at rest"
                                             : "trace";
}

double shown(const Axis& axis, double position) {
    return axis.kind == AxisKind::rotary ? position * (180.0 / kPi) : position;
}

std::string pair_of(const Machine& machine, const LostResult& lost) {
    return lost.pair == kNoIndex ? "" : pair_name(machine, lost.pair);
}

}  // namespace

std::string format_lost(const Machine& machine, const ModelCandidate& model) {
    std::string words;
    const std::size_t named = std::min(model.lost_results.size(), kLostNamed);
    for (std::size_t i = 0; i < named; ++i) {
        const LostResult& lost = model.lost_results[i];
        words += i == 0 ? "" : "; ";
        words += lost.pair == kNoIndex ? "the trace ends early" : escaped(pair_of(machine, lost));
        for (std::size_t axis = 0; axis < lost.axes.size(); ++axis) {
            words += fmt::format("{}{} {:.3f}", axis == 0 ? " at " : " ",
                                 escaped(machine.axes[axis].name),
                                 shown(machine.axes[axis], lost.axes[axis]));
        }
        words += lost.kind == LostResult::Kind::trace
                     ? fmt::format(" (sample {} of the trace)", lost.sample)
                     : fmt::format(" ({})", what_of(lost.kind));
    }
    if (named < model.lost_results.size()) {
        words += fmt::format("; and {} more", model.lost_results.size() - named);
    }
    return words;
}

std::string csv_of_lost(const Machine& machine, const std::vector<ModelCandidate>& models) {
    std::string text = "simplify_mm,what,sample,pair";
    for (const Axis& axis : machine.axes) {
        text += fmt::format(",{}_{}", axis.name, axis.kind == AxisKind::rotary ? "deg" : "mm");
    }
    text += '\n';
    for (const ModelCandidate& model : models) {
        for (const LostResult& lost : model.lost_results) {
            const bool is_trace = lost.kind == LostResult::Kind::trace;
            text +=
                fmt::format("{:g},{},{},{}", model.simplify_mm, what_of(lost.kind),
                            is_trace ? std::to_string(lost.sample) : "", pair_of(machine, lost));
            for (std::size_t axis = 0; axis < machine.axes.size(); ++axis) {
                text += axis < lost.axes.size()
                            ? fmt::format(",{:.6f}", shown(machine.axes[axis], lost.axes[axis]))
                            : ",";
            }
            text += '\n';
        }
    }
    return text;
}

}  // namespace axg
