// SPDX-License-Identifier: Apache-2.0
// Formats the explanation of a stop as lines of the report.
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "firmware_if/setup/format_plan.hpp"
#include "hil_replay/replay/replay_csv.hpp"
#include "hil_replay/replay/why_stop.hpp"

namespace axg {
namespace {

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

std::string parts_text(const StopWhy& why, bool has_stated_errors) {
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
    return text + fmt::format("{} {:g}, arithmetic {}{:.2g} mm",
                              why.is_jog ? "clearance to keep in this jog" : "margin",
                              need.margin_mm, has_stated_errors ? "and stated errors " : "",
                              need.arithmetic_mm);
}

constexpr std::size_t kBriefAdviceLines = 5;
constexpr const char* kNotDriven =
    "  caps and commands ahead change the motion: axguard drive runs a program with them\n";

std::string gain_text(const AdvisedSetting& setting) {
    return setting.is_gone ? fmt::format("no stop for {:.1f} s", setting.after_s)
                           : fmt::format("{:.2f} mm nearer", setting.gain_mm);
}

/// The settings that gain, the best first; in brief as many as there is room for.
std::string advice_text(const Advice& advice, Detail detail) {
    const char* const missing = advice.was_driven ? "" : kNotDriven;
    if (advice.settings.empty()) {
        return fmt::format("  {} other settings were run: none stops {:g} mm nearer\n{}",
                           advice.tried, kAdviceGainMm, missing);
    }
    std::string text =
        "  nearer with these lines in the machine file, if they are true; each was run:\n";
    std::size_t printed = 0;
    for (const AdvisedSetting& setting : advice.settings) {
        if (detail == Detail::brief && printed + setting.lines.size() > kBriefAdviceLines) {
            continue;
        }
        for (std::size_t i = 0; i < setting.lines.size(); ++i, ++printed) {
            text += fmt::format(
                "    {:<19} {}{}\n", i == 0 ? gain_text(setting) : "", setting.lines[i],
                i == 0 && advice.is_of_trace && setting.is_driven ? "  # axguard drive" : "");
        }
    }
    return text + missing;
}

/// Lists and parts.
std::string format_parts(const Machine& machine, const StopWhy& why) {
    std::string text = fmt::format("  why ({}): {} ", to_text(why.cause), name_of(machine, why));
    if (why.cause == WhyCause::contained) {
        return text + "is no matter of distance: one body is inside the other\n";
    }
    if (why.cause == WhyCause::not_known) {
        return text + "was not queried: too little is known of the motion to come\n";
    }
    const bool is_enough = why.available_mm > 0 && why.available_mm >= why.need.sum_mm();
    text +=
        fmt::format("needs {:.4f} mm and {}{}\n    {}\n", why.need.sum_mm(), available_text(why),
                    is_enough ? ": the work of a cycle was short, not clearance" : "",
                    parts_text(why, machine.pose_errors.are_stated));
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
    if (why.whole) {
        text += fmt::format("    one query proves the whole reach, with {}\n",
                            format_lists(*why.whole));
    }
    if (why.is_list_full) {
        const char* const list = full_list(why.full);
        text += fmt::format("    a list of the engine was full{}\n",
                            list == nullptr ? "" : fmt::format(": {}", list));
    }
    return text;
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
    text += detail == Detail::full ? format_parts(machine, why) : "";
    return text + (why.advice ? advice_text(*why.advice, detail) : "");
}

}  // namespace axg
