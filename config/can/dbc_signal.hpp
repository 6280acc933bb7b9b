// SPDX-License-Identifier: Apache-2.0
// Converts a signal of a DBC file to a signal of the receiver.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "config/can/dbc.hpp"

namespace axg {

/// Converts the signal to a position in the unit of its file. Returns why it cannot be used, as a
/// text that follows "a signal of"; empty: it can be used.
[[nodiscard]] std::string to_can_signal(const DbcMessage& message, const DbcSignal& signal,
                                        CanSignal& out);

/// The unit that a text of the file names (mm, deg, °, rev...), as an index of kSignalUnitNames;
/// UTF-8 or Latin-1.
[[nodiscard]] std::optional<std::size_t> unit_named(std::string_view text) noexcept;

}  // namespace axg
