// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/check/check_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "config/init/write_machine.hpp"
#include "config/text/quote_text.hpp"
#include "core/base/sincos.hpp"
#include "core/certificate/joint_path.hpp"
#include "core/guard/margin_advisory.hpp"
#include "core/mesh/mesh_check.hpp"
#include "core/reach/limit_evidence.hpp"
#include "firmware_if/cli/limit_text.hpp"
#include "firmware_if/protocol/axis_frames.hpp"
#include "firmware_if/setup/loaded_machine.hpp"

namespace axg {
namespace {

/// The containment test cannot find a body inside an open shell; it still finds bodies inside the
/// closed shells of the same surface.
std::string closure_of(const MeshReport& mesh) {
    if (mesh.open_shells == 0) {
        return "closed";
    }
    return mesh.open_shells >= mesh.shells
               ? "OPEN: bodies inside are not detected"
               : fmt::format("{} OPEN: bodies inside {} are not detected", mesh.open_shells,
                             mesh.open_shells == 1 ? "it" : "them");
}

std::string format_mesh(const MeshReport& mesh) {
    const Vec3d size = widen(mesh.max_mm) - widen(mesh.min_mm);
    return fmt::format("{:>8} triangles  {:>9.6g} x {:>9.6g} x {:>9.6g} mm  {} {}  {}",
                       mesh.facet_count, size.x, size.y, size.z, mesh.shells,
                       mesh.shells == 1 ? "shell" : "shells", closure_of(mesh));
}

/// "#1 (ball nose 12)"; a tool need not have a name.
std::string title_of(const Tool& tool) {
    return fmt::format("#{}{}", tool.number,
                       tool.name.empty() ? "" : " (" + escaped(tool.name) + ')');
}

std::string format_clearance_levels(const Pair& pair) {
    std::string text;
    for (const auto& [name, level_mm] :
         {std::pair{"slow", pair.slow_mm}, std::pair{"warn", pair.warn_mm}}) {
        text += level_mm > 0 ? fmt::format(", {} within {:.6g} mm more", name, level_mm) : "";
    }
    return text;
}

/// A machine of inches read as millimetres loads, and moves ten times as far as it is large.
void warn_of_scale(CheckReport& report) {
    constexpr double kLeastShare = 0.2, kMostShare = 20;
    double size_mm = 0, travel_mm = 0;
    for (const Mesh& mesh : report.loaded.meshes.bodies) {
        const BodyExtent extent = extent_of(mesh);
        const Vec3d size = extent.high_mm - extent.low_mm;
        size_mm = std::max({size_mm, size.x, size.y, size.z});
    }
    for (const Axis& axis : report.loaded.machine.axes) {
        const bool counts = axis.kind == AxisKind::linear;
        travel_mm = counts ? std::max(travel_mm, axis.max - axis.min) : travel_mm;
    }
    const double share = travel_mm > 0 ? size_mm / travel_mm : 1;
    if (share < kLeastShare || share > kMostShare) {
        report.warnings.push_back(
            fmt::format("the largest body is {:.4g} mm long, the longest travel {:.4g} mm. Check "
                        "the unit of the meshes.",
                        size_mm, travel_mm));
    }
}

/// From bottom to top of each, in the tool's own frame.
void report_sections(CheckReport& report, const Tool& tool) {
    for (const Shape& section : tool.mesh.shapes) {
        if (section.name.empty()) {
            continue;  // a profile alone
        }
        const MeshReport& facts =
            report.facts.sections.emplace_back(check_mesh(triangles_of(section).triangles));
        fmt::print(report.words, "    {:<22} z {:.6g} to {:.6g} mm{}\n", section.name,
                   widen(facts.min_mm).z, widen(facts.max_mm).z,
                   section.is_cutting ? ", cutting: may touch stock" : "");
    }
}

}  // namespace

double stopping_distance(const Axis& axis) noexcept {
    return axis.speed_max * axis.speed_max / (2 * axis.stopping_min);
}

double stopping_time_s(const Axis& axis) noexcept {
    return axis.speed_max / axis.stopping_min;
}

std::vector<double> blind_speeds(const Machine& machine) {
    const LimitRules rules = limit_rules(machine, axis_units(machine));
    std::vector<double> out;
    for (std::uint32_t i = 0; i < machine.axes.size(); ++i) {
        out.push_back(blind_speed(rules, i));
    }
    return out;
}

namespace {

/// Speeds of each axis above which the certificate detects a frozen encoder.
std::string blind_line(const Machine& machine) {
    std::string text;
    const std::vector<double> speeds = blind_speeds(machine);
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        const Axis& axis = machine.axes[i];
        const bool rotary = axis.kind == AxisKind::rotary;
        text += text.empty() ? "" : ", ";
        text += speeds[i] < axis.speed_max
                    ? fmt::format("{} {:.3g} {}", axis.name, in_axis_units(axis, speeds[i]),
                                  rotary ? "deg/s" : "mm/s")
                    : axis.name + " never";
    }
    return text;
}

/// Errors that the file does not state are guesses of this program, not of its author.
void warn_of_guessed_errors(CheckReport& report) {
    std::string position, following;
    for (const Axis& axis : report.loaded.machine.axes) {
        position += axis.states_position_error ? "" : ' ' + axis.name;
        following += axis.states_following_error ? "" : ' ' + axis.name;
    }
    if (!position.empty()) {
        report.warnings.push_back("axes: position_error_... is not stated for" + position +
                                  ": 0.001 mm or 0.0005 degrees is assumed. State it.");
    }
    if (!following.empty()) {
        report.warnings.push_back(
            "axes: following_error_... is not stated for" + following +
            ": 0 is assumed, valid only if the board reports encoder positions. State it.");
    }
}

/// A stop without a limit of jerk begins at once, and no servo does.
void warn_of_no_jerk(CheckReport& report) {
    std::string without;
    for (const Axis& axis : report.loaded.machine.axes) {
        without += has_jerk_limit(axis) ? "" : ' ' + axis.name;
    }
    if (!without.empty()) {
        report.warnings.push_back(
            "axes: jerk_...: none for" + without +
            ": guard.board_reaction_ms has to include the rise time of the deceleration.");
    }
}

}  // namespace

