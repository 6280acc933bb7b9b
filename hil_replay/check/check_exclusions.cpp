// SPDX-License-Identifier: Apache-2.0
// The exclusions of a machine over its whole travel: what each hides, proven or with a witness.
#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "config/init/write_machine.hpp"
#include "config/text/quote_text.hpp"
#include "core/certificate/joint_path.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/cli/progress.hpp"
#include "firmware_if/setup/guard_engine.hpp"
#include "hil_replay/check/check_report.hpp"

namespace axg {
namespace {

/// "X 37.5, A -78.6 deg with tool #5": the axes between the bodies.
std::string place_of(const Machine& machine, const Exclusion& one, const TravelWitness& at) {
    std::string text;
    for (const std::uint32_t axis : axes_between(machine, one)) {
        const bool is_rotary = machine.axes[axis].kind == AxisKind::rotary;
        text += fmt::format("{}{} {:.6g}{}", text.empty() ? "" : ", ", machine.axes[axis].name,
                            in_axis_units(machine.axes[axis], at.position[axis]),
                            is_rotary ? " deg" : "");
    }
    text += text.empty() ? "every position" : "";
    return at.tool == kNoIndex
               ? text
               : text + fmt::format(" with tool #{}", machine.tools[at.tool].number);
}

std::string verdict_of(const Machine& machine, const Exclusion& one, const PairOverTravel& found) {
    switch (found.verdict) {
        case TravelVerdict::never_near:
            return fmt::format("never nearer than {:.4g} mm", found.apart_mm);
        case TravelVerdict::always_near:
            return "in contact at every place";
        case TravelVerdict::both:
            return fmt::format("meets at {} and is apart at {}", place_of(machine, one, found.near),
                               place_of(machine, one, found.apart));
        case TravelVerdict::undecided:
            break;
    }
    return fmt::format("undecided after {} queries", found.queries);
}

/// The line to review; empty: there is nothing to do.
std::string doubt_of(const Exclusion& one, const PairOverTravel& found,
                     const std::string& verdict) {
    const bool is_proven =
        found.verdict == TravelVerdict::never_near || found.verdict == TravelVerdict::always_near;
    if (is_proven) {
        return one.because.empty() ? "" : verdict + ", so because explains nothing. Remove it.";
    }
    const bool is_explained = !one.because.empty() || one.reason.starts_with(kReviewMark);
    return is_explained ? ""
                        : verdict +
                              ", and no cycle sees it. Move the pair to pairs, or state because: "
                              "why this contact is acceptable.";
}

}  // namespace

std::vector<std::uint32_t> axes_between(const Machine& machine, const Exclusion& one) {
    const JointPath path = path_between(machine, one.a, one.b);
    std::vector<std::uint32_t> out;
    for (std::uint32_t axis = 0; axis < machine.axes.size(); ++axis) {
        for (std::uint32_t k = 0; k < path.count; ++k) {
            if (machine.bodies[path.body[k]].joint.axis == axis) {
                out.push_back(axis);
                break;
            }
        }
    }
    return out;
}

void report_exclusions(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    std::vector<Pair> pairs;
    for (const Exclusion& one : machine.exclusions) {
        pairs.push_back({.a = one.a, .b = one.b});
    }
    Progress progress;
    const auto show = [&progress](double share) {
        if (progress.is_due()) {
            progress.show(share, "proving exclusions");
        }
    };
    std::optional<std::vector<PairOverTravel>> found =
        judge_over_travel(report.loaded, std::move(pairs), {.progress = show});
    if (!found) {
        report.warnings.emplace_back(kNoMemoryForProofs);
        return;
    }
    if (!found->empty()) {
        fmt::print(report.words,
                   "\npairs not checked, over the travel and overrun (proven; in contact: within "
                   "{:g} mm, or one inside the other)\n",
                   kContactMm);
    }
    for (std::size_t i = 0; i < found->size(); ++i) {
        const Exclusion& one = machine.exclusions[i];
        const std::string verdict = verdict_of(machine, one, (*found)[i]);
        const std::string a = escaped(machine.bodies[one.a].name);
        const std::string b = escaped(machine.bodies[one.b].name);
        fmt::print(report.words, "  {:<24} {}{}{}\n", a + '-' + b, verdict,
                   one.because.empty() ? "" : "; because ", escaped(one.because, 512));
        if (const std::string doubt = doubt_of(one, (*found)[i], verdict); !doubt.empty()) {
            report.warnings.push_back(fmt::format("exclusion of {} and {}: {}", a, b, doubt));
        }
    }
    report.facts.exclusions = std::move(*found);
}

}  // namespace axg
