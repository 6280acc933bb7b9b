// SPDX-License-Identifier: Apache-2.0
// Values of the machine file that may make a stop nearer: what to try, and the machine with them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_if/setup/loaded_machine.hpp"
#include "hil_replay/replay/why_stop.hpp"
#include "hil_replay/trace/limit_survey.hpp"

namespace axg {

struct Setting {
    std::vector<std::string> lines;  // AdvisedSetting::lines
};

/// Settings that leave the motion as it is, so that its trace shows their effect: limited jerk,
/// lists of a cycle, limits as low as the trace shows them.
/// @param seen  of the whole trace up to the stop
[[nodiscard]] std::vector<Setting> settings_of_trace(const Machine& machine,
                                                     const UnprovenPair& pair,
                                                     const LimitSurvey& seen);
/// Settings for a board that runs the program once more: limited jerk, half of the speed, an
/// acknowledged cap, commands announced ahead.
[[nodiscard]] std::vector<Setting> settings_of_board(const Machine& machine,
                                                     const UnprovenPair& pair);

/// The machine with a setting, as the machine file with these lines reads: axes, cycle, guard and
/// can. The surfaces are those of `loaded`. Empty: the reader refuses the lines.
[[nodiscard]] std::optional<LoadedMachine> with_setting(const LoadedMachine& loaded,
                                                        const std::vector<std::string>& lines);

}  // namespace axg
