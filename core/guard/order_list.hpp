// SPDX-License-Identifier: Apache-2.0
// Lists the cap orders that a search tries, the one that costs least now first. If a cap may bind
// single axes, the list binds those first that hardly move, because that costs no time while they
// do not start. Pure. Source: docs/reference/board.md, "Which order".
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/guard/cap_control.hpp"

namespace axg {

inline constexpr std::uint32_t kOrdersTried = 14;
inline constexpr double kIdleUse = 0.25;  // 1/250 of rapid: an axis that is slower does not move
inline constexpr double kAnyGrowth = kCapRapid;

struct OrderTried {
    CapOrder order{};
    bool binds_fastest = false;
    double room = 0;    // factor by which the axes that it binds may get faster
    double growth = 1;  // the same for all axes, if an order slows them down now
};

struct OrderList {
    std::array<OrderTried, kOrdersTried> of{};
    std::uint32_t count = 0;
    bool is_slowed = false;  // an axis moves that `order` binds
};

/// @param uses  [axes] how fast each is now, 1/250 of its largest speed
/// @param order  the last order; it is in the list unless it is a hold or binds no axis
/// @param is_per_axis  an order may bind only some axes, else it binds all
[[nodiscard]] OrderList list_orders(std::span<const double> uses, const CapOrder& order,
                                    bool is_per_axis) noexcept;

}  // namespace axg