void report_axes(CheckReport& report) {
    warn_of_guessed_errors(report);
    warn_of_no_jerk(report);
    fmt::print(
        report.words,
        "\naxes (stopping: guaranteed braking from full speed, without the reaction time)\n");
    for (const Axis& axis : report.loaded.machine.axes) {
        const bool rotary = axis.kind == AxisKind::rotary;
        const double unit = rotary ? 180.0 / kPi : 1.0;
        const char* name = rotary ? "deg" : "mm";
        const double distance = stopping_distance(axis);
        if (!axis.unlimited && distance > axis.max - axis.min) {
            report.warnings.push_back(
                fmt::format("axis {}: stopping from full speed takes {:.4g} {}, more than its "
                            "travel of {:.4g} {}. Check speed and stopping.",
                            axis.name, distance * unit, name, (axis.max - axis.min) * unit, name));
        }
        const std::string travel =
            axis.unlimited
                ? "unlimited"
                : fmt::format("{:.6g} to {:.6g} {}", axis.min * unit, axis.max * unit, name);
        fmt::print(
            report.words,
            "  {:<4} {}  {:<24} {:>9.6g} {}/s  acceleration {:.6g} {}/s2, jerk {}  stops in {:.4g} "
            "{}, {:.4g} ms\n",
            axis.name, rotary ? "rotary" : "linear", travel, axis.speed_max * unit, name,
            axis.acceleration_max * unit, name,
            has_jerk_limit(axis) ? fmt::format("{:.6g} {}/s3", axis.jerk_max * unit, name) : "none",
            distance * unit, name, stopping_time_s(axis) * 1000);
    }
    fmt::print(report.words, "  a frozen encoder is detected above: {}\n",
               blind_line(report.loaded.machine));
}

void report_bodies(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    fmt::print(report.words, "\nbodies\n");
    for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
        const Body& body = machine.bodies[i];
        const bool moves = body.joint.axis != kNoIndex;
        const std::string parent =
            body.parent == kNoIndex ? "the machine" : machine.bodies[body.parent].name;
        MeshReport& facts = report.facts.bodies.emplace_back();
        std::string surface = body.is_tool ? "the tool in the spindle" : "no surface";
        if (!body.is_tool && body.has_mesh) {
            facts = check_mesh(report.loaded.meshes.bodies[i].triangles);
            surface = format_mesh(facts) + (body.is_stock ? ", stock" : "");
        }
        const std::string joint = moves ? "axis " + machine.axes[body.joint.axis].name : "fixed";
        fmt::print(report.words, "  {:<16} {:<8} on {:<16} {}\n", body.name, joint, parent,
                   surface);
    }
    warn_of_scale(report);
    for (const auto* doubts : {&report.loaded.source.doubts, &report.loaded.doubts}) {
        report.warnings.insert(report.warnings.end(), doubts->begin(), doubts->end());
    }
    for (const std::string& note : report.loaded.meshes.notes) {
        fmt::print(report.words, "  note: {}\n", escaped(note, 400));
    }
}

