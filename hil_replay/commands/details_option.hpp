// SPDX-License-Identifier: Apache-2.0
// --details, the same for every command that prints one screen without it.
#pragma once

#include "firmware_if/cli/command_line.hpp"
#include "hil_replay/replay/why_stop.hpp"

namespace axg {

/// `has_details` must live as long as the parser.
inline void add_details_option(const Command& command, bool& has_details) {
    command.add_flag(
        "-v,--details", has_details,
        "print everything: tables, plan, parts of each distance [default: one screen]");
}

[[nodiscard]] constexpr Detail detail_of(bool has_details) noexcept {
    return has_details ? Detail::full : Detail::brief;
}

}  // namespace axg
