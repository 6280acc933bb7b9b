// SPDX-License-Identifier: Apache-2.0
// Axis limits from a LinuxCNC INI file: travel, speed, acceleration. mm and degrees.
// Source: LinuxCNC "INI Configuration", sections KINS, TRAJ, AXIS_<letter> and JOINT_<number>.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "config/init/tool_table.hpp"
#include "config/text/named_file.hpp"

namespace axg {

/// One axis, from its joints and, where joints and axes are the same (trivkins), from [AXIS_L]: of
/// several limits the tightest, but of the two joints of a gantry the larger speed and
/// acceleration. A value that the file does not state is empty.
struct IniAxis {
    std::string name = "X";     // a letter; of a joint of a URDF file also J1, J2...
    bool is_rotary = false;     // A B C
    bool is_unlimited = false;  // WRAPPED_ROTARY, or a rotary axis without limits within ten turns
    /// Kinematics for the tip: LinuxCNC limits the tip, and the speed of no joint.
    bool follows_tip = false;
    bool is_gantry = false;                     // two joints move it
    std::optional<double> min, max;             // mm or degrees
    std::optional<double> speed, acceleration;  // a second
    std::optional<double> braking;              // the acceleration of its slowest joint
};

/// A key of the section `program` of a machine file, and where the INI states it.
struct IniSetting {
    std::string key;
    char letter = 0;  // of an axis, for a map of axes; 0: the value is the key's
    std::string value;
    std::string source;  // "mill.ini:12: [TRAJ] LINEAR_UNITS = inch"
};

struct IniAxes {
    std::vector<IniAxis> axes;                    // in the order of COORDINATES, each letter once
    std::optional<std::int64_t> servo_period_ns;  // [EMCMOT] SERVO_PERIOD
    bool exceeds_limits = true;                   // as LinuxCNC does where moves blend
    std::vector<IniSetting> program{};            // keys together
    std::vector<std::string> program_doubts{};    // what decides a program and is in no key
    ToolTable tools{};                            // [EMCIO] TOOL_TABLE
    std::vector<std::string> faults;              // "machine.ini:12: [AXIS_X] MAX_LIMIT: ..."
};

/// @param name      of the file, for messages
/// @param includes  reads what #INCLUDE, PARAMETER_FILE and TOOL_TABLE name
[[nodiscard]] IniAxes read_linuxcnc_ini(std::string_view text, const std::string& name,
                                        const NamedFiles& includes);

}  // namespace axg
