// SPDX-License-Identifier: Apache-2.0
#include "config/init/write_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "config/text/quote_text.hpp"

namespace axg {
namespace {

constexpr double kThinMm = 0.001;  // a thinner tool is one without a diameter
constexpr std::uint32_t kToolNumberMax = 65535;
constexpr std::string_view kAxisOrder = "XYZABCUVW";

// Each starts with a blank line.
constexpr const char* kHead =
    R"(
# Machine file, written by axguard init. Lines marked GUESS contain values that the meshes do not
# define: confirm or correct each, then remove the mark; axguard check lists the remaining marks.
# Lengths in mm, angles in degrees, directions and points in machine coordinates, all axes at 0.
version: 1
)";
constexpr const char* kAxesHead =
    R"(
# slot is the position of an axis in the CAN frames. Copy travel and speeds from the control;
# stopping_... is the deceleration that the drives guarantee in an emergency stop, with the
# heaviest workpiece. position_error_... is the largest error of the encoder, following_error_...
# the largest distance from the commanded position, if the board reports commanded positions.
axes:
)";
constexpr const char* kBodiesHead =
    R"(
# List parents before children. The parent of a body without key parent is the machine's frame.
bodies:
)";
constexpr const char* kToolsHead =
    R"(
# Every tool of the machine, by number; at_mm is its position in the spindle. The guard checks the
# volume that a tool sweeps about the spindle's axis; for a probe, set turns: false.
tools:
)";
constexpr const char* kNoTools =
    R"(
# No tool is checked yet. Below the spindle's body add one that it carries, then its pairs, and
# the tools:
#   - name: cutter
#     parent: (the spindle's body)
#     tool: true
# tools:
#   - number: 1
#     name: drill 8
#     length_mm: 90
#     profile_mm: [[0, -90], [4, -86], [4, -40], [20, -40], [20, 0], [0, 0]]
)";
constexpr const char* kPairsHead =
    R"(
# Pairs that may collide. margin_mm is the distance that a pair has to keep.
)";
// Between the head and its key: the edits of a user who adds the tool above begin below this.
constexpr const char* kNoToolPairs =
    R"(# A tool needs its pairs here:
#   - {a: cutter, b: [(every body but the spindle's)], margin_mm: 1}
# and below exclusions:
#   - {a: (the spindle's body), b: cutter, reason: the spindle holds the tool}
)";
constexpr const char* kExclusionsHead =
    R"(
# Pairs that are not checked. Replace each proposed reason with your own, or move the pair
# to pairs.
exclusions:
)";

/// By the joint that a file states, else by the letter.
bool is_rotary(const std::string& axis, const std::vector<IniAxis>& known) {
    const auto stated = std::find_if(known.begin(), known.end(),
                                     [&axis](const IniAxis& one) { return one.name == axis; });
    return stated != known.end() ? stated->is_rotary : axis == "A" || axis == "B" || axis == "C";
}

std::string precise(Vec3d v) {
    return fmt::format("[{:.10g}, {:.10g}, {:.10g}]", v.x, v.y, v.z);
}

std::string direction_of(const RoleGuess& role) {
    if (role.direction != Vec3d{}) {
        return precise(role.direction);
    }
    const std::size_t axis = kAxisOrder.find(role.axis) % 3;  // A and U are along X
    if (role.is_stated ? role.is_reversed : role.is_table_side) {
        return axis == 0 ? "[-1, 0, 0]" : axis == 1 ? "[0, -1, 0]" : "[0, 0, -1]";
    }
    return axis == 0 ? "[1, 0, 0]" : axis == 1 ? "[0, 1, 0]" : "[0, 0, 1]";
}

std::string numbers(Vec3d v) {
    return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x, v.y, v.z);
}

std::string mesh_of(const SurveyedMesh& mesh) {
    const MeshSource& source = mesh.source;
    std::string text = fmt::format("{{file: {}, unit: {}, size_mm: {}", quoted(source.file, 4096),
                                   name_of(source.unit), numbers(source.expected_size_mm));
    text += source.allow_open ? ", allow_open: true" : "";
    text += source.allow_self_intersection ? ", allow_self_intersection: true" : "";
    text += source.allow_degenerate ? ", allow_degenerate: true" : "";
    return text + '}';
}

