// SPDX-License-Identifier: Apache-2.0
// A broken limit in words, and the units of an axis' figures as the machine file has them. For the
// guard's log and the reports.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/guard/monitor.hpp"
#include "core/machine/machine.hpp"
#include "core/reach/limit_fact.hpp"

namespace axg {

enum class LimitFigure : std::uint8_t { speed, acceleration, jerk, position };
[[nodiscard]] LimitFigure figure_of(LimitKind kind) noexcept;

/// mm/s, deg/s2...
[[nodiscard]] const char* unit_of(const Axis& axis, LimitFigure figure) noexcept;

/// From rad to degrees; lengths stay.
[[nodiscard]] double in_axis_units(const Axis& axis, double value) noexcept;

/// "axis X: acceleration 20000 mm/s2, declared 4000 mm/s2. ...", with what to do next. Allocates
/// nothing.
/// @return  bytes written, no zero behind them
[[nodiscard]] std::size_t format_limit(const LimitFact& fact, StopReason reason,
                                       const Machine& machine, std::span<char> out) noexcept;
[[nodiscard]] std::string limit_text(const LimitFact& fact, StopReason reason,
                                     const Machine& machine);

}  // namespace axg
