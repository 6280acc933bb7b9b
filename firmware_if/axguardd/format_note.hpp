// SPDX-License-Identifier: Apache-2.0
// A note of the live guard as a line for a person: what, why, what to do next. Into a buffer of the
// caller's: the logger allocates nothing either.
#pragma once

#include <cstddef>
#include <span>

#include "core/machine/machine.hpp"
#include "firmware_if/guard/guard_node.hpp"

namespace axg {

/// @return  bytes written, the newline included
[[nodiscard]] std::size_t format_note(const LiveNote& note, const Machine& machine,
                                      std::span<char> out) noexcept;

}  // namespace axg
