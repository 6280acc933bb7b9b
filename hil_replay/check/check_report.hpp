// SPDX-License-Identifier: Apache-2.0
// Report of `axguard check` about a machine, section by section: each prints text, and
// notes what it measured for the JSON document (check_json.hpp). A section only reports results
// that were computed elsewhere.
#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "core/machine/machine.hpp"
#include "core/mesh/mesh_check.hpp"
#include "firmware_if/cli/admitted_plan_json.hpp"
#include "firmware_if/setup/exclusion_proof.hpp"
#include "firmware_if/setup/loaded_machine.hpp"
#include "firmware_if/setup/pose_errors.hpp"
#include "firmware_if/setup/unstated_promises.hpp"

namespace axg {

/// How far an axis can get, mm or degrees.
struct AxisReach {
    double at_full_speed = 0, at_rest = 0;
};

/// A checked pair at positions spread over the travel, margin 0.
struct PairContacts {
    std::string name;
    std::uint32_t positions = 0;
    std::uint32_t touching = 0;   // positions at which the surfaces are not proven apart
    std::uint32_t contained = 0;  // those at which they are, and one body is inside the other
    std::uint32_t not_known = 0;  // those at which containment is not proven
};

struct EngineFacts {
    std::string lanes;
    std::size_t trees_bytes = 0, lists_bytes = 0, solids_bytes = 0;
    // If another engine than the CPU's is requested; else empty.
    std::string choice{}, gpu{}, choice_words{};
};

/// A stored admission: the plan of the guard's computer, beside that of the machine file.
struct AdmittedFacts {
    AdmittedPlan admitted{};
    bool has_file_plan = false;  // no list of the machine file is longer
};

/// Results of the sections that are not in the machine itself.
struct CheckFacts {
    std::vector<MeshReport> bodies, tools;  // as LoadedMachine::meshes; no mesh: nothing in it
    std::vector<MeshReport> sections;       // those of all tools that have a name, in their order
    // If stops are path-keeping: for the shortest permit, and for the longest.
    double look_ahead_s = 0, look_ahead_needed_s = 0, look_ahead_longest_s = 0;
    std::vector<AxisReach> reaches;   // if they are not
    std::vector<double> jog_reaches;  // where a jog is promised; mm or degrees
    std::vector<UnstatedPromise> unstated;
    std::optional<EngineFacts> engine;
    std::vector<PairContacts> contacts;
    std::optional<AdmittedFacts> admitted;
    std::vector<PairOverTravel> exclusions;  // as Machine::exclusions; empty: no engine
    std::optional<WorstPoseError> pose_errors;
    std::string plan;  // as JSON; empty: not requested
};

struct CheckReport {
    const LoadedMachine& loaded;
    std::FILE* words;
    std::vector<std::string> warnings;  // no failures, but a person ought to review them
    EngineChoice engine = EngineChoice::cpu;
    std::uint32_t multiprocessors = 0;  // of the GPU; 0: all
    int exit_code = 0;                  // other than 0: the requested engine may not run here
    CheckFacts facts{};
};

void report_axes(CheckReport& report);
/// Which way each axis moves which bodies, and where their meshes are placed.
void report_motion(CheckReport& report);
/// "X+ moves table to -x with a, c": one step of the axis from zero, by the kinematics.
[[nodiscard]] std::string describe_motion(const Machine& machine, std::uint32_t axis);
/// Location of the axes in the CAN frames.
void report_frames(CheckReport& report);
void report_bodies(CheckReport& report);
void report_tools(CheckReport& report);
void report_pairs(CheckReport& report);
/// What the stated errors of joints and places cost; nothing where none is stated.
void report_pose_errors(CheckReport& report);
/// Stopping envelopes of stoppable mode.
void report_guard(CheckReport& report);
/// Memory, capacities, and which pairs touch at positions spread over the travel.
void report_engine(CheckReport& report);
/// Whether the plan of the machine file fits the computer whose admission is stored in `file`.
void report_admitted(CheckReport& report, const std::string& file);
/// Prints what each exclusion hides over the travel. A contact that `because` does not explain is a
/// warning.
void report_exclusions(CheckReport& report);
/// Axes that move the two bodies against each other.
[[nodiscard]] std::vector<std::uint32_t> axes_between(const Machine& machine, const Exclusion& one);

/// Lines of the machine file that are still guesses of `axguard init`; warnings only.
void report_guesses(CheckReport& report, const std::string& file);

/// [bodies] whether a guess of `axguard init` marks the direction or the pivot of the body's axis.
[[nodiscard]] std::vector<bool> guessed_joints(const LoadedMachine& loaded);

/// Guaranteed braking distance from full speed, mm or rad.
[[nodiscard]] double stopping_distance(const Axis& axis) noexcept;
[[nodiscard]] double stopping_time_s(const Axis& axis) noexcept;
/// [axes] Above these speeds the guard sees an encoder that freezes, mm/s or rad/s (blind_speed).
[[nodiscard]] std::vector<double> blind_speeds(const Machine& machine);

[[nodiscard]] const char* to_text(SignalType type);
[[nodiscard]] const char* to_text(SignalRole role);
/// Whether the signal is a number with a factor and an offset: position or velocity.
[[nodiscard]] bool is_number(SignalRole role) noexcept;
[[nodiscard]] bool has_axis(SignalRole role) noexcept;

}  // namespace axg