/// Guessed errors: of an encoder, and 0 for a board that reports measured positions.
const char* errors_text(bool is_rotary) noexcept {
    return is_rotary ? "position_error_deg: 0.0005, following_error_deg: 0"
                     : "position_error_mm: 0.001, following_error_mm: 0";
}

// LinuxCNC exceeds its own limits: where moves blend it adds two accelerations, and kinematics for
// the tip limit no joint (docs/measurements/linuxcnc.md).
constexpr double kOverIni = 2;
constexpr const char* kOverIniHead =
    R"(# LinuxCNC exceeds the limits of its INI file where moves blend, so acceleration_... is twice
# MAX_ACCELERATION; with kinematics for the tip, speed_... is also twice MAX_VELOCITY. Twice is
# guessed, and LinuxCNC 2.10 goes beyond it. Measure it: run programs in the air with
#   axguard-hal ... --record run.log, then axguard inspect run.log --machine THIS-FILE --limits
# and paste the lines that it prints, with what they rest on. If a drive cannot do twice,
# halve the values of the INI file instead. stopping_... is MAX_ACCELERATION, by which LinuxCNC
# brakes: state less if a drive with the heaviest workpiece does not keep it. jerk_...: none, for
# LinuxCNC limits no jerk of an axis: PLANNER_TYPE = 1 limits the path's, and G64 R0 ends that.
)";
constexpr const char* kGantryHead =
    R"(# skew_mm: so far two joints of one axis may be apart, at least twice following_error_mm. The
# proof allows for it, and axguard_stop, loaded with coordinates= of KINEMATICS, gives no permit
# beyond it. Points farther from the middle than the rails are apart it does not cover.
)";

/// The guessed deceleration of a stop, with its price: so much longer is the stop from full speed
/// if only half of it is true. LinuxCNC brakes each joint by its MAX_ACCELERATION.
std::string stopping_guess(const IniAxis& axis, double speed, double stopping) {
    const double half_costs = 0.5 * speed * speed / stopping;
    return axis.acceleration
               ? fmt::format(
                     "stopping as the control brakes (half of it: {:.3g} {} more from full "
                     "speed)",
                     half_costs, axis.is_rotary ? "deg" : "mm")
               : "stopping";
}

/// Travel, speed and acceleration from the control's INI file. The file states no stop, only full
/// acceleration.
/// @param has_no_jerk  the control limits none
std::string known_axis_text(const IniAxis& axis, bool has_no_jerk) {
    const char* const unit = axis.is_rotary ? "deg" : "mm";
    const double full = axis.acceleration.value_or(axis.is_rotary ? 500 : 1000);
    const double acceleration = full * (axis.acceleration ? kOverIni : 1);
    const double speed = axis.speed.value_or(axis.is_rotary ? 90 : 10000.0 / 60) *
                         (axis.speed && axis.follows_tip ? kOverIni : 1);
    const double stopping = axis.braking.value_or(axis.acceleration.value_or(0.8 * full));
    std::string guesses =
        stopping_guess(axis, speed, stopping) + ", position_error, following_error";
    std::string travel = "unlimited";
    if (!axis.is_unlimited) {
        const double far = axis.is_rotary ? 90 : 200;
        travel =
            fmt::format("[{:.9g}, {:.9g}]", axis.min.value_or(axis.max.value_or(far) - 2 * far),
                        axis.max.value_or(axis.min.value_or(-far) + 2 * far));
        guesses += axis.min && axis.max ? "" : ", travel";
    }
    guesses += axis.speed ? "" : ", speed";
    guesses += ", acceleration";
    guesses += has_no_jerk ? "" : ", jerk";
    guesses += !axis.is_gantry  ? ""
               : axis.is_rotary ? "; axguard_stop takes no second joint of a rotary axis"
                                : ", skew";
    return fmt::format(
        "  {}: {{kind: {}, travel_{}: {}, speed_{}: {:.9g}, acceleration_{}_s2: {:.9g}, "
        "jerk_{}_s3: none, stopping_{}_s2: {:.9g}, {}{}}}  {}: {}\n",
        axis.name, axis.is_rotary ? "rotary" : "linear", unit, travel,
        axis.is_rotary ? "deg_s" : "mm_min", speed * (axis.is_rotary ? 1 : 60), unit, acceleration,
        unit, unit, stopping, axis.is_gantry && !axis.is_rotary ? "skew_mm: 0.1, " : "",
        errors_text(axis.is_rotary), kGuessMark, guesses);
}

