// SPDX-License-Identifier: Apache-2.0
// Formats the explanation of a stop as lines of the report.
#include <fmt/format.h>

#include <string>

#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/replay/why_stop.hpp"

namespace axg {
namespace {

constexpr const char* kProvenWith = "this sample is proven with: ";

std::string name_of(const Machine& machine, const StopWhy& why) {
    return pair_name(machine, why.pair) +
           (why.tool == kNoIndex ? "" : fmt::format(", tool {}", machine.tools[why.tool].number));
}

std::string available_text(const StopWhy& why) {
    if (why.available_mm <= 0) {
        return "has none";
    }
    return fmt::format("has {}{:.4f} mm", why.available_mm < why.within_mm ? "" : "at least ",
                       why.available_mm);
}

std::string parts_text(const StopWhy& why) {
    const DistanceNeed& need = why.need;
    std::string text;
    if (why.cause != WhyCause::margin && why.cause != WhyCause::capacity && why.is_whole) {
        text = fmt::format("motion to standstill {:.4f}, ", need.until_braking_mm);
    } else if (need.until_braking_mm + need.braking_mm + need.position_error_mm +
                   need.speed_uncertainty_mm >
               0) {
        text = fmt::format(
            "motion until braking {:.4f}, braking {:.4f}, uncertainty of position {:.4f}, of speed "
            "{:.4f}, ",
            need.until_braking_mm, need.braking_mm, need.position_error_mm,
            need.speed_uncertainty_mm);
    }
    return text + fmt::format("{} {:g}, arithmetic {:.2g} mm",
                              why.is_jog ? "clearance to keep in this jog" : "margin",
                              need.margin_mm, need.arithmetic_mm);
}

/// In brief without counts and lists.
std::string remedies_text(const StopWhy& why, Detail detail) {
    const bool is_full = detail == Detail::full;
    std::string text;
    const auto add = [&text](const std::string& remedy) {
        text += (text.empty() ? "" : "; ") + remedy;
    };
    const NeedRemedies& remedies = why.remedies;
    if (remedies.is_alone) {
        add(is_full ? "the lists of the cycle for this pair alone (cycle: in the machine file)"
                    : "a cycle for this pair alone");
    }
    if (remedies.speed_share) {
        add(*remedies.speed_share > 0
                ? fmt::format("{:.0f} % of this speed", *remedies.speed_share * 100)
                : "standstill");
    }
    if (remedies.margin_mm) {
        add(fmt::format("a margin of {:.3f} mm", *remedies.margin_mm));
    }
    if (remedies.queries) {
        add(is_full
                ? fmt::format("a larger plan, in which this pair takes {} queries (cycle: in the "
                              "machine file)",
                              *remedies.queries)
                : "a larger plan of the cycle");
    }
    if (remedies.are_other_limits) {
        add(is_full ? "limits as this trace shows them: " + why.other_limits
                    : "limits as in this trace");
    }
    return text;
}

/// Lists, parts and remedies.
std::string format_parts(const Machine& machine, const StopWhy& why) {
    std::string text = fmt::format("  why ({}): {} ", to_text(why.cause), name_of(machine, why));
    if (why.cause == WhyCause::contained) {
        return text + "is no matter of distance: one body is inside the other\n";
    }
    if (why.cause == WhyCause::not_known) {
        return text + "was not queried: too little is known of the motion to come\n";
    }
    text += fmt::format("needs {:.4f} mm and {}\n    {}\n", why.need.sum_mm(), available_text(why),
                        parts_text(why));
    if (why.has_reach) {
        text += why.worst_mm > 0
                    ? fmt::format("    worst case found, to standstill: {:.4f} mm\n", why.worst_mm)
                    : "    worst case found, to standstill: a contact\n";
    }
    if (why.open) {
        text += fmt::format(
            "    halving: {} queries; the first part left open needs {:.4f} mm and has {:.4f} mm\n",
            why.queries, why.open->needed_mm, why.open->available_mm);
    }
    if (why.is_list_full) {
        const char* const list = full_list(why.full);
        text += fmt::format("    a list of the engine was full{} (cycle: in the machine file)\n",
                            list == nullptr ? "" : fmt::format(": {}", list));
    }
    const std::string remedies = remedies_text(why, Detail::full);
    return text + (remedies.empty() ? "    nothing that was tried proves it\n"
                                    : fmt::format("    {}{}\n", kProvenWith, remedies));
}

}  // namespace

const char* full_list(QueryStatus status) noexcept {
    switch (status) {
        case QueryStatus::too_many_node_pairs:
            return "node_pairs";
        case QueryStatus::too_many_leaf_pairs:
            return "leaf_pairs";
        case QueryStatus::too_many_box_rows:
            return "box_rows";
        case QueryStatus::too_many_triangle_pairs:
            return "triangle_pairs";
        case QueryStatus::too_many_rechecks:
            return "rechecks";
        default:
            return nullptr;
    }
}

std::vector<std::string> why_sentences(const Machine& machine, const StopWhy& why) {
    const auto name = [&](std::uint32_t index) {
        const Body& body = machine.bodies[index];
        return body.is_tool && why.tool != kNoIndex
                   ? fmt::format("{} (tool {})", body.name, machine.tools[why.tool].number)
                   : body.name;
    };
    const Pair& pair = machine.pairs[why.pair];
    return why_sentences({.cause = why.cause,
                          .a = name(pair.a),
                          .b = name(pair.b),
                          .is_of_stop = why.has_reach,
                          .available_mm = why.available_mm,
                          .needed_mm = why.need.sum_mm(),
                          .margin_mm = why.need.margin_mm});
}

std::string format_why(const Machine& machine, const StopWhy& why, Detail detail) {
    std::string text;
    for (const std::string& sentence : why_sentences(machine, why)) {
        text += "  " + sentence + "\n";
    }
    if (detail == Detail::full) {
        return text + format_parts(machine, why);
    }
    const std::string remedies = remedies_text(why, Detail::brief);
    return text + (remedies.empty() ? "" : fmt::format("  {}{}\n", kProvenWith, remedies));
}

}  // namespace axg