void report_tools(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    if (machine.tools.empty()) {
        fmt::print(report.words, "\ntools: none\n");
        report.warnings.push_back(
            "no tool: the spindle is checked empty. Add a body with tool: true, tools and its "
            "pairs.");
        return;
    }
    fmt::print(report.words, "\ntools ({} in the spindle at the start)\n",
               machine.first_tool == 0 ? "none" : fmt::format("#{}", machine.first_tool));
    for (std::size_t i = 0; i < machine.tools.size(); ++i) {
        const Tool& tool = machine.tools[i];
        const MeshReport& mesh =
            report.facts.tools.emplace_back(check_mesh(report.loaded.meshes.tools[i].triangles));
        fmt::print(report.words, "  {:<24} length {:.6g} mm {}\n", title_of(tool), tool.length_mm,
                   format_mesh(mesh));
        report_sections(report, tool);
    }
    if (machine.first_tool == 0) {
        report.warnings.push_back("first_tool: 0: no tool is checked until the first tool change");
    }
}

void report_pairs(CheckReport& report) {
    const Machine& machine = report.loaded.machine;
    fmt::print(report.words, "\npairs checked: {}\n", machine.pairs.size());
    for (const Pair& pair : machine.pairs) {
        fmt::print(report.words, "  {:<16} {:<16} margin {:.6g} mm{}\n",
                   machine.bodies[pair.a].name, machine.bodies[pair.b].name, pair.margin_mm,
                   format_clearance_levels(pair));
    }
    fmt::print(report.words, "\npairs not checked: {}\n", machine.exclusions.size());
    for (const Exclusion& one : machine.exclusions) {
        const std::string both = machine.bodies[one.a].name + " and " + machine.bodies[one.b].name;
        fmt::print(report.words, "  {:<16} {:<16} {}\n", machine.bodies[one.a].name,
                   machine.bodies[one.b].name, escaped(one.reason, 512));
        if (one.reason.starts_with(kReviewMark)) {
            report.warnings.push_back("exclusion of " + both +
                                      ": the reason is the placeholder of init. Write your own, or "
                                      "move the pair to pairs.");
        }
    }
}

void report_guesses(CheckReport& report, const std::string& file) {
    const std::string& text = report.loaded.source.text;
    int line = 1;
    for (std::size_t at = 0; at < text.size(); ++line) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string one = text.substr(at, end - at);
        if (const std::size_t mark = one.find(kGuessMark); mark != std::string::npos) {
            const std::size_t first = std::min(one.find_first_not_of(" -"), mark);
            const std::size_t last = one.find_last_not_of(' ', mark == 0 ? 0 : mark - 1);
            const std::string what =
                first < mark ? one.substr(first, last + 1 - first) : one.substr(mark);
            report.warnings.push_back(fmt::format("{}:{}: unconfirmed guess of init: {}",
                                                  escaped(file, 4096), line, escaped(what, 72)));
        }
        at = end + 1;
    }
}

std::vector<bool> guessed_joints(const LoadedMachine& loaded) {
    const std::vector<Body>& bodies = loaded.machine.bodies;
    std::vector<bool> out(bodies.size());
    const std::string& text = loaded.source.text;
    auto body = bodies.end();
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string line = text.substr(at, end - at);
        at = end + 1;
        if (const std::size_t key = line.find("name: "); key != std::string::npos) {
            const std::size_t first = key + 6;
            const std::string name =
                line.substr(first, line.find_first_of(" ,}#\r", first) - first);
            body = std::find_if(bodies.begin(), bodies.end(),
                                [&](const Body& one) { return one.name == name; });
        }
        const bool is_joint = line.find("pivot_mm:") != std::string::npos ||
                              line.find("direction:") != std::string::npos;
        if (body != bodies.end() && is_joint && line.find(kGuessMark) != std::string::npos) {
            out[static_cast<std::size_t>(body - bodies.begin())] = true;
        }
    }
    return out;
}

}  // namespace axg