/// An axis of the file, with its place on the bus.
std::string with_slot(std::string axis_text, int slot) {
    return axis_text.insert(axis_text.find('{') + 1, fmt::format("slot: {}, ", slot));
}

/// X to W, then the other axes in their order.
std::vector<std::string> axis_names(const std::vector<IniAxis>& known) {
    std::vector<std::string> names;
    for (const char letter : kAxisOrder) {
        names.emplace_back(1, letter);
    }
    for (const IniAxis& axis : known) {
        if (axis.name.size() > 1) {
            names.push_back(axis.name);
        }
    }
    return names;
}

std::string axes_text(const std::vector<RoleGuess>& roles, const IniAxes& ini) {
    const std::vector<IniAxis>& known = ini.axes;
    std::string text = kAxesHead;
    text.insert(text.rfind("axes:"), known.empty() || !ini.exceeds_limits ? "" : kOverIniHead);
    const bool has_gantry = std::any_of(known.begin(), known.end(), [](const IniAxis& axis) {
        return axis.is_gantry && !axis.is_rotary;
    });
    text.insert(text.rfind("axes:"), has_gantry ? kGantryHead : "");
    int slot = 0;
    for (const std::string& axis : axis_names(known)) {
        const bool used = std::any_of(roles.begin(), roles.end(),
                                      [&axis](const RoleGuess& role) { return role.axis == axis; });
        const auto stated = std::find_if(known.begin(), known.end(),
                                         [&axis](const IniAxis& one) { return one.name == axis; });
        if (stated != known.end()) {
            const std::string values = known_axis_text(*stated, ini.exceeds_limits);
            text +=
                used ? with_slot(values, slot++)
                     : fmt::format("  # {} of the INI file: give it to the body that it moves\n  #",
                                   axis) +
                           values.substr(1);
        } else if (used) {
            const char* const values =
                axis == "C" ? "{kind: rotary, travel_deg: unlimited, speed_deg_s: 90, "
                              "acceleration_deg_s2: 500, jerk_deg_s3: 10000, stopping_deg_s2: 400"
                : is_rotary(axis, known)
                    ? "{kind: rotary, travel_deg: [-90, 90], speed_deg_s: 90, "
                      "acceleration_deg_s2: 500, jerk_deg_s3: 10000, stopping_deg_s2: 400"
                    : "{kind: linear, travel_mm: [-200, 200], speed_mm_min: 10000, "
                      "acceleration_mm_s2: 1000, jerk_mm_s3: 20000, stopping_mm_s2: 800";
            text += with_slot(fmt::format("  {}: {}, {}}}  {}: each number\n", axis, values,
                                          errors_text(is_rotary(axis, known)), kGuessMark),
                              slot++);
        }
    }
    return text;
}

bool has_tools(const std::vector<RoleGuess>& roles) {
    return std::any_of(roles.begin(), roles.end(),
                       [](const RoleGuess& role) { return role.is_tool; });
}

/// Behind a value; of one that is stated, nothing unless there is a doubt about it.
std::string guess_of(const RoleGuess& role, const std::string& why, const std::string& doubt = {}) {
    const std::string& reason = role.is_stated ? doubt : why;
    return reason.empty() ? std::string() : fmt::format("  {}: {}", kGuessMark, reason);
}

std::string joint_text(const RoleGuess& role, const Vec3d& middle, bool is_turning) {
    if (role.axis.empty()) {
        return role.is_stated || role.is_tool
                   ? ""
                   : fmt::format("    {}: fixed to {}; if it moves, add axis and direction\n",
                                 kGuessMark,
                                 role.parent == kNoParent ? "the machine's frame" : "its parent");
    }
    std::string text = fmt::format(
        "    axis: {}{}{}\n"
        "    direction: {}{}\n",
        role.axis, role.axis_note.empty() ? "" : "  # " + role.axis_note,
        guess_of(role, "from the name of the file"), direction_of(role),
        guess_of(role,
                 fmt::format("a positive command moves{} this body this way",
                             is_turning ? " (turns, right hand)" : ""),
                 role.way_doubt));
    if (is_turning) {
        text += fmt::format(
            "    pivot_mm: {}{}\n", role.is_stated ? precise(role.pivot_mm) : numbers(middle),
            guess_of(role, "the middle of the mesh; a point on the axis it turns about",
                     role.pivot_doubt));
    }
    return text;
}

