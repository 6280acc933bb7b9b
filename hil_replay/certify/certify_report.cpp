// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/certify/certify_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"

namespace axg {
namespace {

constexpr std::size_t kPrinted = 16;

std::string reason_of(const OpenStretch& open) {
    switch (open.reason) {
        case OpenReason::position:
            return fmt::format("too near on the path itself: clear by {:.3f} mm",
                               open.clearance_mm);
        case OpenReason::tube:
            return fmt::format("clear by {:.3f} mm, {:.3f} mm needed for a stop and errors",
                               open.clearance_mm, open.needed_mm);
        case OpenReason::inside:
            return "one body may be inside the other";
        case OpenReason::beyond:
            break;
    }
    return "beyond the positions that the model holds for";
}

}  // namespace

std::string lines_text(const ChordPath& path, const OpenStretch& open) {
    const auto first = path.lines.begin() + static_cast<std::ptrdiff_t>(open.first);
    const auto end = path.lines.begin() + static_cast<std::ptrdiff_t>(open.end);
    const auto [least, most] = std::minmax_element(first, end);
    return *least == *most ? fmt::format("{}", *least) : fmt::format("{}-{}", *least, *most);
}

std::string pair_text(const Machine& machine, const CertifyTask& task) {
    const Pair& pair = machine.pairs[task.pair];
    const auto name = [&](std::uint32_t body) {
        const std::string tool = machine.bodies[body].is_tool
                                     ? fmt::format(" (tool {})", machine.tools[task.tool].number)
                                     : std::string();
        return escaped(machine.bodies[body].name, 64) + tool;
    };
    return name(pair.a) + " and " + name(pair.b);
}

std::string position_text(const Machine& machine, const UnitBox& box) {
    const JointBox joints = joint_box(machine, box);
    std::string out;
    for (std::size_t i = 0; i < machine.axes.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const double scale = axis.kind == AxisKind::rotary ? 180 / kPi : 1;
        out += fmt::format("{}{} {:.3f}", out.empty() ? "" : " ", escaped(axis.name, 16),
                           joints.centre[i] * scale);
    }
    return out;
}

void print_certify(const CertifyReport& report, std::FILE* out) {
    const ChordPath& path = report.path;
    const ProgramProof& proof = report.proof;
    const bool is_certified = proof.open.empty();
    fmt::print(out, "{}: {}: {:.1f} s of motion, {} segments, {} pairs (each with each tool)\n",
               report.program, is_certified ? "certified" : "NOT certified", path.seconds,
               path.segment_count(), report.tasks.tasks.size());
    for (std::size_t i = 0; i < std::min(kPrinted, proof.open.size()); ++i) {
        const OpenStretch& open = proof.open[i];
        fmt::print(out, "{}:{}: {}: {}\n    at {}\n", report.program, lines_text(path, open),
                   pair_text(report.machine, report.tasks.tasks[open.task]), reason_of(open),
                   position_text(report.machine, open.box));
    }
    if (proof.open.size() > kPrinted) {
        fmt::print(out, "... and {} more; all of them: --json=FILE\n",
                   proof.open.size() - kPrinted);
    }
    if (!report.covers_lower) {
        fmt::print(out,
                   "for an override of {} % alone, no lower one: corners are rounded (G64 P, "
                   "--blend-mm), and by another path at another feed\n",
                   report.override_percent);
    }
    if (!report.certificate.empty()) {
        fmt::print(out, "{}: {} bytes, {} boxes, {} queries, {:.1f} s; stops {}{}\n",
                   report.certificate, report.certificate_bytes, proof.boxes, proof.questions,
                   report.spent_s, to_text(report.machine.guard.promise),
                   is_certified ? "" : "; with holes, about which it claims nothing");
        fmt::print(out, "{}: {}\n", report.model, report.model_sha256);
    } else if (!is_certified) {
        fmt::print(out, "no certificate written; --partial writes one with holes\n");
    }
}

}  // namespace axg
