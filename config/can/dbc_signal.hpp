// SPDX-License-Identifier: Apache-2.0
// From a signal of a DBC file to what the receiver reads.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "config/can/dbc.hpp"

namespace axg {

/// The signal in the unit of its file, as a position. Returns why it cannot be used, in words that
/// follow "a signal of": empty where it can.
[[nodiscard]] std::string to_can_signal(const DbcMessage& message, const DbcSignal& signal,
                                        CanSignal& out);

/// The unit that a text of the file names (mm, deg, °, rev...), as an index of kSignalUnitNames;
/// UTF-8 or Latin-1.
[[nodiscard]] std::optional<std::size_t> unit_named(std::string_view text) noexcept;

}  // namespace axg