/// @param mesh  null: a body of shapes, or a bare link
std::string body_text(const RoleGuess& role, const SurveyedMesh* mesh,
                      const std::vector<RoleGuess>& roles, const std::vector<IniAxis>& known) {
    std::string text = fmt::format("  - name: {}\n", role.name);
    if (role.parent != kNoParent) {
        text += fmt::format("    parent: {}{}\n", roles[role.parent].name,
                            guess_of(role, "what carries it"));
    }
    const Vec3d middle = mesh == nullptr ? Vec3d{} : 0.5 * (mesh->min_mm + mesh->max_mm);
    text += joint_text(role, middle, is_rotary(role.axis, known));
    if (role.is_tool) {
        return text +
               (mesh == nullptr
                    ? "    tool: true\n"
                    : fmt::format("    tool: true  {}: from the name of the file\n", kGuessMark));
    }
    if (mesh == nullptr && role.shapes.empty()) {
        return text;
    }
    if (mesh != nullptr) {
        for (const std::string& note : mesh->notes) {
            text += "    # Repair the mesh or accept: " + escaped(note, 400) + '\n';
        }
    }
    text +=
        fmt::format("    at_mm: {}{}\n", role.is_stated ? precise(role.at_mm) : numbers(role.at_mm),
                    guess_of(role, "the mesh is drawn in machine coordinates"));
    if (role.rotate_deg != Vec3d{}) {
        text += fmt::format("    rotate_deg: {}\n", precise(role.rotate_deg));
    }
    return text + "    mesh: " +
           (mesh == nullptr ? fmt::format("{{shapes: [{}]}}", role.shapes) : mesh_of(*mesh)) + '\n';
}

/// A tool of the control's table: a cylinder, without the shank and holder that it does not state.
std::string table_tool_text(const TableTool& tool) {
    if (!is_measured(tool)) {
        return fmt::format("  # {}: tool {} has no length above 0: measure it\n", tool.source,
                           tool.number);
    }
    const double radius_mm = std::fabs(tool.diameter_mm.value_or(0)) / 2;
    const double drawn_mm = radius_mm > kThinMm ? radius_mm : 5;
    std::string text = fmt::format("  - number: {}  # {}\n", tool.number, tool.source);
    text += tool.comment.empty() ? "" : fmt::format("    name: {}\n", quoted(tool.comment, 100));
    text += radius_mm > 0 ? fmt::format("    diameter_mm: {:.9g}\n", *tool.diameter_mm) : "";
    return text + fmt::format(
                      "    length_mm: {0:.9g}  {2}: if the table counts from the spindle nose\n"
                      "    profile_mm: [[0, -{0:.9g}], [{1:.9g}, -{0:.9g}], [{1:.9g}, 0], [0, 0]]  "
                      "{2}: {3}add shank and holder\n",
                      tool.length_mm, drawn_mm, kGuessMark,
                      drawn_mm == radius_mm ? "" : "the table states no diameter; ");
}

std::string tools_text(const std::vector<SurveyedMesh>& meshes, const std::vector<RoleGuess>& roles,
                       const ToolTable& table) {
    std::string text;
    bool is_drawn = false;  // a file is tool 1
    for (const RoleGuess& role : roles) {
        if (!role.is_tool || role.file == kNoFile) {
            continue;
        }
        is_drawn = true;
        const SurveyedMesh& mesh = meshes[role.file];
        for (const std::string& note : mesh.notes) {
            text += "  # Repair the mesh or accept: " + escaped(note, 400) + '\n';
        }
        // A tool drawn below the nose is not moved; one drawn upwards is hung by its top.
        const bool hangs = mesh.min_mm.z < 0;
        const double top_mm = hangs ? 0 : mesh.max_mm.z;
        text += fmt::format("  - number: 1  {}\n    length_mm: {:.6g}  {}: spindle nose to tip\n",
                            kGuessMark, top_mm - mesh.min_mm.z, kGuessMark);
        text += fmt::format(
            "    at_mm: [0, 0, {:.6g}]  {}: where it sits at the zero pose\n    mesh: {}\n",
            0 - top_mm, kGuessMark, mesh_of(mesh));
    }
    for (const std::string& fault : table.faults) {
        text += "  # " + fault + '\n';
    }
    std::size_t count = is_drawn ? 1 : 0;
    for (const TableTool& tool : table.tools) {
        if (is_drawn && tool.number == 1) {
            text +=
                fmt::format("  # {}: tool 1 has length {:.9g} mm\n", tool.source, tool.length_mm);
        } else if (tool.number <= kToolNumberMax && ++count <= kToolsMax) {
            text += table_tool_text(tool);
        } else {
            text += fmt::format("  # {}: tool {} is left out: at most {} tools, up to {}\n",
                                tool.source, tool.number, kToolsMax, kToolNumberMax);
        }
    }
    return has_tools(roles) ? kToolsHead + text : kNoTools + text;
}

