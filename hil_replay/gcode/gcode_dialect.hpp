// SPDX-License-Identifier: Apache-2.0
// Recognizes programs of unsupported controls, so that one error reports this instead of one error
// per line.
#pragma once

#include <string_view>

namespace axg {

/// The control that a line was written for, "Siemens" or "Heidenhain"; empty if no word of it is
/// recognized. For lines that are not valid RS-274; ignores words in comments.
[[nodiscard]] std::string_view foreign_control(std::string_view line);

}  // namespace axg
