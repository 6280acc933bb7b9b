// SPDX-License-Identifier: Apache-2.0
// Jogging out of a place near an obstacle: how near a pair may come while one axis moves one way.
// mm. Source: docs/stoppable.md, "Jogging out".
#pragma once

#include <algorithm>

namespace axg {

/// What a pair may lose of the clearance it has, beyond what errors of position may feign: for a
/// way that leads past an obstacle at first, before it leads away from it.
inline constexpr double kJogGiveMm = 0.02;

/// The distance that a pair keeps in a jog: its margin, or where it is nearer, what it has. At
/// least 0, and more than that everywhere: never a contact.
/// @param clearance_mm  certified, at the reported position
/// @param errors_mm     what the errors of a reported position can make of a distance; they count
///     three times: in this clearance, in that of a later position, and for the axes between
[[nodiscard]] constexpr double jog_floor_mm(double margin_mm, double clearance_mm,
                                            double errors_mm) noexcept {
    return std::max(0.0, std::min(margin_mm, clearance_mm - 3 * errors_mm - kJogGiveMm));
}

}  // namespace axg