/// The nearest body up the chain, itself included, that an axis moves; kNoParent: the frame carries
/// it.
std::uint32_t mover_of(const std::vector<RoleGuess>& roles, std::uint32_t body) noexcept {
    while (body != kNoParent && roles[body].axis.empty()) {
        body = roles[body].parent;
    }
    return body;
}

/// Why a pair should not be checked; empty when it should.
std::string reason_of(const std::vector<RoleGuess>& roles, std::uint32_t a, std::uint32_t b) {
    if (mover_of(roles, a) == mover_of(roles, b)) {
        return "no axis moves them against each other";
    }
    const auto carries = [&](std::uint32_t carrier, std::uint32_t body) {
        const RoleGuess& role = roles[body];
        const bool by_frame = role.parent == kNoParent && mover_of(roles, carrier) == kNoParent;
        return !role.axis.empty() && (role.parent == carrier || by_frame);
    };
    return carries(a, b) || carries(b, a)
               ? "one carries the other, so bearings or ways may overlap in the meshes"
               : "";
}

/// The reason among the proposed ones; empty: none, so the pair is checked.
std::string reason_in(const std::vector<ProposedExclusion>& proposed, std::uint32_t a,
                      std::uint32_t b) {
    const auto one = std::find_if(proposed.begin(), proposed.end(),
                                  [&](const auto& each) { return each.a == a && each.b == b; });
    return one == proposed.end() ? std::string() : one->reason;
}

std::string pairs_text(const std::vector<RoleGuess>& roles,
                       const std::vector<ProposedExclusion>* proposed) {
    std::string checked;
    std::string excluded;
    const auto count = static_cast<std::uint32_t>(roles.size());
    const auto has_surface = [&roles](std::uint32_t body) {
        return roles[body].file != kNoFile || !roles[body].shapes.empty() || roles[body].is_tool;
    };
    for (std::uint32_t a = 0; a < count; ++a) {
        for (std::uint32_t b = a + 1; b < count; ++b) {
            if (!has_surface(a) || !has_surface(b)) {
                continue;
            }
            const std::string reason =
                proposed == nullptr ? reason_of(roles, a, b) : reason_in(*proposed, a, b);
            if (reason.empty()) {
                checked += fmt::format("  - {{a: {}, b: {}, margin_mm: 0}}\n", roles[a].name,
                                       roles[b].name);
            } else {
                excluded += fmt::format("  - {{a: {}, b: {}, reason: \"{} {}\"}}\n", roles[a].name,
                                        roles[b].name, kReviewMark, reason);
            }
        }
    }
    if (checked.empty() && count >= 2) {  // a guard must guard something: the first pair is checked
        const std::size_t end = excluded.find('\n') + 1;
        excluded.erase(0, end);
        checked = fmt::format("  - {{a: {}, b: {}, margin_mm: 0}}\n", roles[0].name, roles[1].name);
    }
    std::string text = kPairsHead;
    text += has_tools(roles) ? "" : kNoToolPairs;
    text += "pairs:\n" + checked;
    if (!excluded.empty()) {
        text += kExclusionsHead + excluded;
    }
    return text;
}

