// SPDX-License-Identifier: Apache-2.0
// Programs of controls that are not read: recognised, so that the error says so once and not for
// every line.
#pragma once

#include <string_view>

namespace axg {

/// The control that a line was written for, "Siemens" or "Heidenhain"; empty where nothing tells.
/// Only of lines that are none of RS-274: a comment's words count for nothing.
[[nodiscard]] std::string_view foreign_control(std::string_view line);

}  // namespace axg
