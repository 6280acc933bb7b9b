// SPDX-License-Identifier: Apache-2.0
// One line of a candump log, compact (`(time) can0 123#11`) or as the console shows it
// (` (time)  can0  123   [1]  11`).
#pragma once

#include <string_view>

#include "firmware_if/can/can_frame.hpp"
#include "hil_replay/trace/trace_base.hpp"

namespace axg {

/// @param device  out: the interface, a view into `line`
/// @return what is wrong with the line, or a LineFault that is false
[[nodiscard]] LineFault parse_candump_line(std::string_view line, CanFrame& frame,
                                           std::string_view& device) noexcept;

}  // namespace axg