/// The section `program`, each line with its source; without an INI file its form, as a comment.
std::string program_text(const IniAxes& ini, const std::vector<RoleGuess>& roles) {
    const std::vector<IniSetting>& settings = ini.program;
    std::string doubts, text;
    for (const std::string& doubt : ini.program_doubts) {
        doubts += fmt::format("{}: {}\n", kGuessMark, doubt);
    }
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const IniSetting& first = settings[i];
        if (first.letter == 0) {
            text += fmt::format("  {}: {}  # {}\n", first.key, first.value, first.source);
            continue;
        }
        std::string values;
        for (; i < settings.size() && settings[i].key == first.key; ++i) {
            const IniSetting& one = settings[i];
            const bool is_used = std::any_of(roles.begin(), roles.end(), [&](const RoleGuess& r) {
                return r.axis == std::string(1, one.letter);
            });
            values +=
                is_used ? fmt::format("{}{}: {}", values.empty() ? "" : ", ", one.letter, one.value)
                        : "";
        }
        --i;
        if (!values.empty()) {
            text += fmt::format("  {}: {{{}}}  # {}\n", first.key, values, first.source);
        }
    }
    const std::string section = text.empty()
                                    ? "; simulate names a key that it needs.\n"
                                      "# program: {start_unit: mm, rotary: {C: programmed}}\n"
                                    : ".\nprogram:\n" + text;
    return "\n" + doubts + "# What decides the meaning of a program" + section;
}

/// Rounds to microseconds; the rest uses part of the 1 % that every proof allows the period.
std::string period_text(std::int64_t period_ns) {
    if (period_ns == 0) {
        return {};
    }
    const std::int64_t sample_us = (period_ns + 500) / 1000;
    const double off = 100.0 * static_cast<double>(period_ns - 1000 * sample_us) /
                       (1000.0 * static_cast<double>(sample_us));
    const std::string rest =
        off == 0 ? ""
                 : fmt::format("; {:.3f} % of the 1 % that the period may be off", std::abs(off));
    return fmt::format("  sample_us: {}  # SERVO_PERIOD is {} ns{}\n", sample_us, period_ns, rest);
}

/// Empty where the format [classical] can carry each tool's number, and has an identifier for each
/// frame of axes.
std::string format_text(const std::vector<TableTool>& tools, std::size_t axis_count) {
    constexpr std::uint32_t kClassicalMost = 255;
    constexpr std::size_t kClassicalAxes = 7;
    if (axis_count > kClassicalAxes) {
        return fmt::format("  format: fd  # one frame has room for {} axes\n", axis_count);
    }
    const auto large = std::find_if(tools.begin(), tools.end(), [](const TableTool& tool) {
        return tool.number > kClassicalMost;
    });
    return large == tools.end()
               ? ""
               : fmt::format("  format: fd  # classical has no room for tool {}\n", large->number);
}

}  // namespace

std::string machine_file_text(const std::string& name, const std::vector<SurveyedMesh>& meshes,
                              const std::vector<RoleGuess>& roles, const IniAxes& ini,
                              const std::vector<ProposedExclusion>* exclusions) {
    const std::int64_t period_ns = ini.servo_period_ns.value_or(0);
    std::string text = fmt::format("{}name: {}\n", kHead + 1, quoted(name, 128));
    text += axes_text(roles, ini) + program_text(ini, roles) + kBodiesHead;
    for (const RoleGuess& role : roles) {
        text +=
            body_text(role, role.file == kNoFile ? nullptr : &meshes[role.file], roles, ini.axes);
    }
    text += tools_text(meshes, roles, ini.tools);
    text += pairs_text(roles, exclusions);
    text += fmt::format(
        "\n# What the board guarantees in a stop. jerk_limited: jerk stays limited, and an axis "
        "may "
        "reverse\n# for that; none: no axis reverses in a stop.\n"
        "guard:\n  stop_reversal: jerk_limited  {}: none where every stop channel promises it\n"
        "  # cap: per_axis  # where the board keeps it (the board library does): the guard slows "
        "the\n  #                # axes near a body and stops later; all_axes: one factor for "
        "all\n",
        kGuessMark);
    text +=
        fmt::format("\n# The CAN frames are axguard's own{}; format: describes others.\ncan:\n{}",
                    period_ns == 0 ? ", 1000 a second" : "", period_text(period_ns));
    std::set<std::string> axes;
    for (const RoleGuess& role : roles) {
        axes.insert(role.axis);
    }
    axes.erase("");
    text += format_text(ini.tools.tools, axes.size());
    text +=
        "  permit: 2  # version; board.md is what a board must do\n"
        "  hashes: required  # the board has to send the hashes that axguard check prints\n";
    return text;
}

}  // namespace axg
